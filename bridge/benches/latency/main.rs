//! From a frame's sending to its being taken in another process, beside iceoryx2 alone doing the same:
//! `cargo bench -p belvedere-bridge --bench latency`.
//!
//! Publisher and consumer are two processes; this program starts itself again as the consumer. Both ways wait for an
//! event and then receive; both carry the time of sending in a header of 256 bytes. Frames go out every millisecond,
//! so that the consumer sleeps before each. Rounds of both ways alternate, and what counts is the ratio of medians
//! within a round: the pace of the machine cancels out.
//!
//! The exit code is 1 when a budget is missed in three measurements.

mod consumer;
mod ours;
mod plain;
mod socket;

use std::{
    process::ExitCode,
    time::{Duration, Instant},
};

use consumer::Consumer;
use criterion::{BenchmarkId, Criterion, SamplingMode};

/// Payloads: a page; 640 × 480 colour and depth; a cloud's worth.
const SIZES: [usize; 4] = [4096, 921_600, 1_228_800, 4_194_304];
/// Frames of a round.
const FRAMES: usize = 400;
const ROUNDS: usize = 7;
const PERIOD: Duration = Duration::from_millis(1);
/// Belvedere's median beside that of iceoryx2 alone.
const BUDGET_BESIDE: f64 = 1.1;
/// The median of 4 MB beside that of 4 KB.
const BUDGET_FLAT: f64 = 1.2;
/// Processor time of a consumer of one stream at 30 Hz.
const BUDGET_CPU: f64 = 0.001;

/// One of the two ways to send.
trait Sender {
    /// Sends one frame, its payload untouched, the time of sending in its header.
    fn send(&self);
}

/// A sender, and the consumer at its other end.
struct Way {
    sender: Box<dyn Sender>,
    consumer: Consumer,
}

impl Way {
    fn ours(size: usize) -> Self {
        let domain = format!("bench-{}-{size}", std::process::id());
        let sender = ours::Ours::open(&domain, size);
        Self { sender: Box::new(sender), consumer: Consumer::start("ours", &domain) }
    }

    fn plain(size: usize) -> Self {
        let domain = format!("bench-{}-plain-{size}", std::process::id());
        let sender = plain::Plain::open(&domain, size);
        Self { sender: Box::new(sender), consumer: Consumer::start("plain", &domain) }
    }

    fn socket() -> Self {
        let name = format!("bench-{}-socket", std::process::id());
        let sender = socket::Socket::open(&name);
        Self { sender: Box::new(sender), consumer: Consumer::start("socket", &name) }
    }

    /// Nanoseconds from sending to taking, of so many frames.
    fn latencies(&mut self, frames: usize, period: Duration) -> Vec<u64> {
        self.consumer.expect(frames);
        for _ in 0..frames {
            std::thread::sleep(period);
            self.sender.send();
        }
        self.consumer.answer()
    }

    fn median(&mut self) -> f64 {
        median(self.latencies(FRAMES, PERIOD).into_iter().map(|ns| ns as f64).collect())
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values[values.len() / 2]
}

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    if arguments.next().as_deref() == Some(consumer::ROLE) {
        let (way, domain) = (arguments.next().unwrap_or_default(), arguments.next().unwrap_or_default());
        consumer::run(&way, &domain);
        return ExitCode::SUCCESS;
    }
    // `cargo test --benches` only wants to see it run.
    let quick = std::env::args().any(|argument| argument == "--test");
    let mut ways: Vec<(usize, Way, Way)> =
        SIZES.iter().map(|&size| (size, Way::ours(size), Way::plain(size))).collect();
    if quick {
        for (_, ours, plain) in &mut ways {
            assert!(ours.latencies(5, PERIOD).len() == 5 && plain.latencies(5, PERIOD).len() == 5);
        }
        return ExitCode::SUCCESS;
    }
    statistics(&mut ways);
    let holds = (0..3).any(|_| verdict(&mut ways) == 0);
    ExitCode::from(u8::from(!holds))
}

/// Criterion's view of each way: mean, spread, and change since the last run.
fn statistics(ways: &mut [(usize, Way, Way)]) {
    // It plans by the latencies that it is told, which are a hundredth of the time that sending takes.
    let mut criterion = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(2))
        .measurement_time(Duration::from_millis(15))
        .configure_from_args();
    let mut group = criterion.benchmark_group("send_to_take");
    group.sampling_mode(SamplingMode::Flat);
    for (size, ours, plain) in ways {
        for (name, way) in [("belvedere", ours), ("iceoryx2", plain)] {
            group.bench_function(BenchmarkId::new(name, *size), |bencher| {
                bencher.iter_custom(|frames| {
                    let frames = usize::try_from(frames).unwrap_or(usize::MAX);
                    way.latencies(frames, PERIOD).into_iter().map(Duration::from_nanos).sum()
                });
            });
        }
    }
    group.finish();
    criterion.final_summary();
}

/// Measures, prints, and gives how many budgets are missed.
fn verdict(ways: &mut [(usize, Way, Way)]) -> usize {
    let mut missed = 0;
    let mut judge = |value: f64, budget: f64| {
        missed += usize::from(value > budget);
        if value > budget { "MISSED" } else { "holds" }
    };
    println!("\n{:>9}  {:>12}  {:>12}  {:>6}  budget", "bytes", "belvedere", "iceoryx2", "ratio");
    let mut rounds: Vec<Vec<(f64, f64)>> = vec![Vec::new(); ways.len()];
    for _ in 0..ROUNDS {
        for ((_, ours, plain), rounds) in ways.iter_mut().zip(&mut rounds) {
            rounds.push((ours.median(), plain.median()));
        }
    }
    for ((size, ..), rounds) in ways.iter().zip(&rounds) {
        let ratio = median(rounds.iter().map(|(ours, plain)| ours / plain).collect());
        let [ours, plain] = [|round: &(f64, f64)| round.0, |round: &(f64, f64)| round.1]
            .map(|of| median(rounds.iter().map(of).collect()) * 1e-3);
        let verdict = judge(ratio, BUDGET_BESIDE);
        println!("{size:>9}  {ours:>9.2} µs  {plain:>9.2} µs  {ratio:>6.3}  {BUDGET_BESIDE} {verdict}");
    }
    let last = rounds.len() - 1;
    let flat = median((0..ROUNDS).map(|round| rounds[last][round].0 / rounds[0][round].0).collect());
    println!(
        "{} bytes beside {}: {flat:.3}, budget {BUDGET_FLAT} {}",
        SIZES[last],
        SIZES[0],
        judge(flat, BUDGET_FLAT)
    );

    let (_, ours, plain) = &mut ways[1];
    let shares = [processor_share(ours), processor_share(plain), processor_share(&mut Way::socket())];
    let [ours, plain, socket] = shares.map(|share| 100.0 * share);
    println!(
        "processor time of a consumer at 30 Hz: {ours:.3} % of a core (iceoryx2 alone {plain:.3} %, a socket {socket:.3} %), budget {} % {}",
        100.0 * BUDGET_CPU,
        judge(ours, 100.0 * BUDGET_CPU)
    );
    missed
}

/// Part of a core that the consumer takes at 30 Hz.
fn processor_share(way: &mut Way) -> f64 {
    // After a pause, a subscriber looks once whether its publisher is dead.
    way.latencies(10, Duration::from_secs(1) / 30);
    let (before, started) = (way.consumer.processor_time(), Instant::now());
    way.latencies(300, Duration::from_secs(1) / 30);
    way.consumer.processor_time().saturating_sub(before).as_secs_f64() / started.elapsed().as_secs_f64()
}
