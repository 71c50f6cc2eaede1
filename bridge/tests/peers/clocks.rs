//! Clock jumps: simulated time that goes backward, by years, to its limits; and a consumer with another monotonic
//! clock. Nothing overflows, nothing hangs, no frame is lost.
//!
//! The bridge itself uses no clock that can be set: waits, silence and age use `CLOCK_MONOTONIC`.

use std::{
    process::Command,
    time::{Duration, Instant},
};

use belvedere_bridge::{
    Domain, Encoding, Kind, Node, Publisher, StreamSpec, Synchronizer, clock::mono_ns, payload::Clock,
};

use crate::processes_kit::{self, PATIENCE, Process, TestDomain, next, report, skip};

const YEAR_NS: u64 = 365 * 86_400 * 1_000_000_000;
const JUMPS: [u64; 12] =
    [0, 1, YEAR_NS, 2, u64::MAX, 0, u64::MAX, u64::MAX - 1, 1 << 63, 30 * YEAR_NS, 5, u64::MAX];

/// Reports its clock, then the age of every frame.
fn consume(domain: &Domain) {
    report(format_args!("clock {}", mono_ns()));
    let node = Node::open(domain, "consumer").unwrap();
    let mut subscriber = node.subscriber("clock").unwrap();
    loop {
        let frame = next(&mut subscriber);
        report(format_args!("frame {} {} {}", frame.header().seq, frame.age_ns(), frame.missed()));
        let begin = Instant::now();
        let _ = subscriber.wait(Duration::from_millis(1)).unwrap();
        assert!(begin.elapsed() < PATIENCE, "a short wait is short");
        assert!(subscriber.silence() < PATIENCE);
    }
}

fn send(publisher: &Publisher, stamp_ns: u64) {
    publisher.send_structs(stamp_ns, &[Clock { now_ns: stamp_ns }]).unwrap();
}

#[test]
fn stamps_may_be_anything() {
    let mut domain = TestDomain::new("stamps");
    let node = Node::open(&domain, "test").unwrap();
    let publisher = node.publisher(&StreamSpec::structs("clock", Kind::Clock, 1)).unwrap();
    let mut subscriber = node.subscriber("clock").unwrap();
    assert!(subscriber.take().unwrap().is_none());
    for stamp_ns in JUMPS {
        send(&publisher, stamp_ns);
        let frame = next(&mut subscriber);
        assert_eq!((frame.header().stamp_ns, frame.missed(), frame.restarted()), (stamp_ns, 0, false));
        assert_eq!(frame.message::<Clock>().unwrap().now_ns, stamp_ns);
        assert!(u128::from(frame.age_ns()) < PATIENCE.as_nanos(), "an age is real time, whatever the stamp");
    }
    for stamp_ns in JUMPS {
        send(&publisher, stamp_ns);
    }
    // The newest frame is the one sent last.
    assert_eq!(subscriber.take_newest().unwrap().unwrap().header().stamp_ns, JUMPS[11]);
    drop((publisher, subscriber, node));
    domain.assert_nothing_left();
}

#[test]
fn a_synchronizer_goes_on_after_every_jump() {
    for tolerance in [Duration::ZERO, Duration::from_nanos(3), Duration::MAX] {
        let mut domain = TestDomain::new("sets");
        let node = Node::open(&domain, "test").unwrap();
        let spec = |topic| StreamSpec::new(topic, Kind::Image, Encoding::Mono8, 64);
        let publishers = ["left", "right"].map(|topic| node.publisher(&spec(topic)).unwrap());
        let mut sets = Synchronizer::within(&node, ["left", "right"], tolerance).unwrap();
        assert!(sets.take().unwrap().is_none());
        for stamp_ns in JUMPS {
            for publisher in &publishers {
                let mut frame = publisher.loan(64).unwrap();
                frame.header_mut().set_packed(8, 8);
                frame.header_mut().stamp_ns = stamp_ns;
                frame.send().unwrap();
            }
            assert!(sets.wait(PATIENCE).unwrap(), "a set of {stamp_ns} ns, within {tolerance:?}");
            let [left, right] = sets.take().unwrap().expect("waited for");
            assert_eq!((left.header().stamp_ns, right.header().stamp_ns), (stamp_ns, stamp_ns));
        }
        drop((publishers, sets, node));
        domain.assert_nothing_left();
    }
}

#[test]
fn waits_of_any_length_end() {
    let domain = TestDomain::new("waits");
    let node = Node::open(&domain, "test").unwrap();
    let publisher = node.publisher(&StreamSpec::structs("clock", Kind::Clock, 1)).unwrap();
    let mut subscriber = node.subscriber("clock").unwrap();
    assert!(!subscriber.wait(Duration::ZERO).unwrap());
    std::thread::scope(|scope| {
        scope.spawn(|| {
            std::thread::sleep(Duration::from_millis(50));
            send(&publisher, 1);
        });
        assert!(subscriber.wait(Duration::MAX).unwrap());
    });
}

/// A container may have its own monotonic clock, ahead of or behind the publisher's.
#[test]
fn a_consumer_with_another_monotonic_clock() {
    processes_kit::play(|role| consume(&role.domain));
    let uptime_s = mono_ns() / 1_000_000_000;
    let behind_s = -i64::try_from(uptime_s / 2).unwrap();
    for offset_s in [10 * 365 * 86_400_i64, behind_s] {
        let offset = offset_s.to_string();
        let runner =
            ["unshare", "--time", "--fork", "--kill-child", "--monotonic", &offset, "--boottime", &offset];
        let allowed = Command::new(runner[0]).args(&runner[1..]).arg("true").output();
        if !allowed.is_ok_and(|output| output.status.success()) {
            return skip("this user may not make a time namespace (unshare --time)");
        }
        let mut domain = TestDomain::new("namespace");
        let node = Node::open(&domain, "test").unwrap();
        let publisher = node.publisher(&StreamSpec::structs("clock", Kind::Clock, 1)).unwrap();
        let consumer = Process::start_under(&runner, &domain, "consume", &[]);
        let shift_s = (i128::from(consumer.expect("clock")[0]) - i128::from(mono_ns())) / 1_000_000_000;
        assert!((shift_s - i128::from(offset_s)).abs() < 600, "the clock is {shift_s} s ahead");

        let deadline = Instant::now() + PATIENCE;
        while publisher.subscribers() == 0 {
            assert!(Instant::now() < deadline, "there is no subscriber");
            std::thread::sleep(Duration::from_millis(1));
        }
        for seq in 0..20 {
            send(&publisher, seq);
            let [got, age_ns, missed] = consumer.expect("frame")[..] else { panic!("three numbers") };
            assert_eq!((got, missed), (seq, 0));
            if offset_s > 0 {
                assert!(age_ns / 1_000_000_000 >= offset_s as u64 - 600, "{age_ns} ns");
            } else {
                assert_eq!(age_ns, 0, "from the future: an age of nothing, and no overflow");
            }
        }
        println!("a consumer {shift_s} s ahead got every frame");
        drop((consumer, publisher));
        node.clean_up_dead();
        drop(node);
        domain.assert_nothing_left_after_the_next_start();
    }
}
