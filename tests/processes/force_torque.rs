//! A force-torque sensor as seen by other processes.

use crate::live::{Simulator, next_frame, output};
use belvedere_bridge::Kind;
use belvedere_bridge::payload::Wrench;

const ROBOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/instruments.urdf");

#[test]
fn a_load_cell_is_listed_published_and_printed() {
    let checked = output(&["check", ROBOT]);
    let text = String::from_utf8_lossy(&checked.stdout);
    for line in [
        "force-torque sensor load_cell",
        "joint        mount",
        "direction    of the joint's child on its parent",
        "publishes    /load/wrench: wrench, 100 Hz, frame load",
    ] {
        assert!(text.contains(line), "'{line}' is not in:\n{text}");
    }

    let simulator = Simulator::start(&["--robot", ROBOT, "--world", "empty", "--drive", "still"]);
    let mut wrenches = simulator.subscribe("load/wrench");
    let (wrench, frame_id) = loop {
        let frame = next_frame(&mut wrenches);
        assert_eq!(frame.header().kind(), Some(Kind::Wrench));
        if frame.header().stamp_ns >= 1_000_000_000 {
            break (frame.message::<Wrench>().unwrap(), frame.header().frame_id.as_str().to_owned());
        }
    };
    // A load of 2 kg presses on what carries it.
    let [x, y, z] = wrench.force;
    assert!(x.abs() < 0.05 && y.abs() < 0.05 && (z + 19.6).abs() < 0.05, "{wrench:?}");
    assert_eq!(frame_id, "load");
    let echo = output(&["echo", "load/wrench", "--count", "1", "--domain", simulator.domain()]);
    let echo = String::from_utf8(echo.stdout).unwrap();
    assert!(echo.contains("wrench:\n  force:\n    x: ") && echo.contains("  torque:\n    x: "), "{echo}");
}
