//! Busy polling: polling for frames when they are due, instead of sleeping until they are announced.
//!
//! A plain iceoryx2 publisher that announces nothing shows the difference: a sleeping subscriber finds its frames when
//! it checks the stream every 100 ms, long after they were sent; a polling one finds them at once.

use std::{
    ops::ControlFlow,
    sync::atomic::{AtomicBool, Ordering},
    time::{Duration, Instant},
};

use belvedere_bridge::{Domain, Encoding, Frame, FrameHeader, Kind, Node, StreamSpec, Subscriber, clock};
use rustix::event::{PollFd, PollFlags, Timespec, poll};

use crate::processes_kit::{self, PATIENCE, plain, skip};

const TOPIC: &str = "image";
const PERIOD: Duration = Duration::from_millis(20);
const LIMIT: Duration = Duration::from_millis(10);
/// Smaller than the age of the oldest queued frame of a sleeping subscriber, which is four to five periods.
const FRESH: Duration = Duration::from_millis(30);

/// Sends a frame every period without notification, until it is asked to stop.
fn publish_in_silence(domain: &Domain, stopping: &AtomicBool) {
    let (node, name) = (plain::node(domain), plain::service(TOPIC));
    let frames = node
        .service_builder(&name)
        .publish_subscribe::<[u8]>()
        .user_header::<FrameHeader>()
        .subscriber_max_buffer_size(16)
        .history_size(0)
        .create()
        .unwrap();
    let _events = node.service_builder(&name).event().open_or_create().unwrap();
    let port = frames.publisher_builder().initial_max_slice_len(8).create().unwrap();
    let mut header = FrameHeader::new(Kind::Clock, Encoding::Struct);
    header.payload_len = header.set_packed(1, 1) as u64;
    header.session = 7;
    let begin = Instant::now();
    while !stopping.load(Ordering::Relaxed) {
        header.seq += 1;
        let next = begin + PERIOD * u32::try_from(header.seq).unwrap();
        std::thread::sleep(next.saturating_duration_since(Instant::now()));
        let mut sample = port.loan_slice(8).unwrap();
        header.publish_mono_ns = clock::mono_ns();
        *sample.user_header_mut() = header;
        sample.send().unwrap();
    }
}

fn age(frame: &Frame) -> Duration {
    Duration::from_nanos(frame.age_ns())
}

/// Receives the stream with `wait` until `look` has seen enough of the first frames after each wakeup.
fn follow(
    test: &str,
    limit: Duration,
    mut wait: impl FnMut(&mut Subscriber),
    mut look: impl FnMut(&Frame) -> ControlFlow<()>,
) {
    let domain = processes_kit::domain(test);
    let node = Node::open(&domain, test).unwrap();
    let mut subscriber = node.subscriber(TOPIC).unwrap();
    subscriber.set_busy_poll(limit);
    let stopping = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| publish_in_silence(&domain, &stopping));
        let begin = Instant::now();
        let mut last = 0;
        'following: while begin.elapsed() < PATIENCE {
            wait(&mut subscriber);
            let mut is_first = true;
            while let Some(frame) = subscriber.take().unwrap() {
                let seq = frame.header().seq;
                assert!(last == 0 || seq == last + 1, "{seq} after {last}");
                last = seq;
                if std::mem::take(&mut is_first) && look(&frame).is_break() {
                    break 'following;
                }
            }
        }
        stopping.store(true, Ordering::Relaxed);
    });
    // The last node of the bridge removes what iceoryx2's publisher leaves.
    drop(subscriber);
}

/// Receives until twenty wakeups found fresh frames; on a busy machine some do not.
fn until_twenty_are_fresh(test: &str, wait: impl FnMut(&mut Subscriber)) {
    if std::thread::available_parallelism().unwrap().get() == 1 {
        return skip("on one core no subscriber polls while the publisher waits for it");
    }
    let (mut fresh, mut seen) = (0, 0);
    follow(test, LIMIT, wait, |frame| {
        seen += 1;
        fresh += usize::from(age(frame) < FRESH);
        if fresh == 20 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert_eq!(fresh, 20, "of {seen}");
}

#[test]
fn a_sleeping_subscriber_finds_unannounced_frames_late() {
    // Some frames are fresh: the first is found together with the stream, and a busy machine may delay the publisher.
    let most_are_late = || {
        let mut ages = Vec::new();
        let wait = |subscriber: &mut Subscriber| assert!(subscriber.wait(PATIENCE).unwrap());
        follow("asleep", Duration::ZERO, wait, |frame| {
            ages.push(age(frame));
            if ages.len() == 8 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        println!("{ages:?}");
        ages.iter().filter(|age| **age > FRESH).count() >= 5
    };
    assert!((0..5).any(|_| most_are_late()), "unannounced frames are found early");
}

#[test]
fn a_polling_subscriber_finds_unannounced_frames_at_once() {
    until_twenty_are_fresh("awake", |subscriber| assert!(subscriber.wait(PATIENCE).unwrap()));
}

#[test]
fn a_loop_on_the_descriptor_finds_unannounced_frames_at_once() {
    until_twenty_are_fresh("awake-fd", |subscriber| {
        let timeout = Timespec { tv_sec: PATIENCE.as_secs().cast_signed(), tv_nsec: 0 };
        let fd = PollFd::from_borrowed_fd(subscriber.readiness().unwrap(), PollFlags::IN);
        poll(&mut [fd], Some(&timeout)).unwrap();
    });
}

#[test]
fn every_frame_of_every_publisher_arrives_and_timeouts_end_the_wait() {
    let node = Node::open(&processes_kit::domain("lives"), "lives").unwrap();
    let mut subscriber = node.subscriber(TOPIC).unwrap();
    subscriber.set_busy_poll(LIMIT);
    let spec = StreamSpec { buffer: 64, ..StreamSpec::new(TOPIC, Kind::Image, Encoding::Mono8, 8) };
    for _life in 0..3 {
        let publisher = node.publisher(&spec).unwrap();
        while publisher.subscribers() == 0 {
            assert!(!subscriber.wait(Duration::from_millis(10)).unwrap(), "nothing was sent");
        }
        std::thread::scope(|scope| {
            let sender = scope.spawn(move || {
                for _ in 0..40 {
                    std::thread::sleep(Duration::from_millis(5));
                    let mut frame = publisher.loan(8).unwrap();
                    frame.header_mut().set_packed(8, 1);
                    frame.payload_mut().fill(1);
                    frame.send().unwrap();
                }
                publisher
            });
            for seq in 0..40 {
                assert!(subscriber.wait(PATIENCE).unwrap(), "{seq} never came");
                assert_eq!(subscriber.take().unwrap().unwrap().header().seq, seq);
            }
            let publisher = sender.join().unwrap();
            // The next frame is due and does not arrive.
            assert!(!subscriber.wait(Duration::from_millis(2)).unwrap());
            drop(publisher);
        });
        assert!(!subscriber.wait(Duration::from_millis(200)).unwrap());
        assert_eq!(subscriber.publishers(), 0);
    }
    assert_eq!(subscriber.missed_total(), 0);
}
