//! The consumer process: takes frames and reports their latencies.

use std::{
    io::{BufRead as _, BufReader, Write as _},
    process::{Child, ChildStdin, ChildStdout, Command, Stdio},
    time::Duration,
};

use crate::{ours, plain, socket};

/// First argument of a consumer.
pub(crate) const ROLE: &str = "--consumer-of-the-latency-benchmark";

/// The receiving end of one transport.
pub(crate) trait Receiver {
    /// Waits for a frame and returns when it was sent; `None` if none arrives within a second.
    fn take(&mut self) -> Option<u64>;
}

/// Runs the consumer: answers each line of input (a number of frames, or a request for the processor time) with a line.
pub(crate) fn run(way: &str, domain: &str) {
    let mut receiver: Box<dyn Receiver> = match way {
        "ours" => Box::new(ours::OursTaken::open(domain)),
        "plain" => Box::new(plain::PlainTaken::open(domain)),
        _ => Box::new(socket::SocketTaken::open(domain)),
    };
    println!("ready");
    for line in std::io::stdin().lock().lines() {
        let Ok(line) = line else { return };
        let answer = match line.parse() {
            Ok(frames) => latencies(receiver.as_mut(), frames),
            Err(_) => processor_ns().to_string(),
        };
        println!("{answer}");
    }
}

fn latencies(receiver: &mut dyn Receiver, frames: usize) -> String {
    println!("expecting");
    let mut latencies = Vec::with_capacity(frames);
    while latencies.len() < frames {
        match receiver.take() {
            Some(sent_ns) => latencies.push(belvedere_bridge::clock::mono_ns().saturating_sub(sent_ns)),
            // A frame was lost to overflow on a busy machine.
            None => break,
        }
    }
    latencies.iter().map(u64::to_string).collect::<Vec<_>>().join(" ")
}

fn processor_ns() -> u64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    time.tv_sec as u64 * 1_000_000_000 + time.tv_nsec as u64
}

/// A consumer in another process.
pub(crate) struct Consumer {
    process: Child,
    /// `None` during drop.
    input: Option<ChildStdin>,
    output: BufReader<ChildStdout>,
}

impl Consumer {
    /// Starts a consumer; it is connected when this returns.
    pub(crate) fn start(way: &str, domain: &str) -> Self {
        let mut process = Command::new(std::env::current_exe().expect("this program has a path"))
            .args([ROLE, way, domain])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("the consumer starts");
        let input = process.stdin.take();
        let output = BufReader::new(process.stdout.take().expect("piped"));
        let mut consumer = Self { process, input, output };
        assert_eq!(consumer.line(), "ready");
        consumer
    }

    /// Asks the consumer to take this many frames.
    pub(crate) fn expect(&mut self, frames: usize) {
        self.tell(&frames.to_string());
        assert_eq!(self.line(), "expecting");
    }

    /// Returns the latency of each frame in nanoseconds.
    pub(crate) fn answer(&mut self) -> Vec<u64> {
        self.line().split_whitespace().map(|number| number.parse().expect("a number")).collect()
    }

    /// Returns the processor time that the consumer has used.
    pub(crate) fn processor_time(&mut self) -> Duration {
        self.tell("time");
        Duration::from_nanos(self.line().parse().expect("a number"))
    }

    fn tell(&mut self, line: &str) {
        writeln!(self.input.as_mut().expect("open"), "{line}").expect("the consumer lives");
    }

    fn line(&mut self) -> String {
        let mut line = String::new();
        self.output.read_line(&mut line).expect("the consumer lives");
        line.trim_end().to_owned()
    }
}

impl Drop for Consumer {
    fn drop(&mut self) {
        // Without input the consumer ends by itself, and leaves no file.
        drop(self.input.take());
        let _ = self.process.wait();
    }
}
