//! The page's server as seen by another program: access, streams, and no slowdown of other consumers.
#![cfg(feature = "view")]

use crate::live;

use crate::live::control::{BOX, ROBOT, done_with, named};
use crate::live::{PATIENCE, belvedere, files_of, own_domain};
use crate::page::{Server, Shown, position};
use belvedere_bridge::{Domain, Node, Operation, SimulationControl};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::json;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::time::{Duration, Instant};
use tungstenite::Message;

const PICTURE: &str = "camera/rgb/image_raw";
const DEPTH: &str = "camera/depth/image_raw";
const STATES: &str = "simulation/link_states";
const KINECT: [&str; 6] = ["--robot", "kobuki_hexagons_kinect", "--world", "playground", "--drive", "still"];

#[test]
fn access_needs_the_token_and_paths_stay_within_the_page() {
    let server = Server::run(&own_domain(), &KINECT);
    let (host, token) = (&server.host, &server.token);
    let page = server.get(&format!("/?token={token}"));
    assert!(page.starts_with("HTTP/1.1 200 ") && page.contains("<title>Belvedere"), "{page}");
    assert!(server.get("/viewer.js").starts_with("HTTP/1.1 200 "));
    let scene = server.get(&format!("/scene.glb?token={token}"));
    assert!(scene.contains("glTF") && scene.contains("base_link"), "{}", &scene[..200]);
    for target in ["/", "/?token=", "/?token=00000000000000000000000000000000", "/scene.glb"] {
        let answer = server.get(target);
        assert!(answer.starts_with("HTTP/1.1 403 ") && answer.contains("token"), "{target}: {answer}");
    }
    for path in [
        "/../../etc/passwd",
        "/%2e%2e/%2e%2e/etc/passwd",
        "//etc/passwd",
        "/viewer.js/../../Cargo.toml",
        "/dist",
    ] {
        let answer = server.get(&format!("{path}?token={token}"));
        assert!(answer.starts_with("HTTP/1.1 404 "), "{path}: {answer}");
    }
    let upgrade = |host: &str, origin: &str, token: &str| {
        server.ask(&format!(
            "GET /?token={token} HTTP/1.1\r\nHost: {host}\r\nOrigin: {origin}\r\nUpgrade: websocket\r\n\
             Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n"
        ))
    };
    let own = format!("http://{host}");
    let port = host.rsplit(':').next().unwrap();
    for (host, origin, token, reason) in [
        (host.as_str(), own.as_str(), "wrong", "token"),
        (host, "http://evil.example", token, "--allow-origin"),
        (host, &format!("http://evil.example:{port}"), token, "--allow-origin"),
        (&format!("evil.example:{port}"), &own, token, "not the name"),
    ] {
        let answer = upgrade(host, origin, token);
        assert!(answer.starts_with("HTTP/1.1 403 ") && answer.contains(reason), "{host} {origin}: {answer}");
    }
    // Through a tunnel, such as ssh -L 9000:127.0.0.1:8765.
    let tunnelled = server.ask(&format!("GET /?token={token} HTTP/1.1\r\nHost: localhost:9000\r\n\r\n"));
    assert!(tunnelled.starts_with("HTTP/1.1 200 "), "{tunnelled}");
    let long = format!("GET /?token={token} HTTP/1.1\r\nHost: {host}\r\nX: {}\r\n\r\n", "x".repeat(1 << 20));
    let mut stream = TcpStream::connect(host).unwrap();
    // The connection is closed before the whole request is read.
    let _ = stream.write_all(long.as_bytes());
    assert!(server.ask("no request at all\r\n\r\n").starts_with("HTTP/1.1 400 "));
    assert!(server.ask(&format!("POST / HTTP/1.1\r\nHost: {host}\r\n\r\n")).starts_with("HTTP/1.1 405 "));
    // The server is still running.
    server.page().next("clock");
}

#[test]
fn the_page_receives_pictures_pauses_and_drives() {
    let server = Server::run(&own_domain(), &KINECT);
    let mut page = server.page();
    let streams = page.next_json("streams");
    let of = |kind: &str| {
        let streams = streams["streams"].as_array().unwrap().iter();
        streams
            .filter(|stream| stream["kind"] == kind)
            .map(|stream| stream["topic"].clone())
            .collect::<Vec<_>>()
    };
    assert_eq!(of("image"), [PICTURE]);
    let picture = page.next(PICTURE);
    assert_eq!((&picture.header["encoding"], picture.payload.len()), (&json!("rgb8"), 640 * 480 * 3));
    assert!(page.next(PICTURE).stamp() > picture.stamp());
    let depth = page.next(DEPTH);
    assert_eq!((&depth.header["encoding"], depth.payload.len()), (&json!("16uc1"), 640 * 480 * 2));

    assert_eq!(page.control("pause")["done"], true);
    let stood = page.next(STATES);
    assert_eq!(page.next(STATES).stamp(), stood.stamp());
    assert_eq!(page.control("step")["done"], true);
    // Ten steps of physics, then it is paused again.
    let mut stepped = page.next(STATES).stamp();
    loop {
        let next = page.next(STATES).stamp();
        if next == stepped && next > stood.stamp() {
            break;
        }
        stepped = next;
    }
    let step_ns = (stepped - stood.stamp()) / 10;
    assert!([1_000_000, 10_000_000].contains(&step_ns), "{} and then {stepped}", stood.stamp());
}

/// Whatever a page has done, the simulator that serves it leaves no file behind.
#[test]
fn ctrl_c_leaves_nothing_of_a_run_controlled_by_a_page() {
    for round in 0..5 {
        let domain = own_domain();
        let mut server = Server::run(&domain, &["--drive", "still", "--world", "empty"]);
        let mut page = server.page();
        for operation in ["pause", "step", "resume", "reset_simulation"] {
            assert_eq!(page.control(operation)["done"], true, "{operation}");
        }
        kill_process(Pid::from_child(&server.child), Signal::INT).unwrap();
        assert!(server.child.wait().unwrap().success());
        assert_eq!(files_of(&domain), Vec::<String>::new(), "round {round}");
    }
}

#[test]
fn forbidden_requests_of_a_page_are_refused_with_a_reason() {
    let server = Server::run(&own_domain(), &KINECT);
    let mut page = server.page();
    for (message, reason) in [
        (json!({ "op": "control", "operation": "spawn" }), "may not"),
        (json!({ "op": "drive", "topic": "scan" }), "no robot accepts velocities on /scan"),
        (json!({ "op": "next", "topic": "" }), "topic"),
        (json!({ "op": "dance" }), "dance"),
        (json!([]), "not understood"),
    ] {
        page.say(&message);
        let text = page.next_json("status")["text"].to_string();
        assert!(text.contains(reason), "{message}: {text}");
    }
    // A message that is too long closes the connection, perhaps before all of it is sent.
    let long = json!({ "op": "x".repeat(1 << 20) });
    let _ = page.socket.send(Message::text(long.to_string()));
    while page.socket.read().is_ok() {}
    server.page().next("clock");
}

#[test]
fn the_robot_is_driven_by_keys() {
    let server = Server::run(&own_domain(), &KINECT);
    let mut page = server.page();
    let link = format!("{ROBOT}::");
    let before = position(&page.next(STATES), &link);
    let started = Instant::now();
    loop {
        page.say(&json!({ "op": "drive", "topic": "cmd_vel", "linear": [0.3, 0, 0] }));
        let now = position(&page.next(STATES), &link);
        if (now[0] - before[0]).hypot(now[1] - before[1]) > 0.2 {
            break;
        }
        assert!(started.elapsed() < PATIENCE, "it stays at {now:?}");
    }
}

#[test]
fn a_slow_page_slows_no_other_and_hidden_streams_are_not_rendered() {
    let domain = own_domain();
    let server = Server::run(&domain, &KINECT);
    let mut slow = server.page();
    let mut quick = server.page();
    let first = quick.next(PICTURE);
    let seq = |shown: &Shown| shown.header["seq"].as_u64().unwrap();
    let mut last = seq(&first);
    // The other page requests frames and takes nothing, until the buffers in between are full.
    for _ in 0..60 {
        slow.say(&json!({ "op": "next", "topic": PICTURE }));
        let next = quick.next(PICTURE);
        assert!(seq(&next) > last);
        last = seq(&next);
    }
    // Once it has taken the frames that were sent, it receives current ones.
    slow.next(STATES);
    // No depth has been rendered yet: the first frame has number 0.
    assert_eq!(seq(&quick.next(DEPTH)), 0);
    // Nothing is rendered for a page that has left or requests nothing more.
    drop(slow);
    quick.say(&json!({ "op": "stop", "topic": PICTURE }));
    quick.say(&json!({ "op": "stop", "topic": DEPTH }));
    std::thread::sleep(Duration::from_millis(500));
    let made = seq(&quick.next(DEPTH));
    std::thread::sleep(Duration::from_secs(4));
    let forgotten = seq(&quick.next(DEPTH));
    assert!(forgotten < made + 110, "{made} and then {forgotten} of 30 a second");
}

#[test]
fn a_page_continues_when_the_simulator_is_restarted() {
    let domain = own_domain();
    let server = Server::view(&domain);
    let mut page = server.page();
    let simulator = live::Simulator::start_in(domain.clone(), &KINECT);
    let before = page.next(PICTURE);
    simulator.kill();
    let _again = live::Simulator::start_in(domain, &KINECT);
    loop {
        let next = page.next(PICTURE);
        if next.header["restarted"] == true {
            assert_eq!(next.payload.len(), before.payload.len());
            break;
        }
    }
}

#[test]
fn a_page_can_reconnect_to_a_server_with_the_same_token() {
    let domain = own_domain();
    let arguments = [&KINECT[..], &["--token", "a-token-of-ours"]].concat();
    let server = Server::run(&domain, &arguments);
    assert_eq!(server.token, "a-token-of-ours");
    let port = server.host.rsplit(':').next().unwrap().to_owned();
    server.page().next(PICTURE);
    server.kill();
    let again = Server::run(&domain, &[&arguments[..], &["--port", &port]].concat());
    again.page().next(PICTURE);
}

/// Spawned models appear on the page, and deleted ones disappear.
#[test]
fn models_that_come_and_go_are_shown() {
    let domain = own_domain();
    let server = Server::run(&domain, &KINECT);
    let mut page = server.page();
    let first = page.next_json("scene")["edition"].as_u64().unwrap();
    let node = Node::open(&Domain::new(&domain).unwrap(), "control").unwrap();
    let mut control = SimulationControl::open(&node).unwrap();
    let shows = || server.get(&format!("/scene.glb?token={}", server.token)).contains("\"crate::body\"");
    assert!(!shows());
    done_with(&mut control, &named(Operation::Spawn, "crate"), BOX);
    assert_eq!(page.next_json("scene")["edition"], first + 1);
    assert!(shows());
    done_with(&mut control, &named(Operation::Delete, "crate"), "");
    assert_eq!(page.next_json("scene")["edition"], first + 2);
    assert!(!shows());
}

/// A page can fetch its frames by HTTP, which is faster for browsers; without that, and after it, they are sent by its
/// WebSocket.
#[test]
fn a_page_can_fetch_its_own_frames() {
    let server = Server::run(&own_domain(), &KINECT);
    let mut page = server.page();
    let name = page.next_json("page")["name"].as_str().unwrap().to_owned();
    assert_eq!(page.next(PICTURE).payload.len(), 640 * 480 * 3);
    let target = format!("/frames?token={}&page={name}", server.token);
    assert!(server.get(&format!("/frames?page={name}")).starts_with("HTTP/1.1 403 "));
    assert!(server.get(&format!("/frames?token={}&page=other", server.token)).starts_with("HTTP/1.1 404 "));

    let mut stream = TcpStream::connect(&server.host).unwrap();
    stream.set_read_timeout(Some(PATIENCE)).unwrap();
    write!(stream, "GET {target} HTTP/1.1\r\nHost: {}\r\n\r\n", server.host).unwrap();
    let mut stream = BufReader::new(stream);
    let head: Vec<String> =
        stream.by_ref().lines().map(Result::unwrap).take_while(|line| !line.is_empty()).collect();
    assert!(head[0].starts_with("HTTP/1.1 200 "), "{head:?}");
    let mut take = |topic: &str| {
        let mut len = [0; 4];
        stream.read_exact(&mut len).unwrap();
        let mut frame = vec![0; u32::from_le_bytes(len) as usize];
        stream.read_exact(&mut frame).unwrap();
        let shown = Shown::parse(&frame);
        assert_eq!(shown.header["topic"], topic);
        shown
    };
    // The page's thread switches within a moment; everything sent before has arrived.
    std::thread::sleep(Duration::from_millis(300));
    let mut stamps = Vec::new();
    for topic in [PICTURE, DEPTH, STATES, PICTURE, DEPTH, PICTURE] {
        page.say(&json!({ "op": "next", "topic": topic }));
        let shown = take(topic);
        if topic == PICTURE {
            assert_eq!(shown.payload.len(), 640 * 480 * 3);
            stamps.push(shown.stamp());
        }
    }
    assert!(stamps.is_sorted_by(|one, other| one < other), "{stamps:?}");
    drop(stream);
    let deadline = Instant::now() + PATIENCE;
    // Frames that are lost with the connection are requested again.
    page.socket.get_ref().set_read_timeout(Some(Duration::from_millis(500))).unwrap();
    while page.try_next(PICTURE).is_none() {
        assert!(Instant::now() < deadline, "no frame by the WebSocket");
    }
}

#[test]
fn errors_of_the_server_are_one_sentence() {
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    let fails = |arguments: &[&str], words: &[&str]| {
        let output = belvedere().args(arguments).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(
            !output.status.success() && words.iter().all(|word| said.contains(word)),
            "{arguments:?}: {said}"
        );
    };
    let domain = own_domain();
    fails(&["view", "--domain", &domain], &["nothing is published", "belvedere run"]);
    fails(&["view", "--wait", "--domain", &domain, "--port", &port], &[&port, "in use", "--port"]);
    fails(&["run", "--view", "--domain", &domain, "--port", &port], &[&port, "in use", "--port"]);
    fails(&["view", "--wait", "--domain", &domain, "--listen", "192.0.2.1"], &["192.0.2.1", "cannot serve"]);
    fails(&["view", "--token", "short"], &["8 or more"]);
}

#[test]
fn a_camera_is_seen_in_a_terminal() {
    let simulator = live::Simulator::start(&KINECT);
    // The stream may not exist yet.
    simulator.subscribe(PICTURE).wait(PATIENCE).unwrap();
    let show = |arguments: &[&str]| {
        let mut command = belvedere();
        command.args(["view", "--domain", simulator.domain(), "--count", "1"]).args(arguments);
        command.env("COLORTERM", "truecolor").output().unwrap()
    };
    for arguments in [&["--terminal"][..], &["--terminal", PICTURE], &["--terminal", DEPTH]] {
        let output = show(arguments);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let text = String::from_utf8(output.stdout).unwrap();
        // 640 to 480 in 80 columns and 22 rows of two pixels.
        let lines: Vec<&str> = text.lines().filter(|line| line.contains('▀')).collect();
        assert_eq!(lines.len(), 22, "{text}");
        assert!(lines.iter().all(|line| line.matches('▀').count() == 59), "{text}");
        assert!(text.contains("\x1b[38;2;") && text.contains("image_raw  "), "{text}");
    }
    let output = show(&["--terminal", "/odom"]);
    assert!(!output.status.success() && !output.stderr.is_empty());
    let output = show(&["--terminal", "/camera/rgb/imageraw"]);
    assert!(String::from_utf8_lossy(&output.stderr).contains("did you mean '/camera/rgb/image_raw'?"));
}
