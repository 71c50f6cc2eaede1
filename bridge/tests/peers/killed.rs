//! Several processes, some of which are killed.

use std::time::{Duration, Instant};

use belvedere_bridge::{Domain, Encoding, Kind, Node, StreamSpec};

use crate::processes_kit::{self, PATIENCE, Process, Role, TestDomain, next, report};

const LEN: usize = 640 * 480 * 3;

fn spec() -> StreamSpec {
    StreamSpec::new("camera/image_raw", Kind::Image, Encoding::Rgb8, LEN).rate_hz(100.0)
}

fn roles(role: &Role) {
    match role.name.as_str() {
        "publish" => publish(&role.domain),
        "join" => {
            let _node = Node::open(&role.domain, "joined").unwrap();
            report("joined");
            std::thread::sleep(PATIENCE);
        }
        name => panic!("no role {name}"),
    }
}

fn publish(domain: &Domain) {
    let node = Node::open(domain, "publisher").unwrap();
    let publisher = node.publisher(&spec()).unwrap();
    for value in 0..=u8::MAX {
        let mut frame = publisher.loan(LEN).unwrap();
        frame.header_mut().set_packed(640, 480);
        frame.payload_mut().fill(value);
        frame.send().unwrap();
        std::thread::sleep(Duration::from_millis(10));
    }
}

#[test]
fn a_killed_publisher_is_replaced_without_restarting_the_subscriber() {
    processes_kit::play(roles);
    let mut domain = TestDomain::new("kill");
    {
        let node = Node::open(&domain, "test").unwrap();
        let mut subscriber = node.subscriber("camera/image_raw").unwrap();
        let mut sessions = Vec::new();
        for life in 0..3 {
            let publisher = Process::start(&domain, "publish", &[]);
            let frame = next(&mut subscriber);
            assert_eq!(frame.restarted(), life > 0);
            let value = frame.payload()[0];
            assert!(frame.payload().iter().all(|&byte| byte == value), "a frame of one value only");
            sessions.push(frame.header().session);
            drop(frame);
            let _ = (next(&mut subscriber), next(&mut subscriber));
            publisher.kill();
            // Frames sent before the kill are still received; then there is silence.
            while subscriber.wait(Duration::from_millis(50)).unwrap() {
                subscriber.take().unwrap();
            }
        }
        sessions.sort_unstable();
        sessions.dedup();
        assert_eq!(sessions.len(), 3, "each life has a session of its own");
        let deadline = Instant::now() + PATIENCE;
        while subscriber.publishers() > 0 && Instant::now() < deadline {
            assert!(!subscriber.wait(Duration::from_millis(100)).unwrap());
        }
        assert_eq!(subscriber.publishers(), 0, "silence reveals the dead");
    }
    domain.assert_nothing_left();
}

#[test]
fn the_next_start_removes_files_of_a_killed_process() {
    processes_kit::play(roles);
    let mut domain = TestDomain::new("left");
    let publisher = Process::start(&domain, "publish", &[]);
    let deadline = Instant::now() + PATIENCE;
    while domain.pools().is_empty() && Instant::now() < deadline {
        std::thread::sleep(Duration::from_millis(10));
    }
    publisher.kill();
    assert_eq!(domain.pools().len(), 1, "a killed process leaves its pool");
    let node = Node::open(&domain, "next").unwrap();
    let publisher = node.publisher(&spec()).unwrap();
    assert_eq!(domain.pools().len(), 1);
    drop((publisher, node));
    domain.assert_nothing_left();
}

/// A process killed while it creates a port leaves, after iceoryx2's attempt to clean up, a dead node without its
/// description and with a tag in its directory.
#[test]
fn a_half_cleaned_node_is_removed() {
    processes_kit::play(roles);
    let mut domain = TestDomain::new("remnant");
    let child = Process::start(&domain, "join", &[]);
    let nodes = processes_kit::files::nodes(&domain);
    child.expect("joined");
    child.kill();
    let id = domain.node_ids().remove(0);
    let own = nodes.join(&id);
    std::fs::remove_file(own.join(format!("{}node.details", domain.prefix()))).unwrap();
    std::fs::write(own.join(format!("{}1.port_tag", domain.prefix())), "").unwrap();

    drop(Node::open(&domain, "next").unwrap());
    domain.assert_nothing_left();
    assert!(!own.exists());
}

/// A process killed while it cleans up, between removing the last file of a node and its directory, leaves an empty
/// directory.
#[test]
fn an_empty_directory_of_a_node_is_removed() {
    processes_kit::play(roles);
    let mut domain = TestDomain::new("empty");
    let child = Process::start(&domain, "join", &[]);
    child.expect("joined");
    child.kill();
    let own = processes_kit::files::nodes(&domain).join(domain.node_ids().remove(0));
    domain.usage();
    for file in domain.files() {
        std::fs::remove_file(file).unwrap();
    }
    assert!(own.exists());
    domain.assert_nothing_left_after_the_next_start();
    assert!(!own.exists());
}

/// A process that cleans up removes the tag of a port and then frees its slot in the stream. If it is killed in
/// between, the slot remains taken, and no tag refers to it.
#[test]
fn a_slot_without_an_owner_is_freed() {
    processes_kit::play(roles);
    let mut domain = TestDomain::new("place");
    let node = Node::open(&domain, "test").unwrap();
    // Keeps the stream open.
    let mut subscriber = node.subscriber("camera/image_raw").unwrap();
    let publisher = Process::start(&domain, "publish", &[]);
    drop(next(&mut subscriber));
    publisher.kill();
    let pool = domain.pools().remove(0);
    let port = pool.file_stem().unwrap().to_str().unwrap().rsplit_once('_').unwrap().1.to_owned();
    let tag =
        domain.files().into_iter().find(|path| path.ends_with(format!("{}{port}.port_tag", domain.prefix())));
    std::fs::remove_file(tag.unwrap()).unwrap();

    let successor = Process::start(&domain, "publish", &[]);
    // Frames of the first publisher are still received.
    while !next(&mut subscriber).restarted() {}
    drop((successor, subscriber, node));
    domain.assert_nothing_left_after_the_next_start();
}
