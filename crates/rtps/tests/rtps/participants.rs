//! Writers and readers of this crate, in participants of their own.

use std::sync::{LazyLock, mpsc};
use std::time::{Duration, Instant};

use belvedere_rtps::{
    JoinError, Node, Participant, Qos, Range, Reader, Requests, ServiceType, Topic, Writer,
};

/// Whatever must happen happens within this time.
const LONG: Duration = Duration::from_secs(60);

/// A domain of this process and test, so that neither other tests nor robots disturb it.
pub(crate) fn domain(test: u32) -> u32 {
    // The ports of domains above 101 may be those of any program's socket.
    20 + (std::process::id() * 8 + test) % 80
}

/// A topic of this process.
pub(crate) fn topic() -> Topic<'static> {
    static NAME: LazyLock<String> = LazyLock::new(|| format!("/test_{}/words", std::process::id()));
    Topic { name: &NAME, message: "std_msgs/msg/String", hash: "" }
}

pub(crate) fn join(domain: u32, name: &str) -> Participant {
    let node = Node { domain, range: Range::Localhost, peers: &[], namespace: "/", name };
    Participant::join(&node).expect("a participant")
}

/// A sample that is made of a number: CDR's header, and `length` bytes.
fn sample(number: u8, length: usize) -> Vec<u8> {
    let mut sample = vec![0, 1, 0, 0];
    sample.resize(4 + length, number);
    sample
}

fn until(what: &str, done: impl Fn() -> bool) {
    let start = Instant::now();
    while !done() {
        assert!(start.elapsed() < LONG, "{what}");
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// A writer and a reader of two participants, that have found each other.
fn matched(domain: u32, qos: Qos) -> (Participant, Writer, Participant, Reader) {
    let (ours, theirs) = (join(domain, "writer"), join(domain, "reader"));
    let writer = ours.writer(topic(), qos).expect("a writer");
    let reader = theirs.reader(topic(), qos, 8 << 20).expect("a reader");
    until("both ends find each other", || writer.matched() == 1 && reader.matched() == 1);
    (ours, writer, theirs, reader)
}

#[test]
fn reliable_samples_of_all_sizes_arrive_in_order() {
    let (_ours, writer, _theirs, reader) = matched(domain(0), Qos::volatile(100));
    let lengths = [1, 3, 4, 63_996, 63_997, 64_000, 200_001, 4_915_200, 0];
    for (number, length) in lengths.into_iter().enumerate() {
        writer.write(sample(number as u8, length));
    }
    for (number, length) in lengths.into_iter().enumerate() {
        let came = reader.take(LONG).expect("a sample");
        let padding = usize::from(came[3]);
        assert_eq!(padding, length.next_multiple_of(4) - length);
        assert_eq!(came.len(), 4 + length + padding);
        assert!(came[4..4 + length].iter().all(|&byte| byte == number as u8), "sample {number}");
    }
    assert_eq!(reader.take(Duration::ZERO), None);
}

#[test]
fn those_that_join_late_get_what_is_latched() {
    let domain = domain(1);
    let ours = join(domain, "writer");
    let writer = ours.writer(topic(), Qos::latched()).expect("a writer");
    writer.write(sample(1, 10));
    writer.write(sample(2, 300_000));
    let theirs = join(domain, "reader");
    let reader = theirs.reader(topic(), Qos::latched(), 1 << 20).expect("a reader");
    assert_eq!(reader.take(LONG), Some(sample(2, 300_000)));
    // Who does not ask for it gets only what is written from now on.
    let volatile = theirs.reader(topic(), Qos::volatile(5), 1 << 20).expect("a reader");
    until("the second reader is found", || writer.matched() == 2 && volatile.matched() == 1);
    writer.write(sample(3, 12));
    assert_eq!(volatile.take(LONG), Some(sample(3, 12)));
    assert_eq!(reader.take(LONG), Some(sample(3, 12)));
}

#[test]
fn a_writer_may_outlive_its_participant() {
    let (ours, writer, _theirs, reader) = matched(domain(6), Qos::volatile(5));
    drop(ours);
    until("the reader is told that the writer is gone", || reader.matched() == 0);
    for number in 0..100 {
        writer.write(sample(number, 10));
    }
    assert_eq!(reader.take(Duration::ZERO), None);
}

#[test]
fn a_writer_learns_how_many_read() {
    let domain = domain(2);
    let ours = join(domain, "writer");
    let (tell, told) = mpsc::channel();
    let _writer = ours
        .watched_writer(topic(), Qos::best_effort(5), move |count| {
            tell.send(count).expect("the test listens");
        })
        .expect("a writer");
    let theirs = join(domain, "reader");
    let first = theirs.reader(topic(), Qos::best_effort(5), 100).expect("a reader");
    assert_eq!(told.recv_timeout(LONG), Ok(1));
    let third = join(domain, "another");
    let _second = third.reader(topic(), Qos::best_effort(5), 100).expect("a reader");
    assert_eq!(told.recv_timeout(LONG), Ok(2));
    drop(first);
    assert_eq!(told.recv_timeout(LONG), Ok(1));
    drop(third);
    assert_eq!(told.recv_timeout(LONG), Ok(0));
}

#[test]
fn what_does_not_fit_is_not_matched() {
    let domain = domain(3);
    let (ours, theirs) = (join(domain, "writer"), join(domain, "reader"));
    let writer = ours.writer(topic(), Qos::best_effort(5)).expect("a writer");
    let reliable = theirs.reader(topic(), Qos::volatile(5), 100).expect("a reader");
    let other = Topic { message: "std_msgs/msg/Bool", ..topic() };
    let other = theirs.reader(other, Qos::best_effort(5), 100).expect("a reader");
    let fits = theirs.reader(topic(), Qos::best_effort(5), 100).expect("a reader");
    until("the third reader is found", || fits.matched() == 1 && writer.matched() == 1);
    assert_eq!((reliable.matched(), other.matched()), (0, 0));
}

#[test]
fn names_that_cannot_be_are_refused() {
    let ours = join(domain(4), "writer");
    let refused = |topic| ours.writer(topic, Qos::volatile(1)).expect_err("it is none").to_string();
    assert_eq!(
        refused(Topic { message: "String", ..topic() }),
        "\"String\" is not the type of a message; a type is written as sensor_msgs/msg/Image"
    );
    let long = "/x".repeat(200);
    for name in ["", "/", "scan", "/a//b", "/a b", "/1st", "/é", &long] {
        let said = refused(Topic { name, ..topic() });
        assert!(said.starts_with(&format!("\"{name}\" is not the name of a topic or service; ")), "{said}");
    }
    let service = ServiceType { name: "/trigger", service: "Trigger", hash: "" };
    let refused_service = ours.service(&Requests::new(), service, 100).expect_err("it is none").to_string();
    assert_eq!(
        refused_service,
        "\"Trigger\" is not the type of a service; a type is written as rcl_interfaces/srv/GetParameters"
    );
    let said = refused(Topic { hash: "RIHS01_12", ..topic() });
    assert_eq!(
        said,
        "\"RIHS01_12\" is not the hash of a type; it is RIHS01_ and 64 hexadecimal digits, or empty"
    );
    let join = |namespace, name| {
        let node = Node { domain: domain(4), range: Range::Localhost, peers: &[], namespace, name };
        Participant::join(&node).expect_err("it is none").to_string()
    };
    let end = "with letters, digits and _, at most 255";
    assert_eq!(join("/", "a/b"), format!("\"a/b\" is not the name of a node; write belvedere, {end}"));
    assert_eq!(join("a", "b"), format!("\"a\" is not the namespace of a node; write / or /robot1, {end}"));
    let far = Node { domain: 233, range: Range::Localhost, peers: &[], namespace: "/", name: "far" };
    assert!(matches!(Participant::join(&far), Err(JoinError::Domain(233))));
}
