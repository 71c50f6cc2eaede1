//! A simulation that waits for its consumers: they receive every frame, and a consumer that stops is reported.

use crate::live::{belvedere, follow, next_frame, own_domain};
use rustix::process::{Pid, Signal, kill_process};
use std::io::Read as _;
use std::process::{Child, Stdio};
use std::time::Duration;

/// Starts `belvedere run` as fast as possible, with its output captured.
fn start(domain: &str, arguments: &[&str]) -> Child {
    belvedere()
        .args(["run", "--rate", "max", "--domain", domain])
        .args(arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the simulator's binary runs")
}

/// Returns true if it succeeded, and its output.
fn end(mut child: Child) -> (bool, String) {
    let mut said = String::new();
    child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
    (child.wait().unwrap().success(), said)
}

#[test]
fn a_slow_consumer_gets_every_frame_from_the_first() {
    let domain = own_domain();
    let simulator = start(&domain, &["--duration", "2", "--wait-for", "recorder=2"]);
    let [mut images, mut infos] =
        follow(&domain, "recorder", &["image_raw", "camera_info"]).try_into().expect("two streams");
    for seq in 0..60 {
        // Slower than the simulator renders, so it has to wait.
        std::thread::sleep(Duration::from_millis(15));
        let (image, info) = (next_frame(&mut images), next_frame(&mut infos));
        assert_eq!((image.header().seq, info.header().seq), (seq, seq));
        assert_eq!(image.header().stamp_ns, seq * 1_000_000_000 / 30);
        assert_eq!(image.header().stamp_ns, info.header().stamp_ns);
    }
    assert_eq!(images.missed_total() + infos.missed_total(), 0);
    let (success, said) = end(simulator);
    assert!(success, "{said}");
}

#[test]
fn a_consumer_that_blocks_the_simulation_is_named() {
    let domain = own_domain();
    let simulator = start(&domain, &["--wait-for", "mapper", "--patience", "3"]);
    let _never_taken = follow(&domain, "mapper", &["image_raw"]);
    let (success, said) = end(simulator);
    assert!(!success);
    for words in ["\"mapper\"", &format!("process {}", std::process::id()), "image_raw", "3 s", "--patience"]
    {
        assert!(said.contains(words), "no {words} in: {said}");
    }
}

/// The consumer has no room for another frame, so the simulator waits for it when the signal arrives.
#[test]
fn a_signal_ends_a_simulation_that_waits_for_a_consumer() {
    let domain = own_domain();
    let simulator = start(&domain, &["--wait-for", "mapper", "--patience", "600"]);
    let mut poses = follow(&domain, "other", &["odom"]);
    let mut images = follow(&domain, "mapper", &["image_raw"]);
    next_frame(&mut images[0]);
    next_frame(&mut poses[0]);
    // The simulator waits once no frame of another stream arrives either.
    while poses[0].wait(Duration::from_secs(1)).unwrap() {
        while poses[0].take().unwrap().is_some() {}
    }
    kill_process(Pid::from_child(&simulator), Signal::INT).unwrap();
    let (success, said) = end(simulator);
    assert!(success, "{said}");
}

#[test]
fn a_consumer_that_left_is_waited_for_and_then_named() {
    let domain = own_domain();
    let simulator = start(&domain, &["--wait-for", "mapper", "--patience", "3"]);
    let mut images = follow(&domain, "mapper", &["image_raw"]);
    next_frame(&mut images[0]);
    drop(images);
    // It returns in time once.
    let mut images = follow(&domain, "mapper", &["image_raw"]);
    let seq = next_frame(&mut images[0]).header().seq;
    next_frame(&mut images[0]);
    assert!(seq < 20, "the simulation did not wait while the consumer was gone: frame {seq}");
    drop(images);
    let (success, said) = end(simulator);
    assert!(!success);
    assert!(said.contains("\"mapper\" left and did not come back within 3.0 s"), "{said}");
}

#[test]
fn a_consumer_that_never_came_is_named() {
    let simulator = start(&own_domain(), &["--wait-for", "mapper=2", "--patience", "0.2"]);
    let (success, said) = end(simulator);
    assert!(!success);
    assert!(said.contains("error: \"mapper\" (0 of 2 streams) did not come within 0.2 s"), "{said}");
}
