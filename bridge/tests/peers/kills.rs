//! SIGKILL at any time: 100 times, to the publisher or a consumer, while it opens, loans, sends, waits or takes.
//!
//! No file is left behind, no stream blocks, and frames resume about as soon as they start without a kill.
//! `BELVEDERE_FULL=1` kills 2000 times, `BELVEDERE_SEED` chooses other times.

use std::time::{Duration, Instant};

use belvedere_bridge::{Domain, Encoding, Kind, Node, StreamSpec, clock::mono_ns};

use crate::processes_kit::{
    self, PATIENCE, Process, Random, Role, TestDomain, Usage, full, quantile, report,
};

const WIDTH: u32 = 64;
const LEN: usize = 64 * 64;
const CONSUMERS: usize = 3;
/// Number of starts without a kill, for comparison with resumptions.
const STARTS: usize = 7;
const STREAM: &str = "camera/image_raw";

fn roles(role: &Role) {
    match role.name.as_str() {
        "publish" => publish(&role.domain),
        "consume" => consume(&role.domain),
        name => panic!("no role {name}"),
    }
}

/// Publishes in bursts, so that a kill hits a loan or a send about as often as a pause.
fn publish(domain: &Domain) {
    let node = Node::open(domain, "publisher").unwrap();
    let spec = StreamSpec::new(STREAM, Kind::Image, Encoding::Mono8, LEN);
    let publisher = node.publisher(&spec).unwrap();
    let mut value = 0_u8;
    loop {
        let burst_end = Instant::now() + Duration::from_millis(1);
        while Instant::now() < burst_end {
            let mut frame = publisher.loan(LEN).unwrap();
            if value == 0 {
                report(format_args!("session {}", frame.header().session));
            }
            value = value.checked_add(1).unwrap_or(1);
            frame.header_mut().set_packed(WIDTH, WIDTH);
            frame.payload_mut().fill(value);
            frame.send().unwrap();
        }
        std::thread::sleep(Duration::from_millis(3));
    }
}

/// Takes all frames, holds one, and reports the first frame of each publisher.
fn consume(domain: &Domain) {
    let node = Node::open(domain, "consumer").unwrap();
    let mut subscriber = node.subscriber(STREAM).unwrap();
    let mut session = 0;
    let mut held = None;
    loop {
        subscriber.wait(Duration::from_millis(500)).unwrap();
        while let Some(frame) = subscriber.take().unwrap() {
            let header = frame.header();
            if header.session != session {
                session = header.session;
                report(format_args!("session {session} {}", mono_ns()));
            }
            let (first, payload) = (frame.payload()[0], frame.payload());
            assert!(payload.iter().all(|&byte| byte == first), "a frame is of one value");
            if let Some((frame, value)) = held.replace((frame, first)) {
                let frame: belvedere_bridge::Frame = frame;
                assert!(frame.payload().iter().all(|&byte| byte == value), "a held frame does not change");
            }
        }
    }
}

#[derive(Clone, Copy, Debug)]
enum Victim {
    Publisher,
    Consumer(usize),
}

impl Victim {
    fn start(self, domain: &Domain) -> Process {
        Process::start(domain, if matches!(self, Self::Publisher) { "publish" } else { "consume" }, &[])
    }
}

/// The running processes.
struct Troupe {
    publisher: Process,
    session: u64,
    consumers: Vec<Process>,
}

impl Troupe {
    fn start(domain: &Domain) -> Self {
        let consumers = (0..CONSUMERS).map(|index| Victim::Consumer(index).start(domain)).collect();
        Self { publisher: Victim::Publisher.start(domain), session: 0, consumers }
    }

    fn of(&mut self, victim: Victim) -> &mut Process {
        match victim {
            Victim::Publisher => &mut self.publisher,
            Victim::Consumer(index) => &mut self.consumers[index],
        }
    }

    /// Kills a process and starts it again.
    fn replace(&mut self, victim: Victim, domain: &Domain) {
        let killed = std::mem::replace(self.of(victim), victim.start(domain));
        killed.kill();
    }

    /// Waits until all consumers have a frame of the living publisher. Returns the nanoseconds from the start of
    /// `restarted` to that frame, for each consumer that had to wait for one.
    fn resume(&mut self, restarted: &[Victim]) -> Vec<u64> {
        let publisher_started = restarted.iter().any(|victim| matches!(victim, Victim::Publisher));
        if publisher_started {
            self.session = self.publisher.expect("session")[0];
        }
        let mut times = Vec::new();
        for (index, consumer) in self.consumers.iter().enumerate() {
            let started = restarted.iter().any(|victim| matches!(victim, Victim::Consumer(i) if *i == index));
            if !publisher_started && !started {
                continue;
            }
            let deadline = Instant::now() + PATIENCE;
            let first_frame = loop {
                let line = consumer.expect_within("session", PATIENCE);
                if line[0] == self.session {
                    break line[1];
                }
                assert!(Instant::now() < deadline, "consumer {index} is stuck in an old session");
            };
            let since = if started { consumer.started_mono_ns } else { 0 }.max(if publisher_started {
                self.publisher.started_mono_ns
            } else {
                0
            });
            times.push(first_frame.saturating_sub(since));
        }
        times
    }
}

/// Cleans up until the domain has the expected usage. The files of a process that was killed early count as remnants
/// only one second after their creation.
fn settle(observer: &Node, domain: &mut TestDomain, steady: Usage, patience: Duration) -> Result<(), Usage> {
    let deadline = Instant::now() + patience;
    loop {
        observer.clean_up_dead();
        match domain.comes_to(steady, Duration::from_millis(50)) {
            Err(usage) if Instant::now() > deadline => return Err(usage),
            Err(_) => {}
            Ok(()) => return Ok(()),
        }
    }
}

#[test]
fn kills_leave_no_files_and_block_no_stream() {
    processes_kit::play(roles);
    let kills = if full() { 2000 } else { 100 };
    let begin = Instant::now();
    let mut random = Random::new(4);
    let mut domain = TestDomain::new("kills");
    let observer = Node::open(&domain, "observer").unwrap();
    let all: Vec<_> =
        std::iter::once(Victim::Publisher).chain((0..CONSUMERS).map(Victim::Consumer)).collect();
    let mut start_ns: Vec<_> = (0..STARTS)
        .flat_map(|_| {
            let domain = TestDomain::new("starts");
            Troupe::start(&domain).resume(&all)
        })
        .collect();
    let mut troupe = Troupe::start(&domain);
    troupe.resume(&all);
    std::thread::sleep(Duration::from_millis(200));
    let steady = domain.usage();
    println!("steady: {steady:?}");

    let mut resume_ns = Vec::new();
    let mut lingering = 0;
    let mut killed = 0;
    let (mut publishers, mut while_opening) = (0, 0);
    while killed < kills {
        // At any time of a burst or of the pause after it.
        std::thread::sleep(Duration::from_micros(random.below(8_000)));
        let victim = if random.below(2) == 0 { Victim::Publisher } else { random.one_of(&all[1..]) };
        let mut restarted = vec![victim];
        troupe.replace(victim, &domain);
        killed += 1;
        publishers += usize::from(matches!(victim, Victim::Publisher));
        // Up to three more kills while it opens; sometimes of another process.
        for _ in 0..random.below(4) {
            std::thread::sleep(Duration::from_micros(random.below(20_000)));
            let again = if random.below(4) == 0 { random.one_of(&all) } else { victim };
            troupe.replace(again, &domain);
            restarted.push(again);
            killed += 1;
            while_opening += 1;
            publishers += usize::from(matches!(again, Victim::Publisher));
        }
        resume_ns.extend(troupe.resume(&restarted));
        if let Err(usage) = settle(&observer, &mut domain, steady, Duration::from_secs(3)) {
            // A process killed while it was connecting leaves its half of a connection, some hundred bytes, as long as
            // the other end lives.
            lingering += 1;
            println!(
                "after {killed} kills, {restarted:?}: {usage:?}, not {steady:?}, until the other end closes"
            );
            for &victim in &all {
                troupe.replace(victim, &domain);
            }
            resume_ns.extend(troupe.resume(&all));
            settle(&observer, &mut domain, steady, PATIENCE)
                .unwrap_or_else(|usage| panic!("{usage:?}, not {steady:?}: {:#?}", domain.files()));
        }
    }
    let (p50, p99) = (quantile(&mut resume_ns, 0.5), quantile(&mut resume_ns, 0.99));
    let (max, start) = (quantile(&mut resume_ns, 1.0), quantile(&mut start_ns, 0.5));
    println!(
        "{killed} kills in {:.0} s, {publishers} of the publisher, {while_opening} while opening; resumed after \
         p50 {:.1} ms, p99 {:.1} ms, max {:.1} ms ({} resumptions); begun without a kill after p50 {:.1} ms",
        begin.elapsed().as_secs_f64(),
        p50 as f64 / 1e6,
        p99 as f64 / 1e6,
        max as f64 / 1e6,
        resume_ns.len(),
        start as f64 / 1e6,
    );
    drop(troupe);
    drop(observer);
    domain.assert_nothing_left_after_the_next_start();
    assert!(lingering <= killed / 10, "{lingering} halves of connections in {killed} kills");
    assert!(
        p50 < 10 * start,
        "what was killed is waited for: frames resume after {p50} ns, begin after {start} ns"
    );
}
