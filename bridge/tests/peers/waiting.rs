//! Waiting in another event loop, and for several streams at once.

use std::{
    os::fd::AsRawFd as _,
    time::{Duration, Instant},
};

use belvedere_bridge::{Encoding, Kind, Node, Publisher, StreamSpec, Subscriber, Synchronizer};
use rustix::event::{PollFd, PollFlags, Timespec, poll};

use crate::processes_kit::{PATIENCE, domain};

fn node(test: &str) -> Node {
    Node::open(&domain(test), test).unwrap()
}

fn publisher(node: &Node, topic: &str) -> Publisher {
    node.publisher(&StreamSpec::new(topic, Kind::Image, Encoding::Mono8, 4)).unwrap()
}

fn send(publisher: &Publisher, stamp_ns: u64) {
    let mut frame = publisher.loan(4).unwrap();
    frame.header_mut().set_packed(2, 2);
    frame.header_mut().stamp_ns = stamp_ns;
    frame.payload_mut().fill(0);
    frame.send().unwrap();
}

/// Returns true if the descriptor becomes readable within the timeout.
fn readable(subscriber: &mut Subscriber, timeout: Duration) -> bool {
    let timeout =
        Timespec { tv_sec: timeout.as_secs().cast_signed(), tv_nsec: timeout.subsec_nanos().into() };
    poll(&mut [PollFd::from_borrowed_fd(subscriber.readiness().unwrap(), PollFlags::IN)], Some(&timeout))
        .unwrap()
        > 0
}

/// Acts like another event loop: only polls the descriptor, and takes frames until there is none.
fn next_stamp(subscriber: &mut Subscriber) -> u64 {
    let deadline = Instant::now() + PATIENCE;
    while Instant::now() < deadline {
        if readable(subscriber, PATIENCE)
            && let Some(frame) = subscriber.take().unwrap()
        {
            return frame.header().stamp_ns;
        }
    }
    panic!("the descriptor never announced the frame");
}

#[test]
fn a_descriptor_stays_readable_while_frames_wait_and_only_then() {
    let node = node("fd");
    let publisher = publisher(&node, "image");
    let mut subscriber = node.subscriber("image").unwrap();
    // The descriptor is created before the stream is connected.
    while !(readable(&mut subscriber, PATIENCE)
        && subscriber.take().unwrap().is_none()
        && publisher.subscribers() == 1)
    {}
    assert!(!readable(&mut subscriber, Duration::from_millis(20)), "nothing has come");
    send(&publisher, 1);
    send(&publisher, 2);
    assert!(readable(&mut subscriber, Duration::ZERO));
    assert_eq!(subscriber.take().unwrap().unwrap().header().stamp_ns, 1);
    assert!(readable(&mut subscriber, Duration::ZERO), "one is left");
    assert_eq!(subscriber.take().unwrap().unwrap().header().stamp_ns, 2);
    assert!(subscriber.take().unwrap().is_none());
    assert!(!readable(&mut subscriber, Duration::from_millis(20)), "all was taken");
}

#[test]
fn one_descriptor_follows_every_publisher() {
    let node = node("fd-life");
    let mut subscriber = node.subscriber("image").unwrap();
    let fd = subscriber.readiness().unwrap().as_raw_fd();
    for life in 0..5 {
        let publisher = publisher(&node, "image");
        // The descriptor alone makes the loop search for the stream.
        while publisher.subscribers() == 0 {
            readable(&mut subscriber, PATIENCE);
            assert!(subscriber.take().unwrap().is_none());
        }
        for stamp_ns in life * 10..life * 10 + 5 {
            send(&publisher, stamp_ns);
            assert_eq!(next_stamp(&mut subscriber), stamp_ns);
        }
        drop(publisher);
        while subscriber.publishers() > 0 {
            readable(&mut subscriber, PATIENCE);
            assert!(subscriber.take().unwrap().is_none());
        }
        assert_eq!(subscriber.readiness().unwrap().as_raw_fd(), fd);
    }
}

/// Opens three connected streams.
fn trio(test: &str, tolerance: Duration) -> (Node, [Publisher; 3], Synchronizer<3>) {
    let node = node(test);
    let topics = ["rgb", "depth", "info"];
    let publishers = topics.map(|topic| publisher(&node, topic));
    let mut sets = Synchronizer::within(&node, topics, tolerance).unwrap();
    assert!(!sets.wait(Duration::ZERO).unwrap());
    assert!(publishers.iter().all(|publisher| publisher.subscribers() == 1));
    (node, publishers, sets)
}

fn stamps(sets: &mut Synchronizer<3>) -> [u64; 3] {
    assert!(sets.wait(PATIENCE).unwrap());
    sets.take().unwrap().unwrap().map(|frame| frame.header().stamp_ns)
}

#[test]
fn only_frames_of_one_stamp_make_an_exact_set() {
    let (_node, [rgb, depth, info], mut sets) = trio("sync", Duration::ZERO);
    for stamp_ns in [10, 20] {
        send(&rgb, stamp_ns);
    }
    send(&depth, 20);
    assert!(!sets.wait(Duration::from_millis(20)).unwrap(), "one stream has nothing");
    send(&info, 15);
    send(&info, 20);
    assert_eq!(stamps(&mut sets), [20; 3]);
    assert_eq!(sets.skipped(), 2);
    for stamp_ns in 1..100 {
        for publisher in [&info, &rgb, &depth] {
            send(publisher, 30 * stamp_ns);
        }
        assert_eq!(stamps(&mut sets), [30 * stamp_ns; 3]);
    }
    assert_eq!((sets.skipped(), sets.missed_total()), (2, 0));
}

#[test]
fn near_frames_make_an_approximate_set() {
    let (_node, [rgb, depth, info], mut sets) = trio("sync-near", Duration::from_nanos(5));
    send(&rgb, 10);
    send(&depth, 14);
    send(&info, 16);
    send(&rgb, 18);
    assert_eq!(stamps(&mut sets), [18, 14, 16], "10 is too old for 16");
}

#[test]
fn a_set_may_be_kept_while_the_next_one_comes() {
    let (_node, publishers, mut sets) = trio("sync-hold", Duration::ZERO);
    let mut kept = None;
    for stamp_ns in 0..20 {
        for publisher in &publishers {
            send(publisher, stamp_ns);
        }
        assert!(sets.wait(PATIENCE).unwrap());
        let set = sets.take().unwrap().unwrap();
        assert!(set.iter().all(|frame| frame.header().stamp_ns == stamp_ns));
        kept = Some(set);
    }
    assert!(kept.is_some());
}

#[test]
fn sets_continue_after_a_reset_of_time() {
    let (node, publishers, mut sets) = trio("sync-anew", Duration::ZERO);
    for publisher in &publishers {
        send(publisher, 1_000_000);
    }
    assert_eq!(stamps(&mut sets), [1_000_000; 3]);
    // Time goes back, as on a reset of the world, while a frame of the old time waits for its partners.
    send(&publishers[0], 2_000_000);
    assert!(!sets.wait(Duration::from_millis(20)).unwrap());
    for publisher in &publishers {
        send(publisher, 5);
    }
    for publisher in &publishers {
        send(publisher, 6);
    }
    assert_eq!(stamps(&mut sets)[1], 5, "the first complete set of the new time");
    // A restart.
    drop(publishers);
    let publishers = ["rgb", "depth", "info"].map(|topic| publisher(&node, topic));
    let deadline = Instant::now() + PATIENCE;
    while publishers.iter().any(|publisher| publisher.subscribers() == 0) {
        assert!(Instant::now() < deadline, "the new publishers are not found");
        sets.wait(Duration::from_millis(10)).unwrap();
        let _ = sets.take().unwrap();
    }
    let mut newest = [0; 3];
    for stamp_ns in 0..3 {
        for publisher in &publishers {
            send(publisher, stamp_ns);
        }
        // The complete set of the old time comes first.
        while sets.wait(Duration::from_millis(50)).unwrap() {
            newest = stamps(&mut sets);
        }
    }
    assert_eq!(newest, [2; 3]);
}
