//! The verdict: is Belvedere as far ahead of parry3d as it was? See `benches/README.md`, or `-- --help`.

#![allow(unreachable_pub, reason = "the modules of a program, which exports nothing")]

#[path = "../budgets.rs"]
mod budgets;
mod casts;
mod clock;
mod devices;
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
#[path = "../tag_room/mod.rs"]
mod tag_room;
mod verdict;

use budgets::Budgets;
use clap::Parser as _;
use gate::Gate;
use options::Options;
use scenes::{SCENES, level};
use std::process::ExitCode;
use verdict::{TOLERANCE, TOLERANCE_ELSEWHERE};

fn main() -> ExitCode {
    let options = Options::parse();
    match run(&options) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

fn run(options: &Options) -> Result<(), String> {
    let simd = options.level.unwrap_or_else(belvedere_sensors::simd::best_level);
    let budgets = Budgets::read()?;
    let processor = machine::processor();
    let name = level::name(simd);
    let tolerance = match budgets.processors.get(name) {
        _ if options.record => TOLERANCE,
        None => {
            println!("Nothing is recorded for the SIMD level {name}: these are figures, not a verdict.");
            TOLERANCE
        }
        Some(recorded) if *recorded == processor => TOLERANCE,
        Some(recorded) => {
            println!("Recorded on {recorded:?}, this is {processor:?}: the tolerance is wider.");
            TOLERANCE_ELSEWHERE
        }
    };
    if options.record && !options.filter.is_empty() && budgets.processors.get(name) != Some(&processor) {
        return Err(format!("the records of {name} are not of this processor: record all, without --filter"));
    }
    let mut gate = Gate::new(options, (name, processor.clone()), budgets, tolerance);
    gate.print_head();
    for name in SCENES {
        casts::run(&mut gate, name, simd)?;
    }
    frames::run(&mut gate, simd);
    lenses::run(&mut gate, simd);
    moments::run(&mut gate, simd);
    devices::run(&mut gate, simd);

    if gate.measured + gate.left_out == 0 {
        return Err(format!("no entry's name contains {:?}", options.filter));
    }
    if options.record {
        gate.budgets.processors.insert(name.into(), processor);
        gate.budgets.write()?;
        println!("recorded in {}", Budgets::path().display());
    }
    if gate.fallen.is_empty() || options.test {
        return Ok(());
    }
    Err(format!(
        "{} of {} ratios fell more than {:.0} % below their records: {}. Find out why (benches/README.md), or \
         record the new ones with `cargo bench -p belvedere --bench gate -- --record --filter NAME` and say why.",
        gate.fallen.len(),
        gate.measured,
        100.0 * tolerance,
        gate.fallen.join(", ")
    ))
}
