//! The commands that inspect streams, against a publisher in this process.

use std::{
    sync::atomic::{AtomicBool, Ordering},
    time::Duration,
};

use belvedere::cli::{echo, error::CliError, hz, list, snapshot};
use belvedere_bridge::{Domain, Encoding, Kind, Node, StreamSpec};
use clap::Parser;
use serde_json::{Value, json};

use crate::live;

#[derive(Parser)]
enum Command {
    List(list::ListArgs),
    Hz(hz::HzArgs),
    Echo(echo::EchoArgs),
    Snapshot(snapshot::SnapshotArgs),
}

fn run(line: &str) -> Result<(), CliError> {
    let words = std::iter::once("belvedere").chain(line.split_whitespace());
    match Command::try_parse_from(words).unwrap() {
        Command::List(args) => list::run(&args),
        Command::Hz(args) => hz::run(&args),
        Command::Echo(args) => echo::run(&args),
        Command::Snapshot(args) => snapshot::run(&args),
    }
}

/// Runs `body` while a grey picture is published a hundred times a second.
fn with_publisher(test: &str, body: impl FnOnce(&str)) {
    let domain = Domain::new(&format!("{test}-{}", std::process::id())).unwrap();
    let done = AtomicBool::new(false);
    let node = Node::open(&domain, test).unwrap();
    let spec = StreamSpec::new("camera/image_raw", Kind::Image, Encoding::Mono8, 64 * 48).rate_hz(100.0);
    let publisher = node.publisher(&spec).unwrap();
    let _silent = node.publisher(&StreamSpec::structs("odom", Kind::Odometry, 1)).unwrap();
    std::thread::scope(|scope| {
        scope.spawn(|| {
            while !done.load(Ordering::Relaxed) {
                let mut frame = publisher.loan(64 * 48).unwrap();
                frame.header_mut().set_packed(64, 48);
                frame.payload_mut().fill(200);
                frame.send().unwrap();
                std::thread::sleep(Duration::from_millis(10));
            }
        });
        // If `body` fails, the publisher must still be stopped.
        let outcome = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| body(domain.as_str())));
        done.store(true, Ordering::Relaxed);
        if let Err(panic) = outcome {
            std::panic::resume_unwind(panic);
        }
    });
}

/// The program's output, each line as its words.
fn words(command: &str, domain: &str) -> Vec<Vec<String>> {
    let arguments: Vec<&str> = command.split_whitespace().chain(["--domain", domain]).collect();
    let output = live::output(&arguments);
    assert!(output.status.success(), "{command}: {}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    text.lines().map(|line| line.split_whitespace().map(str::to_owned).collect()).collect()
}

/// The program's output, each line as a JSON object.
fn objects(command: &str, domain: &str) -> Vec<Value> {
    let lines = words(&format!("{command} --json"), domain);
    lines.iter().map(|words| serde_json::from_str(&words.join(" ")).unwrap()).collect()
}

#[test]
fn streams_are_listed() {
    with_publisher("list", |domain| {
        let table = words("list", domain);
        assert_eq!(table.len(), 3, "{table:?}");
        assert_eq!(table[0].join(" "), "TOPIC KIND ENCODING RATE BYTES PUBS SUBS FRAME");
        assert_eq!(table[1].join(" "), "/camera/image_raw image mono8 100 Hz 3072 1 0 -");
        assert_eq!(table[2][..4].join(" "), "/odom odometry struct -");
        let twice = objects("list --count 2", domain);
        assert!(twice.len() == 4 && twice[..2] == twice[2..], "{twice:?}");
        assert_eq!(
            twice[0],
            json!({
                "topic": "/camera/image_raw", "kind": "image", "encoding": "mono8", "rate_hz": 100.0, "frame_id": "",
                "layers": null, "publishers": 1, "subscribers": 0, "max_payload_bytes": 64 * 48,
            })
        );
        assert_eq!((&twice[1]["topic"], &twice[1]["rate_hz"]), (&json!("/odom"), &Value::Null));
    });
}

#[test]
fn a_stream_is_measured() {
    with_publisher("hz", |domain| {
        let [measured] = &objects("hz /camera/image_raw --count 50", domain)[..] else { panic!("one line") };
        assert_eq!(measured["topic"], "/camera/image_raw");
        // A frame that was sent before `hz` subscribed is counted but not measured.
        assert!((49..=50).contains(&measured["frames"].as_u64().unwrap()), "{measured}");
        // Frames are 10 ms apart, or more if the machine is busy.
        let number = |name: &str| measured[name].as_f64().unwrap();
        // The first frame may have waited in the buffer.
        assert!((0.0..120.0).contains(&number("rate_hz")) && number("rate_hz") > 0.0, "{measured}");
        assert!(0.0 < number("latency_us_p50") && number("latency_us_p50") <= number("latency_us_p99"));
        assert!(number("jitter_ms") >= 0.0 && number("gaps") >= 0.0, "{measured}");
        let table = words("hz camera/image_raw --count 5", domain);
        let whole = table.last().unwrap().join(" ");
        assert!(whole.starts_with("/camera/image_raw: rate "), "{whole}");
        assert!(whole.contains(" frames 5 gaps ") || whole.contains(" frames 4 gaps "), "{whole}");
    });
}

#[test]
fn messages_are_shown() {
    with_publisher("echo", |domain| {
        let lines: Vec<String> = words("echo camera/image_raw --count 2", domain)
            .into_iter()
            .map(|words| words.join(" "))
            .collect();
        assert_eq!(lines.iter().filter(|line| *line == "---").count(), 2, "{lines:?}");
        let data = format!("data: [{}... 3060 more]", "200, ".repeat(12));
        for line in ["height: 48", "width: 64", "encoding: \"mono8\"", "step: 64", &data] {
            assert_eq!(lines.iter().filter(|shown| *shown == line).count(), 2, "{line}: {lines:?}");
        }
        let [whole] = &objects("echo camera/image_raw --count 1", domain)[..] else { panic!("one line") };
        assert_eq!((&whole["height"], &whole["width"]), (&json!(48), &json!(64)));
        assert_eq!(whole["data"], json!([200].repeat(64 * 48)));
    });
}

#[test]
fn a_snapshot_is_a_picture_file() {
    with_publisher("snap", |domain| {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("out.png");
        run(&format!("snapshot /camera/image_raw {} --domain {domain}", path.display())).unwrap();
        let picture = image::open(&path).unwrap().to_rgb8();
        assert_eq!(picture.dimensions(), (64, 48));
        assert!(picture.pixels().all(|pixel| pixel.0 == [200; 3]));
    });
}

#[test]
fn missing_topics_are_named_with_suggestions() {
    let dir = tempfile::tempdir().unwrap();
    let snapshot = format!("snapshot camera/imag_raw {}", dir.path().join("never.png").display());
    with_publisher("unknown", |domain| {
        for command in ["hz camera/imag_raw", "echo /camera/imag_raw", &snapshot] {
            let error = run(&format!("{command} --domain {domain}")).unwrap_err();
            assert!(matches!(error, CliError::UnknownTopic { .. }), "{error}");
            let text = error.to_string();
            assert!(text.contains("did you mean '/camera/image_raw'?") && text.contains("/odom"), "{text}");
            assert!(!text.contains('\n'), "{text}");
        }
        let error = run(&format!("echo odom --domain {domain} --duration 0.2")).unwrap_err();
        assert!(matches!(error, CliError::NoFrame { .. }), "{error}");
    });
    assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 0);
    let domain = format!("nobody-{}", std::process::id());
    for command in ["list", "hz scan", "echo scan"] {
        let error = run(&format!("{command} --domain {domain}")).unwrap_err();
        assert!(matches!(error, CliError::NoSimulator(_)), "{error}");
    }
}

#[test]
fn failed_snapshots_leave_no_file() {
    with_publisher("unwritable", |domain| {
        let dir = tempfile::tempdir().unwrap();
        let folder = dir.path().join("folder.png");
        std::fs::create_dir(&folder).unwrap();
        for path in [folder, dir.path().join("no/dir.png"), dir.path().join("out.pdf")] {
            let error =
                run(&format!("snapshot camera/image_raw {} --domain {domain}", path.display())).unwrap_err();
            assert!(error.to_string().contains(&path.display().to_string()), "{error}");
        }
        // No frame came: the file that was begun for it is removed.
        let path = dir.path().join("odom.png");
        let error =
            run(&format!("snapshot odom {} --domain {domain} --timeout 0.2", path.display())).unwrap_err();
        assert!(matches!(error, CliError::NoFrame { .. }), "{error}");
        assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 1);
    });
}

#[test]
fn bad_options_are_refused() {
    for line in
        ["hz scan --domain a/b", "hz scan --duration -1", "echo scan --count 0", "hz", "snapshot scan"]
    {
        let words = std::iter::once("belvedere").chain(line.split_whitespace());
        assert!(Command::try_parse_from(words).is_err(), "{line}");
    }
}

#[test]
fn completions_end_quietly_if_nobody_reads_them() {
    assert_eq!(live::with_closed_output(&["completions", "bash"]), (Some(0), String::new()));
}
