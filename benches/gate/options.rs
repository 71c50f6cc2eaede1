//! The command line.

use super::level;
use belvedere_sensors::simd::{Level, best_level};
use clap::Parser;

/// Compares Belvedere with parry3d in the same run. Fails if a ratio is more than 10 % below the best that
/// benches/budgets.toml has for this processor.
#[derive(Debug, Parser)]
#[command(name = "cargo bench --bench gate --")]
#[allow(clippy::struct_excessive_bools, reason = "flags of a command line")]
pub struct Options {
    /// Write the measured ratios to benches/budgets.toml, and raise the bests; entries that are not run keep theirs
    #[arg(long, conflicts_with = "quick")]
    pub record: bool,
    /// Run only entries whose name contains this: S1/R1, S3, /R5, frames/build
    #[arg(long, default_value = "")]
    pub filter: String,
    /// Use fewer copies and rounds, for a quick look; not for recording
    #[arg(long)]
    pub quick: bool,
    /// Measure only this SIMD level (sse2, avx2, avx512) instead of the best one of this machine, and AVX2 in addition
    /// to AVX-512
    #[arg(long, value_parser = parse_level)]
    pub level: Option<Level>,
    /// Measure in this process instead of in copies of it, and print the figures as JSON: for profilers
    #[arg(long, conflicts_with = "record")]
    pub alone: bool,
    /// Measure only the entries with these full names (used when copies measure again)
    #[arg(long, hide = true, value_delimiter = ',')]
    pub entries: Vec<String>,
    /// Ignored; `cargo bench` adds it
    #[arg(long, hide = true)]
    pub bench: bool,
    /// One round of each entry, no verdict; `cargo test --benches` adds it
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
    /// Returns the number of copies that measure at each SIMD level: fewer at two levels, so that CI takes no longer.
    pub fn copies(&self) -> usize {
        match (self.test, self.quick, self.levels().len()) {
            (true, _, _) => 1,
            (_, true, _) | (_, _, 2..) => 3,
            _ => 5,
        }
    }

    /// Returns the number of rounds of each measurement in a copy.
    pub fn rounds(&self) -> usize {
        if self.test || self.quick { 1 } else { 3 }
    }

    /// Returns the SIMD levels to measure, narrowest first.
    pub fn levels(&self) -> Vec<&'static str> {
        let widest = level::name(self.level.unwrap_or_else(best_level));
        if self.level.is_none() && widest == "avx512" { vec!["avx2", widest] } else { vec![widest] }
    }

    /// Returns true if an entry is to be measured.
    pub fn wants(&self, group: &str, entry: &str) -> bool {
        let name = format!("{group}/{entry}");
        name.contains(&self.filter) && (self.entries.is_empty() || self.entries.contains(&name))
    }

    /// Returns the arguments of a copy that measures some entries, or all that are requested.
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
