//! `belvedere view run.mcap`: a recording on the page, with its time line.
#![cfg(feature = "view")]

use crate::live::{PATIENCE, belvedere, own_domain};
use crate::page::{Page, Server, position};
use serde_json::{Value, json};
use std::path::Path;
use std::time::{Duration, Instant};

const STATES: &str = "simulation/link_states";
const PICTURE: &str = "camera/rgb/image_raw";
const ROBOT: &str = "turtlebot::";

/// Records four seconds of a robot that drives in circles.
fn record(file: &Path) {
    let run = ["run", "--robot", "kobuki_hexagons_kinect", "--world", "playground", "--drive", "loop"];
    let mut command = belvedere();
    command
        .args(run)
        .args(["--domain", &own_domain(), "--rate", "max", "--duration", "4", "--record"])
        .arg(file);
    assert!(command.output().unwrap().status.success());
}

/// Waits until the state of the time line fulfils a condition, and returns it.
fn timeline(page: &mut Page, holds: impl Fn(&Value) -> bool) -> Value {
    let deadline = Instant::now() + PATIENCE;
    loop {
        let state = page.next_json("timeline");
        if holds(&state) {
            return state;
        }
        assert!(Instant::now() < deadline, "{state}");
    }
}

fn seek(page: &mut Page, seconds: f64) {
    page.say(&json!({ "op": "seek", "position": seconds }));
}

/// The position of the robot and the picture at a time of a paused recording.
fn seen_at(page: &mut Page, seconds: f64) -> ([f64; 3], Vec<u8>) {
    seek(page, seconds);
    timeline(page, |state| (state["position"].as_f64().unwrap() - seconds).abs() < 1e-6);
    // Frames of the previous time may still be in transit.
    let wanted_ns = (seconds * 1e9) as u64;
    let of = |page: &mut Page, topic: &str| loop {
        let shown = page.next(topic);
        // In a run as fast as possible, a stream may be recorded slightly after others.
        if shown.stamp() <= wanted_ns && wanted_ns - shown.stamp() <= 500_000_000 {
            return shown;
        }
    };
    let states = of(page, STATES);
    let picture = of(page, PICTURE);
    (position(&states, ROBOT), picture.payload)
}

#[test]
fn any_time_of_a_recording_can_be_shown() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("run.mcap");
    record(&file);
    let domain = own_domain();
    let server = Server::view_recording(&domain, &file);
    let scene = server.get(&format!("/scene.glb?token={}", server.token));
    assert!(scene.contains("turtlebot::") && scene.contains("cube::"), "models that were kept");
    let mut page = server.page();
    let first = page.next_json("timeline");
    let duration = first["duration"].as_f64().unwrap();
    assert!((3.9..4.1).contains(&duration), "{first}");
    let mut others = server.page();
    assert!(page.next(PICTURE).payload.len() == 640 * 480 * 3);
    assert_eq!(page.control("pause")["done"], true);
    timeline(&mut page, |state| state["paused"] == true);

    // In any order: forwards, backwards, and to the same time again.
    let [late, early, again] = [3.2, 0.9, 3.2].map(|seconds| seen_at(&mut page, seconds));
    assert!(late == again, "the same time shows the same state");
    assert!(late.0 != early.0 && late.1 != early.1, "{:?} and {:?}", late.0, early.0);
    // Its beginning can be shown too.
    seen_at(&mut page, 0.0);
    assert!(late == seen_at(&mut page, 3.2));
    // A late client sees the current state too.
    assert_eq!(position(&others.next(STATES), ROBOT), late.0);
    assert!(others.next(PICTURE).payload == late.1);

    // A step leads from one message of the clock to the next.
    let stepped = page.control("step");
    assert_eq!(stepped["done"], true, "{stepped}");
    timeline(&mut page, |state| (3.21..3.6).contains(&state["position"].as_f64().unwrap()));

    // At four times the speed it soon reaches its end and pauses; when resumed there, it starts again.
    seek(&mut page, 1.0);
    page.say(&json!({ "op": "rate", "rate": 4.0 }));
    let began = Instant::now();
    assert_eq!(page.control("resume")["done"], true);
    let end = timeline(&mut page, |state| state["position"] == duration && state["paused"] == true);
    assert!(began.elapsed() > Duration::from_millis(700), "{:?} for 3 s", began.elapsed());
    assert_eq!(end["rate"], 4.0);
    assert_eq!(page.control("resume")["done"], true);
    timeline(&mut page, |state| state["position"].as_f64().unwrap() < 3.0 && state["paused"] == false);

    for (wrong, words) in [
        (json!({ "op": "rate", "rate": 0.0 }), "a rate must be from"),
        (json!({ "op": "rate", "rate": -1.0 }), "a rate must be from"),
        (json!({ "op": "seek", "position": 1e300 }), "not a position in a recording"),
    ] {
        page.say(&wrong);
        let said = page.next_json("status");
        assert!(said["text"].as_str().unwrap().contains(words), "{wrong}: {said}");
    }
    let refused = page.control("reset_simulation");
    assert!(refused["reason"].as_str().unwrap().contains("this is a replay"), "{refused}");
}

#[test]
fn errors_of_recordings_are_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("run.mcap");
    std::fs::write(&file, "no recording").unwrap();
    let missing = folder.path().join("missing.mcap");
    let empty = folder.path().join("empty.mcap");
    std::fs::write(&empty, "").unwrap();
    for (file, words) in
        [(&file, "it is not an MCAP file"), (&missing, "No such file"), (&empty, "it ends in the middle")]
    {
        let ended = belvedere().arg("view").arg(file).arg("--no-browser").output().unwrap();
        let said = String::from_utf8_lossy(&ended.stderr).into_owned();
        assert!(ended.status.code() == Some(1) && said.contains(words), "{said}");
    }
    // A simulation has no time line.
    let server = Server::run(&own_domain(), &["--drive", "still"]);
    let mut page = server.page();
    seek(&mut page, 1.0);
    let said = page.next_json("status");
    assert!(said["text"].as_str().unwrap().contains("not a recording"), "{said}");
}
