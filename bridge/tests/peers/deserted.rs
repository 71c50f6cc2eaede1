//! A stream whose description was left behind by a process that was killed while it removed the stream.
//!
//! The last process to leave a stream marks it as removed, and then removes its files. No process can open the stream
//! in between, or create it again. The interval is too short to be hit by a kill, so the test keeps links to the files
//! while a node leaves its stream, and puts them back.

use std::{
    fs,
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use belvedere_bridge::{Encoding, Kind, Node, StreamSpec};

use crate::processes_kit::{PATIENCE, TestDomain};

const TOPIC: &str = "image";

/// Returns the files of the domain that describe streams: one that never changes and one that lists who has it open,
/// for the frames and for the events that wake subscribers.
fn descriptions(domain: &TestDomain) -> Vec<PathBuf> {
    let mut files = domain.files();
    files.retain(|path| path.extension().is_some_and(|kind| kind == "service" || kind == "dynamic"));
    files
}

fn kept(path: &Path) -> PathBuf {
    // Another name than the files of a domain have, in the same file system.
    path.with_file_name(format!("kept-{}", path.file_name().unwrap().to_str().unwrap()))
}

/// Leaves the stream with the files `which` as they are after the stream was marked, and opens its publisher again.
fn publishes_again_after(test: &str, which: impl Fn(&[PathBuf]) -> Vec<PathBuf>) {
    let mut domain = TestDomain::new(test);
    let node = Node::open(&domain, "publisher").unwrap();
    let spec = StreamSpec::new(TOPIC, Kind::Image, Encoding::Mono8, 64);
    let publisher = node.publisher(&spec).unwrap();
    let files = which(&descriptions(&domain));
    assert_eq!(files.len(), 2, "{files:?}");
    for path in &files {
        fs::hard_link(path, kept(path)).unwrap();
    }
    drop(publisher);
    for path in &files {
        assert!(!path.exists(), "the last node has removed {}", path.display());
        fs::rename(kept(path), path).unwrap();
    }
    // A node that listens to the silent stream neither brings it back nor fails.
    let other = Node::open(&domain, "subscriber").unwrap();
    let mut subscriber = other.subscriber(TOPIC).unwrap();
    assert!(!subscriber.wait(Duration::from_millis(20)).unwrap());

    let publisher = node.publisher(&spec).unwrap();
    let deadline = Instant::now() + PATIENCE;
    let payload = loop {
        let mut frame = publisher.loan(64).unwrap();
        frame.header_mut().set_packed(8, 8);
        frame.payload_mut().fill(7);
        frame.send().unwrap();
        subscriber.wait(Duration::from_millis(20)).unwrap();
        if let Some(frame) = subscriber.take().unwrap() {
            break frame.payload().to_vec();
        }
        assert!(Instant::now() < deadline, "the subscriber finds the stream");
    };
    assert_eq!(payload, [7; 64]);
    drop((subscriber, other, publisher, node));
    domain.assert_nothing_left_after_the_next_start();
}

/// Returns the files of one of the two services of the stream, in the order in which they were made: frames, events.
fn of_service(files: &[PathBuf], index: usize) -> Vec<PathBuf> {
    ["service", "dynamic"]
        .iter()
        .map(|kind| {
            let mut of_kind: Vec<_> =
                files.iter().filter(|path| path.extension().is_some_and(|found| found == *kind)).collect();
            of_kind.sort_by_key(|path| fs::metadata(path).unwrap().modified().unwrap());
            assert_eq!(of_kind.len(), 2, "{files:?}");
            of_kind[index].clone()
        })
        .collect()
}

#[test]
fn a_stream_that_was_marked_as_removed_is_created_again() {
    publishes_again_after("deserted-frames", |files| of_service(files, 0));
}

#[test]
fn events_that_were_marked_as_removed_are_created_again() {
    publishes_again_after("deserted-events", |files| of_service(files, 1));
}
