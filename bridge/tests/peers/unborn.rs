//! A process killed between creating a file in shared memory and setting its size does not block others.
//!
//! iceoryx2 waits for such a file without end if it may open it, that is as root. The interval is too short to be hit
//! by a kill, so the test creates the file, under the name that the killed process would have used.

use std::{
    fs::{self, OpenOptions},
    os::unix::fs::OpenOptionsExt as _,
    path::PathBuf,
    time::{Duration, Instant},
};

use belvedere_bridge::{Domain, Encoding, Kind, Node, StreamSpec};

use crate::processes_kit::{self, PATIENCE, Process, Role, TestDomain, report, skip};

const TOPIC: &str = "image";

fn roles(role: &Role) {
    match role.name.as_str() {
        "publish" => publish(&role.domain),
        "consume" => consume(&role.domain),
        name => panic!("no role {name}"),
    }
}

fn publish(domain: &Domain) {
    let node = Node::open(domain, "publisher").unwrap();
    let publisher = node.publisher(&StreamSpec::new(TOPIC, Kind::Image, Encoding::Mono8, 64)).unwrap();
    loop {
        let mut frame = publisher.loan(64).unwrap();
        frame.header_mut().set_packed(8, 8);
        frame.payload_mut().fill(7);
        frame.send().unwrap();
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn consume(domain: &Domain) {
    let node = Node::open(domain, "consumer").unwrap();
    let mut subscriber = node.subscriber(TOPIC).unwrap();
    loop {
        if subscriber.wait(PATIENCE).unwrap() && subscriber.take().unwrap().is_some() {
            report("frame");
        }
    }
}

/// Returns the connections of a domain.
fn connections(domain: &TestDomain) -> Vec<PathBuf> {
    let mut files = domain.files();
    files.retain(|path| path.extension().is_some_and(|kind| kind == "connection"));
    files
}

/// Creates the file as it is after the first of iceoryx2's steps.
fn make_unborn(path: &PathBuf) {
    let _ = fs::remove_file(path);
    OpenOptions::new().write(true).create_new(true).mode(0o200).open(path).unwrap();
}

#[test]
fn cleanup_after_a_killed_process_does_not_hang() {
    processes_kit::play(roles);
    let mut domain = TestDomain::new("unborn");
    let publisher = Process::start(&domain, "publish", &[]);
    let consumer = Process::start(&domain, "consume", &[]);
    consumer.expect("frame");
    let [connection] = &connections(&domain)[..] else { panic!("one connection") };
    consumer.kill();
    // Its publisher does not clean up as long as it has frames to send.
    make_unborn(connection);
    let next = Process::start(&domain, "consume", &[]);
    next.expect_within("frame", PATIENCE);
    drop((next, publisher));
    domain.assert_nothing_left_after_the_next_start();
}

#[test]
fn files_without_a_size_are_removed() {
    if !rustix::process::geteuid().is_root() {
        return skip("only root waits for such files, so only root removes them");
    }
    let mut domain = TestDomain::new("unborn-any");
    let node = Node::open(&domain, "watches").unwrap();
    let names = ["9_340282366920938463463374607431768211455.dynamic", "9.global_mgmt_2", "9.data"];
    let files = names.map(|name| PathBuf::from(format!("/dev/shm/{}{name}", domain.prefix())));
    files.iter().for_each(make_unborn);
    let deadline = Instant::now() + PATIENCE;
    while files.iter().any(|path| path.exists()) && Instant::now() < deadline {
        std::thread::sleep(Duration::from_millis(20));
    }
    assert!(files.iter().all(|path| !path.exists()), "{:?}", domain.files());
    drop(node);
    domain.assert_nothing_left_after_the_next_start();
}
