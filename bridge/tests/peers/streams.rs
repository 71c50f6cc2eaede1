//! Publishers and subscribers within one process.

use std::time::Duration;

use belvedere_bridge::{
    Encoding, Error, Kind, Lossless, Node, StreamSpec,
    payload::{Clock, Transform, VelocityCommand},
};
use bytemuck::Zeroable as _;

use crate::processes_kit::{PATIENCE, TestDomain, domain};

const SHORT: Duration = Duration::from_millis(20);

/// Opens a node in a domain of this test.
fn node(test: &str) -> Node {
    Node::open(&domain(test), test).unwrap()
}

fn image_spec(topic: &str) -> StreamSpec {
    StreamSpec::new(topic, Kind::Image, Encoding::Mono8, 64 * 48).frame_id("camera").rate_hz(30.0)
}

fn send(publisher: &belvedere_bridge::Publisher, value: u8) {
    let mut frame = publisher.loan(64 * 48).unwrap();
    frame.header_mut().set_packed(64, 48);
    frame.header_mut().stamp_ns = u64::from(value);
    frame.payload_mut().fill(value);
    frame.send().unwrap();
}

#[test]
fn a_frame_arrives_as_it_was_written() {
    let node = node("arrive");
    let publisher = node.publisher(&image_spec("/camera/image_raw")).unwrap();
    let mut subscriber = node.subscriber("camera/image_raw").unwrap();
    assert!(!subscriber.wait(SHORT).unwrap());
    assert_eq!(publisher.subscribers(), 1);
    send(&publisher, 7);
    assert!(subscriber.wait(PATIENCE).unwrap());
    let frame = subscriber.take().unwrap().unwrap();
    let header = frame.header();
    assert_eq!((header.width, header.height, header.row_stride, header.seq), (64, 48, 64, 0));
    assert_eq!(header.frame_id.as_str(), "camera");
    assert_eq!(header.stamp_ns, 7);
    assert_eq!(frame.payload(), [7; 64 * 48]);
    assert_eq!(frame.payload().as_ptr().addr() % 64, 0);
    assert_eq!(frame.view().rows().len(), 48);
    assert!(u128::from(frame.age_ns()) < PATIENCE.as_nanos());
    assert!(!frame.is_from_history());
    assert!(subscriber.take().unwrap().is_none());
}

#[test]
fn a_slow_subscriber_loses_its_oldest_frames_and_counts_them() {
    let node = node("slow");
    let publisher = node.publisher(&image_spec("image")).unwrap();
    let mut subscriber = node.subscriber("image").unwrap();
    assert!(!subscriber.wait(SHORT).unwrap());
    for value in 0..10 {
        send(&publisher, value);
    }
    let frame = subscriber.take().unwrap().unwrap();
    // A buffer of two: 8 and 9 are left. No frame was taken before, so none counts as missed.
    assert_eq!((frame.payload()[0], frame.missed()), (8, 0));
    for value in 10..14 {
        send(&publisher, value);
    }
    let frame = subscriber.take_newest().unwrap().unwrap();
    assert_eq!((frame.payload()[0], frame.missed()), (13, 4));
    assert_eq!(subscriber.missed_total(), 4);
}

#[test]
fn a_held_frame_stays_as_it_was() {
    let node = node("held");
    let publisher = node.publisher(&image_spec("image")).unwrap();
    let mut subscriber = node.subscriber("image").unwrap();
    assert!(!subscriber.wait(SHORT).unwrap());
    send(&publisher, 1);
    let held = subscriber.take().unwrap().unwrap();
    for value in 2..200 {
        send(&publisher, value);
        let newest = subscriber.take_newest().unwrap().unwrap();
        assert_eq!(newest.payload()[0], value);
    }
    send(&publisher, 200);
    let second = subscriber.take().unwrap().unwrap();
    send(&publisher, 201);
    assert!(matches!(subscriber.take(), Err(Error::TooManyHeld { max: 2, .. })));
    drop(publisher);
    drop(node);
    drop(subscriber);
    assert_eq!(held.payload(), [1; 64 * 48]);
    assert_eq!(second.payload(), [200; 64 * 48]);
}

#[test]
fn a_held_frame_stays_as_it_was_when_its_subscriber_closes() {
    let node = node("closed");
    let publisher = node.publisher(&image_spec("image")).unwrap();
    let mut subscriber = node.subscriber("image").unwrap();
    assert!(!subscriber.wait(SHORT).unwrap());
    send(&publisher, 1);
    let held = subscriber.take().unwrap().unwrap();
    drop(subscriber);
    // More frames than the publisher's pool holds.
    for value in 2..100 {
        send(&publisher, value);
    }
    assert_eq!(held.payload(), [1; 64 * 48]);
}

#[test]
fn a_late_subscriber_gets_the_last_frame() {
    let node = node("late");
    let spec = StreamSpec::structs("tf_static", Kind::StaticTransforms, 4);
    let publisher = node.publisher(&spec).unwrap();
    let transforms = [Transform::zeroed(), Transform { translation: [1.0, 2.0, 3.0], ..Transform::zeroed() }];
    publisher.send_structs(0, &transforms).unwrap();
    let mut subscriber = node.subscriber("tf_static").unwrap();
    assert!(!subscriber.wait(SHORT).unwrap());
    publisher.update().unwrap();
    assert!(subscriber.wait(PATIENCE).unwrap());
    let frame = subscriber.take().unwrap().unwrap();
    assert!(frame.is_from_history());
    let received: Vec<Transform> = frame.view().structs().unwrap().collect();
    assert_eq!(received.len(), 2);
    assert_eq!(received[1].translation, [1.0, 2.0, 3.0]);
    assert!(frame.message::<Clock>().is_err(), "a transform is not a clock");

    // Another subscriber replaces it before the publisher checks again: the same number, but without frames.
    drop((frame, subscriber));
    let mut subscriber = node.subscriber("tf_static").unwrap();
    assert!(!subscriber.wait(SHORT).unwrap());
    publisher.update().unwrap();
    assert!(subscriber.wait(PATIENCE).unwrap());
}

#[test]
fn a_restarted_publisher_is_picked_up() {
    let node = node("restart");
    let mut subscriber = node.subscriber("image").unwrap();
    for life in 0..3_u8 {
        let publisher = node.publisher(&image_spec("image")).unwrap();
        assert!(!subscriber.wait(Duration::from_millis(60)).unwrap());
        send(&publisher, 10 * life);
        send(&publisher, 10 * life + 1);
        drop(publisher);
        for index in 0..2 {
            assert!(subscriber.wait(PATIENCE).unwrap(), "what a publisher sent last outlives it");
            let frame = subscriber.take().unwrap().unwrap();
            assert_eq!(frame.payload()[0], 10 * life + index);
            assert_eq!(frame.restarted(), life > 0 && index == 0);
            assert_eq!(frame.missed(), 0);
        }
        assert!(!subscriber.wait(SHORT).unwrap());
        assert_eq!(subscriber.publishers(), 0);
        // No process holds the stream of the dead publisher.
        assert_eq!(node.streams().unwrap(), []);
    }
}

#[test]
fn commands_come_from_many() {
    let node = node("commands");
    let spec = StreamSpec::velocity_command("/cmd_vel");
    let early = node.publisher(&spec).unwrap();
    let mut commands = node.command_subscriber(&spec).unwrap();
    let late = node.publisher(&spec).unwrap();
    let forward = |speed| VelocityCommand { linear: [speed, 0.0, 0.0], angular: [0.0; 3] };
    late.send_structs(0, &[forward(1.0)]).unwrap();
    early.send_structs(0, &[forward(2.0)]).unwrap();
    let newest: VelocityCommand = commands.take_newest().unwrap().unwrap().message().unwrap();
    assert_eq!(newest, forward(2.0), "the last command counts, whichever process sent it");
    drop((early, late));
    assert!(!commands.wait(SHORT).unwrap());
    let again = node.publisher(&spec).unwrap();
    again.send_structs(0, &[forward(3.0)]).unwrap();
    assert!(commands.wait(PATIENCE).unwrap());
}

#[test]
fn streams_are_described() {
    let node = node("describe");
    let _image = node.publisher(&image_spec("b/image")).unwrap();
    let _clock = node.publisher(&StreamSpec::structs("clock", Kind::Clock, 1)).unwrap();
    let mut subscriber = node.subscriber("b/image").unwrap();
    assert!(!subscriber.wait(SHORT).unwrap());
    let streams = node.streams().unwrap();
    assert_eq!(streams.iter().map(|stream| stream.topic.as_str()).collect::<Vec<_>>(), ["b/image", "clock"]);
    let image = &streams[0];
    assert_eq!((image.kind, image.encoding), (Some(Kind::Image), Some(Encoding::Mono8)));
    assert_eq!((image.rate_hz, image.frame_id.as_str()), (Some(30.0), "camera"));
    assert_eq!((image.publishers, image.subscribers, image.max_payload_len), (1, 1, 64 * 48));
    assert_eq!(streams[1].rate_hz, None);
    assert_eq!(node.stream("/b/image").unwrap().as_ref(), Some(image));
    assert_eq!(node.stream("b").unwrap(), None);
    assert!(matches!(node.stream("b c"), Err(Error::InvalidTopic { .. })));
}

#[test]
fn limits_are_errors_with_names() {
    let node = node("limits");
    let publisher = node.publisher(&image_spec("image")).unwrap();
    assert!(matches!(publisher.loan(64 * 48 + 1), Err(Error::FrameTooLarge { .. })));
    let _two = (publisher.loan(1).unwrap(), publisher.loan(1).unwrap());
    assert!(matches!(publisher.loan(1), Err(Error::NoFreeFrame { max: 2, .. })));
    let huge = StreamSpec::new("huge", Kind::PointCloud, Encoding::XyzRgbF32, 1 << 45);
    let error = node.publisher(&huge).unwrap_err();
    assert!(matches!(error, Error::SharedMemoryTooSmall { .. }), "{error}");
    let mut subscribers: Vec<_> = (0..9).map(|_| node.subscriber("image").unwrap()).collect();
    let waits: Vec<_> = subscribers.iter_mut().map(|subscriber| subscriber.wait(Duration::ZERO)).collect();
    assert!(waits[..8].iter().all(|wait| matches!(wait, Ok(false))), "{waits:?}");
    assert!(matches!(waits[8], Err(Error::TooManySubscribers { max: 8, .. })), "{waits:?}");
    assert!(node.publisher(&image_spec("a//b")).is_err());
}

#[test]
fn a_lossless_stream_waits() {
    let node = node("lossless");
    let spec = StreamSpec { lossless: Some(Lossless::default()), ..image_spec("image") };
    let publisher = node.publisher(&spec).unwrap();
    let mut subscriber = node.subscriber("image").unwrap();
    assert!(!subscriber.wait(SHORT).unwrap());
    std::thread::scope(|scope| {
        scope.spawn(|| (0..50).for_each(|value| send(&publisher, value)));
        for value in 0..50 {
            std::thread::sleep(Duration::from_millis(1));
            assert!(subscriber.wait(PATIENCE).unwrap());
            assert_eq!(subscriber.take().unwrap().unwrap().payload()[0], value);
        }
    });
    assert_eq!(subscriber.missed_total(), 0);
}

#[test]
fn nothing_is_left() {
    let mut domain = TestDomain::new("clean");
    {
        let node = Node::open(&domain, "clean").unwrap();
        let publisher = node.publisher(&image_spec("image")).unwrap();
        let mut subscriber = node.subscriber("image").unwrap();
        assert!(!subscriber.wait(SHORT).unwrap());
        send(&publisher, 1);
        assert!(subscriber.take().unwrap().is_some());
        assert!(domain.usage().files > 0, "the test looks in the right place");
    }
    domain.assert_nothing_left();
}

#[test]
fn everything_may_move_to_another_thread() {
    let node = node("threads");
    let publisher = node.publisher(&image_spec("image")).unwrap();
    let mut subscriber = node.subscriber("image").unwrap();
    assert!(!subscriber.wait(SHORT).unwrap());
    let loaned = publisher.loan(64 * 48).unwrap();
    let sending = std::thread::spawn(move || {
        let mut frame = loaned;
        frame.header_mut().set_packed(64, 48);
        frame.payload_mut().fill(1);
        frame.send().unwrap();
        send(&publisher, 2);
        (node, publisher)
    });
    let taking = std::thread::spawn(move || {
        assert!(subscriber.wait(PATIENCE).unwrap());
        (subscriber.take().unwrap().unwrap(), subscriber)
    });
    let (node, publisher) = sending.join().unwrap();
    let (frame, mut subscriber) = taking.join().unwrap();
    assert_eq!((frame.payload()[0], publisher.subscribers(), node.streams().unwrap().len()), (1, 1, 1));
    assert_eq!(subscriber.take().unwrap().unwrap().payload()[0], 2);
}
