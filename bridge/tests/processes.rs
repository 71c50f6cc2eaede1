//! Several processes, and the violent end of some. This test binary starts itself again as the publisher.

use std::{
    ffi::OsStr,
    path::Path,
    process::{Child, Command, Stdio},
    time::{Duration, Instant},
};

use belvedere_bridge::{Domain, Encoding, Error, Kind, Node, StreamSpec, Subscriber};

const LEN: usize = 640 * 480 * 3;
const DOMAIN: &str = "BRIDGE_TEST_DOMAIN";
const JOIN: &str = "BRIDGE_TEST_JOIN";
const PATIENCE: Duration = Duration::from_secs(20);

fn spec() -> StreamSpec {
    StreamSpec::new("camera/image_raw", Kind::Image, Encoding::Rgb8, LEN).rate_hz(100.0)
}

/// Not a test of its own: the body of the other process.
#[test]
fn publish_until_killed() {
    let Ok(domain) = std::env::var(DOMAIN) else { return };
    let node = Node::open(&Domain::new(&domain).unwrap(), "publisher").unwrap();
    let publisher = node.publisher(&spec()).unwrap();
    for value in 0..=u8::MAX {
        let mut frame = publisher.loan(LEN).unwrap();
        frame.header_mut().set_packed(640, 480);
        frame.payload_mut().fill(value);
        frame.send().unwrap();
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// Not a test of its own: another process that only joins.
#[test]
fn join_until_killed() {
    let Ok(domain) = std::env::var(JOIN) else { return };
    let _node = Node::open(&Domain::new(&domain).unwrap(), "joined").unwrap();
    std::thread::sleep(PATIENCE);
}

struct Publisher(Child);

impl Publisher {
    fn start(domain: &Domain) -> Self {
        let child = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "publish_until_killed", "--nocapture"])
            .env(DOMAIN, domain.as_str())
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        Self(child)
    }

    /// SIGKILL, and the wait that a parent owes.
    fn kill(mut self) {
        self.0.kill().unwrap();
        self.0.wait().unwrap();
    }
}

impl Drop for Publisher {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn domain(test: &str) -> Domain {
    Domain::new(&format!("{test}-{}", std::process::id())).unwrap()
}

fn next(subscriber: &mut Subscriber) -> belvedere_bridge::Frame {
    let deadline = Instant::now() + PATIENCE;
    while Instant::now() < deadline {
        if subscriber.wait(Duration::from_millis(200)).unwrap()
            && let Some(frame) = subscriber.take().unwrap()
        {
            return frame;
        }
    }
    panic!("no frame in {PATIENCE:?}");
}

/// The data segments among them.
fn pools_of(domain: &Domain) -> usize {
    files_of(domain).iter().filter(|name| Path::new(name).extension() == Some(OsStr::new("data"))).count()
}

fn files_of(domain: &Domain) -> Vec<String> {
    std::fs::read_dir("/dev/shm")
        .unwrap()
        .filter_map(|entry| entry.unwrap().file_name().into_string().ok())
        .filter(|name| name.starts_with(&domain.prefix()))
        .collect()
}

#[test]
fn a_killed_publisher_is_replaced_without_restarting_the_subscriber() {
    let domain = domain("kill");
    {
        let node = Node::open(&domain, "test").unwrap();
        let mut subscriber = node.subscriber("camera/image_raw").unwrap();
        let mut sessions = Vec::new();
        for life in 0..3 {
            let publisher = Publisher::start(&domain);
            let frame = next(&mut subscriber);
            assert_eq!(frame.restarted(), life > 0);
            let value = frame.payload()[0];
            assert!(frame.payload().iter().all(|&byte| byte == value), "a frame of one value only");
            sessions.push(frame.header().session);
            drop(frame);
            let _ = (next(&mut subscriber), next(&mut subscriber));
            publisher.kill();
            // What was sent before the kill is still to be had; then there is silence.
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
    assert_eq!(files_of(&domain), Vec::<String>::new());
}

#[test]
fn what_a_killed_process_left_goes_with_the_next_start() {
    let domain = domain("left");
    let publisher = Publisher::start(&domain);
    let deadline = Instant::now() + PATIENCE;
    while pools_of(&domain) == 0 && Instant::now() < deadline {
        std::thread::sleep(Duration::from_millis(10));
    }
    publisher.kill();
    assert_eq!(pools_of(&domain), 1, "a killed process leaves its pool");
    let node = Node::open(&domain, "next").unwrap();
    let publisher = node.publisher(&spec()).unwrap();
    assert_eq!(pools_of(&domain), 1);
    drop((publisher, node));
    assert_eq!(files_of(&domain), Vec::<String>::new());
}

#[test]
fn a_domain_in_use_by_another_process_is_refused() {
    let domain = domain("used");
    let node = Node::open(&domain, "test").unwrap();
    let _publisher = Publisher::start(&domain);
    let mut subscriber = node.subscriber("camera/image_raw").unwrap();
    let _ = next(&mut subscriber);
    let error = node.publisher(&spec()).unwrap_err();
    assert!(matches!(error, Error::DomainInUse { .. }), "{error}");
}

/// What a process killed in the middle of making a port leaves after iceoryx2's attempt to clean up: a dead node
/// without its description, and a tag in its directory.
#[test]
fn the_remnant_of_a_half_cleaned_node_goes() {
    let domain = domain("remnant");
    let child = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "join_until_killed", "--nocapture"])
        .env(JOIN, domain.as_str())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let child = Publisher(child);
    let nodes = Path::new("/tmp/iceoryx2/nodes");
    let monitors = || -> Vec<String> {
        std::fs::read_dir(nodes)
            .into_iter()
            .flatten()
            .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
            .filter(|name| name.starts_with(&domain.prefix()))
            .collect()
    };
    let deadline = Instant::now() + PATIENCE;
    while monitors().is_empty() && Instant::now() < deadline {
        std::thread::sleep(Duration::from_millis(10));
    }
    std::thread::sleep(Duration::from_millis(100));
    child.kill();
    let id = monitors()[0].strip_prefix(&domain.prefix()).unwrap().split('.').next().unwrap().to_owned();
    let own = nodes.join(&id);
    std::fs::remove_file(own.join(format!("{}node.details", domain.prefix()))).unwrap();
    std::fs::write(own.join(format!("{}1.port_tag", domain.prefix())), "").unwrap();

    drop(Node::open(&domain, "next").unwrap());
    assert_eq!(monitors(), Vec::<String>::new());
    assert!(!own.exists());
}
