//! The command line.

use super::level;
use belvedere_sensors::simd::{Level, best_level};
use clap::Parser;

/// Measures Belvedere against parry3d in the same run and fails when a ratio has fallen more than 10 % below
/// its record in benches/budgets.toml.
#[derive(Debug, Parser)]
#[command(name = "cargo bench --bench gate --")]
#[allow(clippy::struct_excessive_bools, reason = "flags of a command line")]
pub struct Options {
    /// Writes what is measured to benches/budgets.toml as the new records; entries that are not run keep theirs.
    #[arg(long, conflicts_with = "quick")]
    pub record: bool,
    /// Only entries whose name contains this: S1/R1, S3, /R5, frames/build.
    #[arg(long, default_value = "")]
    pub filter: String,
    /// Fewer rounds: to see where it stands, not to record.
    #[arg(long)]
    pub quick: bool,
    /// The SIMD level instead of the best one of this machine: sse2, avx2, avx512.
    #[arg(long, value_parser = parse_level)]
    pub level: Option<Level>,
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
    /// Rounds of each measurement.
    pub fn rounds(&self) -> usize {
        match (self.test, self.quick) {
            (true, _) => 1,
            (_, true) => 5,
            _ => 15,
        }
    }

    /// Whether an entry is to be run.
    pub fn wants(&self, group: &str, entry: &str) -> bool {
        format!("{group}/{entry}").contains(&self.filter)
    }
}
