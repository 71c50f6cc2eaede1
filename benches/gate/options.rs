//! The command line.

use super::level;
use belvedere_sensors::simd::{Level, best_level};
use clap::Parser;

/// Measures Belvedere against parry3d in the same run and fails when a ratio has fallen more than 10 % below the best
/// that benches/budgets.toml has of this processor.
#[derive(Debug, Parser)]
#[command(name = "cargo bench --bench gate --")]
#[allow(clippy::struct_excessive_bools, reason = "flags of a command line")]
pub struct Options {
    /// Writes what is measured to benches/budgets.toml, and raises the bests; entries that are not run keep theirs.
    #[arg(long, conflicts_with = "quick")]
    pub record: bool,
    /// Only entries whose name contains this: S1/R1, S3, /R5, frames/build.
    #[arg(long, default_value = "")]
    pub filter: String,
    /// Fewer copies and rounds: to see where it stands, not to record.
    #[arg(long)]
    pub quick: bool,
    /// This SIMD level alone, instead of the best one of this machine and AVX2 beside AVX-512: sse2, avx2, avx512.
    #[arg(long, value_parser = parse_level)]
    pub level: Option<Level>,
    /// Measures in this process instead of in copies of it, and prints the figures as JSON: for profilers.
    #[arg(long, conflicts_with = "record")]
    pub alone: bool,
    /// Only these entries, by their whole names: what a copy is asked for once more.
    #[arg(long, hide = true, value_delimiter = ',')]
    pub entries: Vec<String>,
    /// What `cargo bench` adds.
    #[arg(long, hide = true)]
    pub bench: bool,
    /// What `cargo test --benches` adds: one round of each, no verdict.
    #[arg(long, hide = true)]
    pub test: bool,
}

fn parse_level(name: &str) -> Result<Level, String> {
    level::named(name).ok_or_else(|| {
        format!(
            "this machine has no {name:?}; its best is {}, names are {:?}",
            level::name(best_level()),
            level::NAMES
        )
    })
}

impl Options {
    /// Copies of the program that measure at each SIMD level: fewer at two levels, so that CI waits no longer.
    pub fn copies(&self) -> usize {
        match (self.test, self.quick, self.levels().len()) {
            (true, _, _) => 1,
            (_, true, _) | (_, _, 2..) => 3,
            _ => 5,
        }
    }

    /// Rounds of each measurement in a copy.
    pub fn rounds(&self) -> usize {
        if self.test || self.quick { 1 } else { 3 }
    }

    /// The SIMD levels to measure at, narrowest first.
    pub fn levels(&self) -> Vec<&'static str> {
        let widest = level::name(self.level.unwrap_or_else(best_level));
        if self.level.is_none() && widest == "avx512" { vec!["avx2", widest] } else { vec![widest] }
    }

    /// Whether an entry is to be run.
    pub fn wants(&self, group: &str, entry: &str) -> bool {
        let name = format!("{group}/{entry}");
        name.contains(&self.filter) && (self.entries.is_empty() || self.entries.contains(&name))
    }

    /// What a copy is told that measures some entries, or all that are wanted.
    pub fn of_copy(&self, level: &str, entries: &[String]) -> Vec<String> {
        let mut arguments: Vec<String> =
            ["--alone", "--level", level, "--filter", &self.filter].map(String::from).into();
        arguments.extend(self.quick.then(|| "--quick".into()));
        arguments.extend(self.test.then(|| "--test".into()));
        if !entries.is_empty() {
            arguments.extend(["--entries".into(), entries.join(",")]);
        }
        arguments
    }
}
