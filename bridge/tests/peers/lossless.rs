//! A publisher that waits for its consumers: only for the named ones, as long as they live, and for a limited time.

use std::time::{Duration, Instant};

use belvedere_bridge::{Domain, Encoding, Error, Kind, Lossless, Node, Publisher, StreamSpec, Subscriber};

use crate::processes_kit::{self, PATIENCE, Process, domain};

fn open(domain: &Domain, consumers: &[&str], patience: Duration) -> Publisher {
    let consumers = consumers.iter().map(ToString::to_string).collect();
    let node = Node::open(domain, "simulator").unwrap();
    let spec = StreamSpec::new("image", Kind::Image, Encoding::Mono8, 4);
    node.publisher(&StreamSpec {
        lossless: Some(Lossless { consumers, patience, ..Lossless::default() }),
        ..spec
    })
    .unwrap()
}

fn subscribe(domain: &Domain, name: &str) -> Subscriber {
    let mut subscriber = Node::open(domain, name).unwrap().subscriber("image").unwrap();
    assert!(!subscriber.wait(Duration::from_millis(1)).unwrap());
    assert_eq!(subscriber.publishers(), 1);
    subscriber
}

fn send(publisher: &Publisher, stamp_ns: u64) -> Result<usize, Error> {
    let mut frame = publisher.loan(4).unwrap();
    frame.header_mut().set_packed(2, 2);
    frame.header_mut().stamp_ns = stamp_ns;
    frame.payload_mut().fill(0);
    frame.send()
}

#[test]
fn named_consumers_lose_no_frame_and_others_do_not_slow_the_publisher() {
    const FRAMES: u64 = 200;
    let domain = domain("named");
    let publisher = open(&domain, &["recorder"], PATIENCE);
    let mut recorder = subscribe(&domain, "recorder");
    let mut viewer = subscribe(&domain, "viewer");
    let mut names: Vec<_> = publisher.consumers().into_iter().map(|consumer| consumer.name).collect();
    names.sort_unstable();
    assert_eq!(names, ["recorder", "viewer"]);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            for stamp_ns in 0..FRAMES {
                send(&publisher, stamp_ns).unwrap();
            }
        });
        for stamp_ns in 0..FRAMES {
            if stamp_ns % 16 == 0 {
                std::thread::sleep(Duration::from_millis(5));
            }
            assert!(recorder.wait(PATIENCE).unwrap());
            assert_eq!(recorder.take().unwrap().unwrap().header().stamp_ns, stamp_ns);
        }
    });
    assert_eq!(recorder.missed_total(), 0);
    // The viewer never took a frame: it has the first two, and there was no room for later ones.
    let first = viewer.take().unwrap().unwrap();
    assert_eq!((first.header().stamp_ns, first.missed()), (0, 0));
    drop(first);
    assert_eq!(viewer.take().unwrap().unwrap().header().stamp_ns, 1);
    assert!(viewer.take().unwrap().is_none());
    send(&publisher, FRAMES).unwrap();
    let next = viewer.take().unwrap().unwrap();
    assert_eq!((next.header().stamp_ns, next.missed()), (FRAMES, FRAMES - 2));
}

#[test]
fn a_consumer_that_holds_up_the_publisher_is_named() {
    let domain = domain("held");
    let publisher = open(&domain, &[], Duration::from_millis(50));
    let mut subscriber = subscribe(&domain, "sleepy \"mapper\"");
    send(&publisher, 0).unwrap();
    send(&publisher, 1).unwrap();
    let started = Instant::now();
    let error = send(&publisher, 2).unwrap_err();
    assert!(started.elapsed() >= Duration::from_millis(50));
    let Error::HeldUp { topic, consumer, .. } = &error else { panic!("{error}") };
    assert_eq!(
        (topic.as_str(), consumer.name.as_str(), consumer.pid),
        ("image", "sleepy \"mapper\"", std::process::id())
    );
    for word in ["sleepy", "image", "0.05 s", &std::process::id().to_string()] {
        assert!(error.to_string().contains(word), "{error}");
    }
    // It continues with a consumer that wakes up.
    assert_eq!(subscriber.take().unwrap().unwrap().header().stamp_ns, 0);
    send(&publisher, 3).unwrap();
    assert_eq!(subscriber.take().unwrap().unwrap().header().stamp_ns, 1);
    let after = subscriber.take().unwrap().unwrap();
    assert_eq!((after.header().stamp_ns, after.missed()), (3, 1));
}

#[test]
fn a_killed_consumer_is_not_waited_for() {
    processes_kit::play(|role| {
        let _never_taken_from = subscribe(&role.domain, "killed");
        std::thread::sleep(PATIENCE);
    });
    let domain = domain("dead");
    let publisher = open(&domain, &[], 10 * PATIENCE);
    let consumer = Process::start(&domain, "subscribe", &[]);
    let started = Instant::now();
    while publisher.subscribers() == 0 && started.elapsed() < PATIENCE {
        std::thread::sleep(Duration::from_millis(5));
    }
    assert_eq!(publisher.consumers().len(), 1);
    send(&publisher, 0).unwrap();
    send(&publisher, 1).unwrap();
    let killer = std::thread::spawn(move || {
        std::thread::sleep(Duration::from_millis(100));
        consumer.kill();
    });
    let started = Instant::now();
    send(&publisher, 2).unwrap();
    assert!(started.elapsed() < PATIENCE, "its death was noticed, not its patience used up");
    killer.join().unwrap();
    send(&publisher, 3).unwrap();
    assert_eq!(publisher.subscribers(), 0);
}
