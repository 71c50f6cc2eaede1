//! Latency from sending a frame to taking it in another process, compared with iceoryx2 alone:
//! `cargo bench -p belvedere-bridge --bench latency`.
//!
//! Publisher and consumer are two processes; this program starts itself again as the consumer. Both transports wait for
//! an event and then receive, and both carry the send time in a header of 384 bytes. Frames are sent every millisecond,
//! so that the consumer sleeps before each. Short rounds of both transports alternate. The result is the ratio of their
//! medians within a round, which cancels out the speed of the machine. Processes are started anew several times within
//! a measurement, because latency also depends on the cores and the memory that a process happens to get.
//!
//! The exit code is 1 if a budget of latency is exceeded in each of three measurements. Processor time is reported but
//! has no budget: the cost of waking a process depends on the machine. The figure of a plain socket shows that cost.

mod consumer;
mod ours;
mod plain;
mod socket;
mod verdict;

use std::{
    process::ExitCode,
    sync::atomic::{AtomicUsize, Ordering},
    time::Duration,
};

use consumer::Consumer;
use criterion::{BenchmarkId, Criterion, SamplingMode};

/// Payload sizes: a page; 640 × 480 colour and depth; a point cloud.
const SIZES: [usize; 4] = [4096, 921_600, 1_228_800, 4_194_304];
/// Number of frames in a round.
const FRAMES: usize = 100;
const PERIOD: Duration = Duration::from_millis(1);

/// The sending end of a transport.
trait Sender {
    /// Sends one frame with the send time in its header, without writing its payload.
    fn send(&self);
}

/// A transport: a sender, and the consumer at its other end.
struct Way {
    sender: Box<dyn Sender>,
    consumer: Consumer,
}

impl Way {
    /// Starts Belvedere and iceoryx2 alone for each payload size.
    fn start_all() -> Vec<(usize, Self, Self)> {
        SIZES.iter().map(|&size| (size, Self::ours(size), Self::plain(size))).collect()
    }

    fn ours(size: usize) -> Self {
        let domain = fresh_name();
        let sender = ours::Ours::open(&domain, size);
        Self { sender: Box::new(sender), consumer: Consumer::start("ours", &domain) }
    }

    fn plain(size: usize) -> Self {
        let domain = fresh_name();
        let sender = plain::Plain::open(&domain, size);
        Self { sender: Box::new(sender), consumer: Consumer::start("plain", &domain) }
    }

    fn socket() -> Self {
        let name = fresh_name();
        let sender = socket::Socket::open(&name);
        Self { sender: Box::new(sender), consumer: Consumer::start("socket", &name) }
    }

    /// Returns the latencies of this many frames in nanoseconds.
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

/// Returns a name that no other transport of this or another process has.
fn fresh_name() -> String {
    static NEXT: AtomicUsize = AtomicUsize::new(0);
    format!("bench-{}-{}", std::process::id(), NEXT.fetch_add(1, Ordering::Relaxed))
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
    // `cargo test --benches` only checks that it runs.
    let quick = std::env::args().any(|argument| argument == "--test");
    if quick {
        for (_, ours, plain) in &mut Way::start_all() {
            assert!(ours.latencies(5, PERIOD).len() == 5 && plain.latencies(5, PERIOD).len() == 5);
        }
        plain::remove_remains();
        return ExitCode::SUCCESS;
    }
    statistics(&mut Way::start_all());
    let missed = verdict::latencies();
    verdict::processor_time(921_600);
    plain::remove_remains();
    for name in &missed {
        eprintln!("missed in each of {} measurements: {name}", verdict::ATTEMPTS);
    }
    ExitCode::from(u8::from(!missed.is_empty()))
}

/// Reports Criterion's statistics of each transport: mean, spread, and change since the last run.
fn statistics(ways: &mut [(usize, Way, Way)]) {
    // Criterion plans its iterations from the latencies that it receives, which are a hundredth of the time that a
    // frame takes.
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
