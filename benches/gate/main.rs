//! The verdict: is Belvedere as far ahead of parry3d as it was? See `benches/README.md`, or `-- --help`.

#![allow(unreachable_pub, reason = "the modules of a program, which exports nothing")]

#[path = "../budgets/mod.rs"]
mod budgets;
mod casts;
mod clock;
mod copies;
mod devices;
mod figures;
mod frames;
mod gate;
mod idle;
mod lenses;
mod machine;
mod measure;
mod moments;
mod options;
#[path = "../scenes/mod.rs"]
mod scenes;
mod session;
mod table;
#[path = "../tag_room/mod.rs"]
mod tag_room;
mod verdict;

use clap::Parser as _;
use gate::Gate;
use options::Options;
use scenes::{SCENES, level};
use std::process::ExitCode;

fn main() -> ExitCode {
    let options = Options::parse();
    let result = if options.alone { measure_here(&options) } else { session::run(&options) };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

/// Measures in this process, as a copy does.
fn measure_here(options: &Options) -> Result<(), String> {
    let level = options.level.unwrap_or_else(belvedere_sensors::simd::best_level);
    let mut gate = Gate::new(options);
    for name in SCENES {
        casts::run(&mut gate, name, level)?;
    }
    frames::run(&mut gate, level);
    lenses::run(&mut gate, level);
    moments::run(&mut gate, level);
    devices::run(&mut gate, level);
    Ok(())
}
