//! Streams without subscribers are not rendered, and a stream does not depend on which others have subscribers.

use crate::live::{Simulator, next_frame};
use std::time::Duration;

const KINECT: [&str; 6] = ["--robot", "kobuki_hexagons_kinect", "--world", "playground", "--seed", "7"];
const RGB: &str = "camera/rgb/image_raw";
const DEPTH: &str = "camera/depth/image_raw";
const POINTS: &str = "camera/depth/points";

/// The number of frames sent so far, as counted by the simulator.
fn sent(simulator: &Simulator, topic: &str) -> u64 {
    next_frame(&mut simulator.subscribe(topic)).header().seq
}

#[test]
fn a_stream_is_rendered_only_while_it_has_subscribers() {
    let simulator = Simulator::start(&KINECT);
    let mut clock = simulator.subscribe("clock");
    // A second of simulated time without a subscriber.
    while next_frame(&mut clock).header().stamp_ns < 1_000_000_000 {}
    let mut depth = simulator.subscribe(DEPTH);
    let first = next_frame(&mut depth);
    assert_eq!(first.header().seq, 0, "none was made before");
    assert!(first.header().stamp_ns >= 1_000_000_000 && !first.is_from_history());
    drop(first);
    for _ in 0..5 {
        next_frame(&mut depth);
    }
    // The other streams of the same sensor have no subscriber.
    assert_eq!(sent(&simulator, POINTS), 0);
    // Messages that accompany it are sent all the time.
    assert!(sent(&simulator, "camera/depth/camera_info") > 5);
}

/// Timestamps and payloads of the first frames of a simulation with other subscribed streams.
fn frames(others: &[&str]) -> Vec<(u64, Vec<u8>)> {
    let streams = format!("test={}", 1 + others.len());
    let simulator = Simulator::start(&[&KINECT[..], &["--rate", "max", "--wait-for", &streams]].concat());
    let node = simulator.node();
    let mut others: Vec<_> = others.iter().map(|topic| node.subscriber(topic).unwrap()).collect();
    let mut depth = node.subscriber(DEPTH).unwrap();
    (0..5)
        .map(|_| {
            // Each stream must be taken, or the simulation waits.
            while !depth.wait(Duration::from_millis(5)).unwrap() {
                for other in &mut others {
                    other.take().unwrap();
                }
            }
            let frame = depth.take().unwrap().unwrap();
            (frame.header().stamp_ns, frame.payload().to_vec())
        })
        .collect()
}

#[test]
fn frames_do_not_depend_on_other_subscribers() {
    let (alone, beside) = (frames(&[]), frames(&[RGB, POINTS]));
    assert_eq!(alone[0].0, 0);
    assert!(alone == beside, "other bytes, at {:?}", alone.iter().map(|frame| frame.0).collect::<Vec<_>>());
}

#[test]
fn a_late_consumer_gets_latched_messages_at_once() {
    let simulator = Simulator::start(&KINECT);
    let mut clock = simulator.subscribe("clock");
    while next_frame(&mut clock).header().stamp_ns < 300_000_000 {}
    for topic in ["tf_static", "camera/rgb/camera_info", "camera/depth/camera_info"] {
        let mut late = simulator.subscribe(topic);
        let asked_ns = next_frame(&mut clock).header().stamp_ns;
        next_frame(&mut late);
        let given_ns = next_frame(&mut clock).header().stamp_ns;
        // The state is sent every 20 ms, the pictures every 33.
        assert!(given_ns - asked_ns < 500_000_000, "{topic} after {} ms", (given_ns - asked_ns) / 1_000_000);
    }
}
