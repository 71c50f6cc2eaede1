//! The commands that look at streams, against a publisher in this process.

use std::{
    sync::atomic::{AtomicBool, Ordering},
    time::Duration,
};

use belvedere::cli::{echo, error::CliError, hz, list, snapshot};
use belvedere_bridge::{Domain, Encoding, Kind, Node, StreamSpec};
use clap::Parser;

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
        // A failing body must not leave the publisher running.
        let outcome = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| body(domain.as_str())));
        done.store(true, Ordering::Relaxed);
        if let Err(panic) = outcome {
            std::panic::resume_unwind(panic);
        }
    });
}

#[test]
fn streams_are_listed_measured_and_shown() {
    with_publisher("show", |domain| {
        run(&format!("list --domain {domain}")).unwrap();
        run(&format!("list --domain {domain} --json --count 2")).unwrap();
        run(&format!("hz /camera/image_raw --domain {domain} --duration 0.5 --json")).unwrap();
        run(&format!("hz camera/image_raw --domain {domain} --count 5")).unwrap();
        run(&format!("echo camera/image_raw --domain {domain} --count 2")).unwrap();
        run(&format!("echo camera/image_raw --domain {domain} --count 1 --json")).unwrap();
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
fn what_is_not_there_is_named() {
    let dir = tempfile::tempdir().unwrap();
    let snapshot = format!("snapshot camera/imag_raw {}", dir.path().join("never.png").display());
    with_publisher("unknown", |domain| {
        for command in ["hz camera/imag_raw", "echo /camera/imag_raw", &snapshot] {
            let error = run(&format!("{command} --domain {domain}")).unwrap_err();
            assert!(matches!(error, CliError::UnknownTopic { .. }), "{error}");
            let text = error.to_string();
            assert!(text.contains("did you mean /camera/image_raw?") && text.contains("/odom"), "{text}");
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
fn what_cannot_be_written_leaves_nothing() {
    with_publisher("unwritable", |domain| {
        let dir = tempfile::tempdir().unwrap();
        let folder = dir.path().join("folder.png");
        std::fs::create_dir(&folder).unwrap();
        for path in [folder, dir.path().join("no/dir.png"), dir.path().join("out.pdf")] {
            let error =
                run(&format!("snapshot camera/image_raw {} --domain {domain}", path.display())).unwrap_err();
            assert!(error.to_string().contains(&path.display().to_string()), "{error}");
        }
        // Nothing came: the file that was begun for it is gone.
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
