//! Errors for limits that a domain has reached.

use std::{
    fs::File,
    process::Command,
    time::{Duration, Instant},
};

use belvedere_bridge::{
    Domain, Encoding, Error, FrameHeader, Kind, Lossless, Node, StreamSpec, open_files,
    payload::VelocityCommand,
};

use crate::processes_kit::{domain, plain, this_test};

const OUT_OF_FILES: &str = "BRIDGE_OUT_OF_FILES";

fn image(topic: &str) -> StreamSpec {
    StreamSpec::new(topic, Kind::Image, Encoding::Mono8, 64)
}

/// Opens a stream like a process that takes no subscriber slot: a node of plain iceoryx2.
fn holder(domain: &Domain, topic: &str) -> impl Sized + use<> {
    let (node, name) = (plain::node(domain), plain::service(topic));
    let builder = || node.service_builder(&name);
    let frames = builder().publish_subscribe::<[u8]>().user_header::<FrameHeader>().open().unwrap();
    let events = builder().event().open().unwrap();
    (frames, events, node)
}

#[test]
fn the_41st_process_of_a_stream_is_refused() {
    let domain = domain("forty");
    let node = Node::open(&domain, "simulator").unwrap();
    let publisher = node.publisher(&image("image")).unwrap();
    let mut holders: Vec<_> = (0..38).map(|_| holder(&domain, "image")).collect();
    // The last slot.
    let viewer = Node::open(&domain, "viewer").unwrap();
    assert_eq!(viewer.streams().unwrap().len(), 1);
    let mut images = viewer.subscriber("image").unwrap();
    assert!(!images.wait(Duration::ZERO).unwrap());
    assert_eq!(images.publishers(), 1);
    drop(images);

    holders.push(holder(&domain, "image"));
    let refused = [
        viewer.subscriber("image").unwrap().wait(Duration::ZERO).unwrap_err(),
        viewer.streams().unwrap_err(),
        viewer.publisher(&image("image")).unwrap_err(),
    ];
    for error in refused {
        assert!(matches!(&error, Error::TooManyProcesses { max: 40, .. }), "{error}");
        assert!(error.to_string().contains("image is open in 40 processes"), "{error}");
    }
    holders.pop();
    assert_eq!(viewer.streams().unwrap().len(), 1);
    drop((holders, publisher));
}

#[test]
fn the_ninth_sender_of_commands_is_refused() {
    let node = Node::open(&domain("ninth"), "driver").unwrap();
    let spec = StreamSpec::velocity_command("cmd_vel");
    let mut commands = node.command_subscriber(&spec).unwrap();
    let mut senders: Vec<_> = (0..8).map(|_| node.publisher(&spec).unwrap()).collect();
    let error = node.publisher(&spec).unwrap_err();
    assert!(matches!(&error, Error::TooManyPublishers { max: 8, .. }), "{error}");
    let words = error.to_string();
    assert!(
        words.contains("cmd_vel") && words.contains("close one") && words.contains("\"driver\""),
        "{words}"
    );
    senders.pop();
    let sender = node.publisher(&spec).unwrap();
    sender.send_structs(0, &[VelocityCommand::default()]).unwrap();
    assert!(commands.take().unwrap().is_some());
}

/// A consumer that takes no frames does not notice that a publisher has ended.
#[test]
fn a_consumer_that_keeps_a_stream_open_with_other_settings_is_named() {
    let domain = domain("kept");
    let slow = Node::open(&domain, "slow").unwrap();
    let mut images = slow.subscriber("image").unwrap();
    let lossless = StreamSpec { lossless: Some(Lossless::default()), ..image("image") };
    let deep = StreamSpec { buffer: 7, ..image("image") };
    for (first, second, difference) in [
        (&lossless, &image("image"), "created to wait for slow consumers (--wait-for, --record)"),
        (&image("image"), &lossless, "created to drop frames of slow consumers"),
        (&image("image"), &deep, "created with 2 buffered frames, but 7 are requested"),
    ] {
        let simulator = Node::open(&domain, "simulator").unwrap();
        let publisher = simulator.publisher(first).unwrap();
        // A subscriber searches for a missing stream every 20 ms, however often it is called.
        let deadline = Instant::now() + Duration::from_secs(10);
        while images.publishers() == 0 && Instant::now() < deadline {
            assert!(!images.wait(Duration::from_millis(5)).unwrap());
        }
        assert_eq!(images.publishers(), 1);
        // While the stream is published, that is the reason.
        let error = Node::open(&domain, "second").unwrap().publisher(second).unwrap_err();
        assert!(matches!(&error, Error::DomainInUse { .. }), "{error}");
        drop(publisher);
        let error = simulator.publisher(second).unwrap_err();
        assert!(matches!(&error, Error::KeptOpen { .. }), "{error}");
        let (words, pid) = (error.to_string(), format!("\"slow\" (process {})", std::process::id()));
        for part in [difference, pid.as_str(), "end that process", domain.as_str()] {
            assert!(words.contains(part), "\"{part}\" is not in: {words}");
        }
        assert!(!words.contains("version"), "{words}");
        // It checks for a frame, and thereby closes the stream.
        assert!(!images.wait(Duration::ZERO).unwrap());
        drop(simulator.publisher(second).unwrap());
        assert!(!images.wait(Duration::ZERO).unwrap());
    }
}

/// Runs this test in a process with these shell limits.
fn run_limited(limits: &str) -> String {
    // Without the files of tests that run at the same time in this process, which the shell inherits.
    let close = "for fd in /proc/$$/fd/*; do fd=${fd##*/}; [ $fd -gt 2 ] && eval \"exec $fd>&-\"; done";
    let run = format!("exec \"$0\" --exact {} --nocapture --test-threads 1", this_test());
    let output = Command::new("bash")
        .args(["-c", &format!("{close}; {limits} && {run}")])
        .arg(std::env::current_exe().unwrap())
        .env(OUT_OF_FILES, "1")
        .output()
        .unwrap();
    let text =
        String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{limits}: {text}");
    text
}

#[test]
fn a_limit_of_open_files_is_named_with_its_remedy() {
    if std::env::var_os(OUT_OF_FILES).is_some() {
        return out_of_files();
    }
    let hard = run_limited("ulimit -n 64");
    assert!(hard.contains("the 64 of its limit") && hard.contains("--ulimit nofile="), "{hard}");
    let soft = run_limited("ulimit -Sn 64");
    assert!(soft.contains("the 64 of its limit") && soft.contains("ulimit -n "), "{soft}");
    assert!(!soft.contains("nofile="), "{soft}");
}

/// Opens files until the limit is reached.
fn take_all_files() -> Vec<File> {
    std::iter::from_fn(|| File::open("/dev/null").ok()).collect()
}

fn out_of_files() {
    let domain = domain("files");
    let told = |what: &str, error: Error| {
        assert!(matches!(error, Error::TooManyOpenFiles { .. }), "{what}: {error:?}");
        println!("{error}");
    };
    // With none left, and with so few that the limit is reached within each step.
    for left in 0..10 {
        let mut files = take_all_files();
        files.truncate(files.len() - left);
        told("a node", Node::open(&domain, "test").unwrap_err());
        drop(files);

        let node = Node::open(&domain, "test").unwrap();
        let publisher = node.publisher(&image("first")).unwrap();
        let mut files = take_all_files();
        files.truncate(files.len() - left);
        told("a publisher", node.publisher(&image("second")).unwrap_err());
        told("a subscriber", node.subscriber("first").unwrap().wait(Duration::ZERO).unwrap_err());
        told("a receiver", node.command_subscriber(&StreamSpec::velocity_command("cmd_vel")).unwrap_err());
        drop(files);
        // Existing streams continue, and refused ones can be opened.
        let mut subscriber = node.subscriber("first").unwrap();
        assert!(!subscriber.wait(Duration::ZERO).unwrap());
        let mut frame = publisher.loan(64).unwrap();
        frame.header_mut().set_packed(8, 8);
        assert_eq!(frame.send().unwrap(), 1);
        assert!(subscriber.take().unwrap().is_some());
        node.publisher(&image("second")).unwrap();
    }
    let raised = open_files::raise_limit().unwrap().unwrap();
    assert!(raised >= 64, "{raised}");
}
