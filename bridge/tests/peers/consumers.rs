//! Consumers that stop, that never release frames, or that are too many: other consumers and the publisher are not
//! affected.

use std::time::{Duration, Instant};

use belvedere_bridge::{Domain, Encoding, Error, Frame, Kind, Node, StreamSpec, clock::mono_ns};
use rustix::process::Signal;

use crate::processes_kit::{self, PATIENCE, Process, Random, Role, TestDomain, full, next, quantile, report};

const STREAM: &str = "camera/image_raw";
const LEN: usize = 640 * 480 * 3;

fn roles(role: &Role) {
    match role.name.as_str() {
        "publish" => publish(role),
        "consume" => consume(&role.domain),
        "hoard" => hoard(&role.domain),
        "one_too_many" => one_too_many(&role.domain),
        name => panic!("no role {name}"),
    }
}

fn spec() -> StreamSpec {
    StreamSpec::new(STREAM, Kind::Image, Encoding::Rgb8, LEN)
}

/// Sends frames of one value each at a rate, and reports the time of each loan and send. Frames are at least a period
/// apart: after a late frame the next ones are not sent faster, which would overflow any buffer.
fn publish(role: &Role) {
    let node = Node::open(&role.domain, "publisher").unwrap();
    let publisher = node.publisher(&spec()).unwrap();
    let period = Duration::from_nanos(1_000_000_000 / role.number(0));
    for value in 0_u64.. {
        let begin = Instant::now();
        let mut frame = publisher.loan(LEN).expect("the publisher never runs out of frames");
        let loaned = begin.elapsed();
        frame.header_mut().set_packed(640, 480);
        frame.payload_mut().fill(value as u8);
        let begin = Instant::now();
        frame.send().unwrap();
        let sent = Instant::now();
        report(format_args!("sent {value} {}", (loaned + (sent - begin)).as_nanos()));
        std::thread::sleep((sent + period).saturating_duration_since(Instant::now()));
    }
}

fn is_of_one_value(frame: &Frame) -> bool {
    frame.payload().chunks(997).all(|part| part[0] == frame.header().seq as u8)
}

/// Takes each frame and reports its number, the frames missed before it, and its age.
fn consume(domain: &Domain) {
    let node = Node::open(domain, "consumer").unwrap();
    let mut subscriber = node.subscriber(STREAM).unwrap();
    loop {
        subscriber.wait(Duration::from_secs(1)).unwrap();
        while let Some(frame) = subscriber.take().unwrap() {
            let age_ns = frame.age_ns();
            assert!(is_of_one_value(&frame));
            report(format_args!("frame {} {} {age_ns}", frame.header().seq, frame.missed()));
        }
    }
}

/// Takes two frames and never releases them.
fn hoard(domain: &Domain) {
    let node = Node::open(domain, "hoarder").unwrap();
    let mut subscriber = node.subscriber(STREAM).unwrap();
    let held = [next(&mut subscriber), next(&mut subscriber)];
    for round in 0.. {
        assert!(held.iter().all(is_of_one_value), "a held frame does not change");
        if subscriber.wait(Duration::from_secs(1)).unwrap() {
            let error = subscriber.take().unwrap_err();
            assert!(matches!(error, Error::TooManyHeld { max: 2, .. }), "{error}");
        }
        report(format_args!("held {round}"));
        std::thread::sleep(Duration::from_millis(50));
    }
}

/// Tries to subscribe.
fn one_too_many(domain: &Domain) {
    let node = Node::open(domain, "late").unwrap();
    let mut subscriber = node.subscriber(STREAM).unwrap();
    let begin = Instant::now();
    loop {
        match subscriber.wait(Duration::from_millis(200)) {
            Ok(true) if subscriber.take().unwrap().is_some() => {
                return report(format_args!("in {}", begin.elapsed().as_nanos()));
            }
            Ok(_) => {}
            Err(error @ Error::TooManySubscribers { max: 8, .. }) => {
                let words = error.to_string();
                assert!(words.contains(STREAM) && words.contains("close one"), "{words}");
                report("refused");
            }
            Err(error) => panic!("{error}"),
        }
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// The report of a consumer about one frame.
#[derive(Debug)]
struct Taken {
    seq: u64,
    missed: u64,
    age_ns: u64,
}

impl Taken {
    fn new(words: &[u64]) -> Self {
        Self { seq: words[0], missed: words[1], age_ns: words[2] }
    }
}

/// Returns the numbers that a process reported since the last call.
fn reports_of(process: &Process) -> Vec<Vec<u64>> {
    std::iter::from_fn(|| process.next_report(Duration::ZERO))
        .map(|line| line.split_whitespace().skip(1).map(|word| word.parse().unwrap()).collect())
        .collect()
}

/// Returns the frames that a consumer reported since the last call.
fn frames_of(consumer: &Process) -> Vec<Taken> {
    reports_of(consumer).iter().map(|words| Taken::new(words)).collect()
}

/// Returns the next frames that a consumer reports.
fn next_frames(consumer: &Process, count: usize) -> Vec<Taken> {
    (0..count).map(|_| Taken::new(&consumer.expect("frame"))).collect()
}

/// Returns the number of each frame that a publisher has sent since the last call, and the time of its loan and send.
fn sends_of(publisher: &Process) -> Vec<(u64, u64)> {
    reports_of(publisher).iter().map(|sent| (sent[0], sent[1])).collect()
}

fn times(sends: &[(u64, u64)]) -> Vec<u64> {
    sends.iter().map(|(_, took_ns)| *took_ns).collect()
}

/// Checks that every frame was taken or counted as missed by the next one. Returns the number of missed frames.
fn missed_in(frames: &[Taken]) -> u64 {
    for pair in frames.windows(2) {
        assert_eq!(
            pair[1].seq,
            pair[0].seq + 1 + pair[1].missed,
            "the count of missed frames is exact: {pair:?}"
        );
    }
    frames[1..].iter().map(|taken| taken.missed).sum()
}

/// Checks that no frame is missing that its consumer could have taken. Its buffer holds two frames. If it lost frames
/// because the machine did not run it, the next frame has waited at least one period, until another one overflowed the
/// buffer. If other processes withheld a frame, the next frame after the gap arrives at once.
fn assert_none_withheld(frames: &[Taken], rate_hz: u64) {
    missed_in(frames);
    for taken in &frames[1..] {
        assert!(
            taken.missed == 0 || taken.age_ns >= 1_000_000_000 / rate_hz,
            "withheld from its consumer: {taken:?}"
        );
    }
}

#[test]
fn a_stopped_consumer_affects_no_other_process_and_counts_its_missed_frames() {
    processes_kit::play(roles);
    let stop = Duration::from_secs(if full() { 10 } else { 4 });
    let mut domain = TestDomain::new("stopped");
    let stopped = Process::start(&domain, "consume", &[]);
    let others: Vec<_> = (0..2).map(|_| Process::start(&domain, "consume", &[])).collect();
    let publisher = Process::start(&domain, "publish", &[&30]);
    for consumer in others.iter().chain([&stopped]) {
        consumer.expect("frame");
    }
    std::thread::sleep(Duration::from_secs(2));
    let mut sends_before = times(&sends_of(&publisher));

    stopped.signal(Signal::STOP);
    publisher.expect("sent");
    sends_of(&publisher);
    // Earlier frames may have been taken before it stopped; later ones only after it continues.
    for other in &others {
        frames_of(other);
    }
    std::thread::sleep(stop);
    let sends = sends_of(&publisher);
    let mut sends_during = times(&sends);
    // The others receive frames while it is stopped.
    for other in &others {
        let frames = frames_of(other);
        assert_none_withheld(&frames, 30);
        assert!(frames.len() > sends.len() / 4, "{} frames of {}", frames.len(), sends.len());
    }
    let mut frames = frames_of(&stopped);
    stopped.signal(Signal::CONT);
    frames.extend(next_frames(&stopped, 30));

    missed_in(&frames);
    // Two frames were in its buffer.
    let missed = frames.iter().map(|taken| taken.missed).max().unwrap();
    assert!(sends.len() > 10 && missed + 2 >= sends.len() as u64, "{missed} missed of {}", sends.len());
    assert!(frames.iter().any(|taken| taken.seq > sends.last().unwrap().0 + 2), "it goes on: {frames:?}");
    let (before, during) = (quantile(&mut sends_before, 0.5), quantile(&mut sends_during, 0.5));
    println!(
        "stopped for {stop:?}: {missed} missed, told in one gap; loan and send took p50 {before} ns, p99 {} ns before, \
         p50 {during} ns, p99 {} ns, max {} ns meanwhile ({} frames)",
        quantile(&mut sends_before, 0.99),
        quantile(&mut sends_during, 0.99),
        quantile(&mut sends_during, 1.0),
        sends_during.len(),
    );
    // Half a millisecond is small compared with a period of 33 ms; a busy machine may add as much.
    assert!(during < 3 * before + 500_000, "the publisher is not slowed: {during} ns after {before} ns");

    drop((stopped, others, publisher));
    domain.assert_nothing_left_after_the_next_start();
}

#[test]
fn a_consumer_stopped_while_opening_affects_no_other_process() {
    processes_kit::play(roles);
    let rounds = if full() { 400 } else { 30 };
    let mut domain = TestDomain::new("opening");
    let mut random = Random::new(8);
    let other = Process::start(&domain, "consume", &[]);
    let publisher = Process::start(&domain, "publish", &[&100]);
    other.expect("frame");
    std::thread::sleep(Duration::from_millis(200));
    sends_of(&publisher);
    let mut frames = frames_of(&other);
    let mut newcomers_ns = Vec::new();
    for _ in 0..rounds {
        let stopped = Process::start(&domain, "consume", &[]);
        std::thread::sleep(Duration::from_micros(random.below(30_000)));
        stopped.signal(Signal::STOP);
        // Neither the publisher nor a new consumer waits for the stopped one.
        let newcomer = Process::start(&domain, "consume", &[]);
        newcomer.expect("frame");
        newcomers_ns.push(mono_ns() - newcomer.started_mono_ns);
        stopped.signal(Signal::CONT);
        stopped.expect("frame");
        frames.extend(frames_of(&other));
    }
    let mut sends = times(&sends_of(&publisher));
    println!(
        "{rounds} stops while opening: loan and send took p50 {} ns, max {} ns; another was in after p50 {:.1} ms, max \
         {:.1} ms; {} frames missed by the first",
        quantile(&mut sends, 0.5),
        quantile(&mut sends, 1.0),
        quantile(&mut newcomers_ns, 0.5) as f64 / 1e6,
        quantile(&mut newcomers_ns, 1.0) as f64 / 1e6,
        missed_in(&frames),
    );
    drop((other, publisher));
    domain.assert_nothing_left_after_the_next_start();
}

#[test]
fn consumers_that_never_release_affect_no_other_process() {
    processes_kit::play(roles);
    let mut domain = TestDomain::new("hoards");
    let hoarders: Vec<_> = (0..3).map(|_| Process::start(&domain, "hoard", &[])).collect();
    let other = Process::start(&domain, "consume", &[]);
    let publisher = Process::start(&domain, "publish", &[&100]);
    for hoarder in &hoarders {
        hoarder.expect("held");
    }
    other.expect("frame");
    std::thread::sleep(Duration::from_millis(200));
    frames_of(&other);
    // Many times the size of the pool, 8 · 4 + 1 + 2 frames.
    assert_none_withheld(&next_frames(&other, 200), 100);
    for hoarder in hoarders {
        while hoarder.next_report(Duration::ZERO).is_some() {}
        hoarder.expect("held");
        // Killed consumers return their frames, too.
        hoarder.kill();
    }
    assert_none_withheld(&next_frames(&other, 50), 100);

    drop((other, publisher));
    domain.assert_nothing_left_after_the_next_start();
}

#[test]
fn the_ninth_consumer_gets_in_when_another_goes() {
    processes_kit::play(roles);
    let mut domain = TestDomain::new("nine");
    let publisher = Process::start(&domain, "publish", &[&100]);
    publisher.expect("sent");
    let node = Node::open(&domain, "test").unwrap();
    let mut own = node.subscriber(STREAM).unwrap();
    drop(next(&mut own));
    let mut seven: Vec<_> = (0..7).map(|_| Process::start(&domain, "consume", &[])).collect();
    for consumer in &seven {
        consumer.expect("frame");
    }

    let ninth = Process::start(&domain, "one_too_many", &[]);
    ninth.expect("refused");
    ninth.expect("refused");
    let begin = Instant::now();
    drop(own);
    ninth.expect("in");
    let after_end = begin.elapsed();
    assert!(ninth.ended_well(PATIENCE));

    // Its slot is free again.
    let eighth = Process::start(&domain, "consume", &[]);
    eighth.expect("frame");
    let ninth = Process::start(&domain, "one_too_many", &[]);
    ninth.expect("refused");
    let begin = Instant::now();
    seven.pop().expect("seven").kill();
    ninth.expect("in");
    let after_kill = begin.elapsed();
    println!(
        "the ninth consumer is in {after_end:?} after the end, {after_kill:?} after the kill of another"
    );
    assert!(ninth.ended_well(PATIENCE));
    for consumer in &seven {
        assert_none_withheld(&frames_of(consumer), 100);
    }

    drop((seven, eighth, publisher, node));
    domain.assert_nothing_left_after_the_next_start();
}
