//! From a frame's sending to its being taken in another process, beside iceoryx2 alone doing the same:
//! `cargo bench -p belvedere-bridge --bench latency`.
//!
//! Publisher and consumer are two processes; this program starts itself again as the consumer. Both ways wait for an
//! event and then receive; both carry the time of sending in a header of 384 bytes. Frames go out every millisecond,
//! so that the consumer sleeps before each. Rounds of both ways alternate, and what counts is the ratio of medians
//! within a round: the pace of the machine cancels out.
//!
//! The exit code is 1 when a budget of latency is missed in each of three measurements. Processor time is told, not
//! judged: what it takes to wake a process is the machine's, and the socket's figure beside it says how much that is.

mod consumer;
mod ours;
mod plain;
mod socket;
mod verdict;

use std::{process::ExitCode, time::Duration};

use consumer::Consumer;
use criterion::{BenchmarkId, Criterion, SamplingMode};

/// Payloads: a page; 640 × 480 colour and depth; a cloud's worth.
const SIZES: [usize; 4] = [4096, 921_600, 1_228_800, 4_194_304];
/// Frames of a round.
const FRAMES: usize = 400;
const PERIOD: Duration = Duration::from_millis(1);

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
    let missed = verdict::latencies(&mut ways);
    verdict::processor_time(&mut ways[1]);
    for name in &missed {
        eprintln!("missed in each of {} measurements: {name}", verdict::ATTEMPTS);
    }
    ExitCode::from(u8::from(!missed.is_empty()))
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
