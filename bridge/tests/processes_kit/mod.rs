//! Tests with several processes: a test starts its program again, as the same test in a role.
//!
//! Such a test begins with [`play`], which acts only in those processes. They report to the test by lines on standard
//! output: see [`report`].
#![allow(dead_code, unused_imports, unreachable_pub)] // Every test program uses a part of it.

pub mod files;
pub mod plain;
pub mod random;
mod skip;

use std::{
    fmt::Display,
    io::{BufRead as _, BufReader, Write as _},
    process::{Command, Stdio},
    sync::{
        atomic::{AtomicU32, Ordering},
        mpsc::{Receiver, channel},
    },
    time::{Duration, Instant},
};

use belvedere_bridge::{Domain, Frame, Subscriber};
use rustix::process::{Pid, Signal};

pub use files::{TestDomain, Usage};
pub use random::Random;
pub use skip::skip;

/// The limit of a test's wait for something that must come. It ends a test that hangs; it is not a measure of speed, so
/// it is longer than a busy machine needs.
pub const PATIENCE: Duration = Duration::from_secs(120);

const ROLE: &str = "BRIDGE_TEST_ROLE";
const DOMAIN: &str = "BRIDGE_TEST_DOMAIN";
const ARGUMENTS: &str = "BRIDGE_TEST_ARGUMENTS";
/// The prefix of a report; the test harness also writes lines.
const MARK: &str = "@ ";

/// The role of a process: its name, its domain and its arguments.
pub struct Role {
    pub name: String,
    pub domain: Domain,
    pub arguments: Vec<String>,
}

/// Plays its role and exits, in a process that a test has started. Does nothing in the test itself.
pub fn play(roles: impl FnOnce(&Role)) {
    let Ok(name) = std::env::var(ROLE) else { return };
    // No process outlives the test that started it, even if the test is killed.
    rustix::process::set_parent_process_death_signal(Some(Signal::KILL)).unwrap();
    let domain = Domain::new(&std::env::var(DOMAIN).unwrap()).unwrap();
    let arguments = std::env::var(ARGUMENTS).unwrap_or_default();
    roles(&Role { name, domain, arguments: arguments.split_whitespace().map(str::to_owned).collect() });
    std::process::exit(0);
}

/// Returns the name of the test that runs in this thread, with which its program can be restricted to this test.
pub fn this_test() -> String {
    let name = std::thread::current().name().map(str::to_owned);
    name.filter(|name| name != "main").expect("the test harness names a test's thread after the test")
}

/// Returns a domain that no other test uses, nor another run of this test.
pub fn domain(test: &str) -> Domain {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    Domain::new(&format!("{test}-{}-{count}", std::process::id())).unwrap()
}

impl Role {
    /// Returns the argument at `index`.
    pub fn number(&self, index: usize) -> u64 {
        self.arguments[index].parse().unwrap()
    }
}

/// Reports one line to the parent.
pub fn report(line: impl Display) {
    let mut out = std::io::stdout().lock();
    writeln!(out, "\n{MARK}{line}").and_then(|()| out.flush()).expect("a parent that listens");
}

/// Another process of this test, which is killed when this is dropped.
pub struct Process {
    child: std::process::Child,
    reports: Receiver<String>,
    /// `CLOCK_MONOTONIC` just before it was started.
    pub started_mono_ns: u64,
}

impl Process {
    pub fn start(domain: &Domain, role: &str, arguments: &[&dyn Display]) -> Self {
        Self::start_under(&[], domain, role, arguments)
    }

    /// Starts a process through another command, such as `unshare`, which receives it as its last arguments.
    pub fn start_under(runner: &[&str], domain: &Domain, role: &str, arguments: &[&dyn Display]) -> Self {
        assert!(
            std::env::var_os(ROLE).is_none(),
            "the test does not begin with `play`: it would start itself for ever"
        );
        let this = std::env::current_exe().unwrap();
        let mut command = match runner {
            [] => Command::new(this),
            [program, options @ ..] => {
                let mut command = Command::new(program);
                command.args(options).arg(this);
                command
            }
        };
        let arguments: Vec<_> = arguments.iter().map(ToString::to_string).collect();
        let started_mono_ns = belvedere_bridge::clock::mono_ns();
        let mut child = command
            .args(["--exact", &this_test(), "--nocapture"])
            .env(ROLE, role)
            .env(DOMAIN, domain.as_str())
            .env(ARGUMENTS, arguments.join(" "))
            // All processes use the same seed, also if it is a new one.
            .envs(random::seed().map(|seed| (random::SEED, seed.to_string())))
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let lines = BufReader::new(child.stdout.take().unwrap()).lines();
        let (sender, reports) = channel();
        std::thread::spawn(move || {
            for line in lines.map_while(Result::ok) {
                if let Some((_, report)) = line.split_once(MARK)
                    && sender.send(report.to_owned()).is_err()
                {
                    return;
                }
            }
        });
        Self { child, reports, started_mono_ns }
    }

    /// Returns the next report; `None` if the timeout passes or the process ends without one.
    pub fn next_report(&self, timeout: Duration) -> Option<String> {
        self.reports.recv_timeout(timeout).ok()
    }

    /// Returns the numbers of the next report that begins with `what`.
    pub fn expect(&self, what: &str) -> Vec<u64> {
        self.expect_within(what, PATIENCE)
    }

    pub fn expect_within(&self, what: &str, timeout: Duration) -> Vec<u64> {
        let deadline = Instant::now() + timeout;
        while let Some(line) = self.next_report(deadline.saturating_duration_since(Instant::now())) {
            let mut words = line.split_whitespace();
            if words.next() == Some(what) {
                return words.map(|word| word.parse().unwrap()).collect();
            }
        }
        panic!("process {} ended, or {timeout:?} passed, without the report \"{what}\"", self.child.id());
    }

    pub fn pid(&self) -> u32 {
        self.child.id()
    }

    pub fn signal(&self, signal: Signal) {
        rustix::process::kill_process(Pid::from_child(&self.child), signal).unwrap();
    }

    /// Kills the process with SIGKILL and reaps it.
    pub fn kill(mut self) {
        self.end();
    }

    /// Waits for the process to end by itself. Returns true if it succeeded.
    pub fn ended_well(mut self, timeout: Duration) -> bool {
        let deadline = Instant::now() + timeout;
        while Instant::now() < deadline {
            if let Some(status) = self.child.try_wait().unwrap() {
                return status.success();
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        false
    }

    fn end(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        self.end();
    }
}

/// Returns the next frame.
pub fn next(subscriber: &mut Subscriber) -> Frame {
    let deadline = Instant::now() + PATIENCE;
    while Instant::now() < deadline {
        if subscriber.wait(Duration::from_millis(200)).unwrap()
            && let Some(frame) = subscriber.take().unwrap()
        {
            return frame;
        }
    }
    panic!("no frame in {PATIENCE:?}");
}

/// Returns true if `BELVEDERE_FULL=1` requests the full length of a test that is shorter by default.
pub fn full() -> bool {
    std::env::var_os("BELVEDERE_FULL").is_some_and(|value| !value.is_empty() && value != "0")
}

/// Returns the value that `share` of the sorted `values` do not exceed.
pub fn quantile(values: &mut [u64], share: f64) -> u64 {
    values.sort_unstable();
    let rank = (share * values.len() as f64).ceil() as usize;
    values.get(rank.max(1) - 1).copied().unwrap_or(0)
}
