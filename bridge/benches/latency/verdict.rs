//! Measures the ratios and compares them with their budgets.

use std::time::{Duration, Instant};

use crate::{SIZES, Way, median};

/// Number of measurements that must exceed a budget before it counts as missed, since machines are noisy.
pub(crate) const ATTEMPTS: usize = 3;
/// How often a measurement starts all processes anew.
const STARTS: usize = 5;
/// Number of rounds between two starts.
const ROUNDS: usize = 7;
/// Budget of Belvedere's median relative to that of iceoryx2 alone.
const BESIDE: f64 = 1.1;
/// Budget of the median of 4 MB relative to that of 4 KB.
const FLAT: f64 = 1.2;
/// Budget of the processor time of a consumer of one stream at 30 Hz, in per cent of a core.
const PROCESSOR: f64 = 0.1;

/// Measures and prints. Returns the budgets that were missed each time.
pub(crate) fn latencies() -> Vec<String> {
    let mut missed = attempt();
    for _ in 1..ATTEMPTS {
        if missed.is_empty() {
            break;
        }
        let again = attempt();
        missed.retain(|name| again.contains(name));
    }
    missed
}

fn attempt() -> Vec<String> {
    let mut rounds: Vec<Vec<(f64, f64)>> = vec![Vec::new(); SIZES.len()];
    for _ in 0..STARTS {
        let mut ways = Way::start_all();
        for _ in 0..ROUNDS {
            for ((_, ours, plain), rounds) in ways.iter_mut().zip(&mut rounds) {
                rounds.push((ours.median(), plain.median()));
            }
        }
    }
    let mut missed = Vec::new();
    println!("\n{:>9}  {:>12}  {:>12}  {:>6}  budget", "bytes", "belvedere", "iceoryx2", "ratio");
    for (size, rounds) in SIZES.iter().zip(&rounds) {
        let ratio = median(rounds.iter().map(|(ours, plain)| ours / plain).collect());
        let ours = median(rounds.iter().map(|round| round.0).collect()) * 1e-3;
        let plain = median(rounds.iter().map(|round| round.1).collect()) * 1e-3;
        println!(
            "{size:>9}  {ours:>9.2} µs  {plain:>9.2} µs  {ratio:>6.3}  {BESIDE} {}",
            word(ratio, BESIDE)
        );
        if ratio > BESIDE {
            missed.push(format!("{size} bytes beside iceoryx2 alone"));
        }
    }
    let last = rounds.len() - 1;
    let flat = median((0..rounds[0].len()).map(|round| rounds[last][round].0 / rounds[0][round].0).collect());
    let name = format!("{} bytes beside {}", SIZES[last], SIZES[0]);
    println!("{name}: {flat:.3}, budget {FLAT} {}", word(flat, FLAT));
    if flat > FLAT {
        missed.push(name);
    }
    missed
}

/// Prints the share of a core that consumers of frames of this size take at 30 Hz.
pub(crate) fn processor_time(size: usize) {
    let [ours, plain, socket] =
        [Way::ours(size), Way::plain(size), Way::socket()].map(|mut way| processor_share(&mut way));
    println!(
        "processor time of a consumer at 30 Hz, {size} bytes: {ours:.3} % of a core (iceoryx2 alone {plain:.3} %, eight bytes by a socket {socket:.3} %), budget {PROCESSOR} % {}",
        word(ours, PROCESSOR)
    );
}

fn processor_share(way: &mut Way) -> f64 {
    // Warm up: after a pause, a subscriber checks once whether its publisher is dead.
    way.latencies(10, Duration::from_secs(1) / 30);
    let (before, started) = (way.consumer.processor_time(), Instant::now());
    way.latencies(300, Duration::from_secs(1) / 30);
    let used = way.consumer.processor_time().saturating_sub(before);
    100.0 * used.as_secs_f64() / started.elapsed().as_secs_f64()
}

fn word(value: f64, budget: f64) -> &'static str {
    if value > budget { "MISSED" } else { "holds" }
}
