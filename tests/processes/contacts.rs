//! A contact sensor as seen by other processes.

use crate::live::{Simulator, next_frame, output};
use belvedere_bridge::Kind;
use belvedere_bridge::payload::Contact;

const ROBOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/instruments.urdf");

#[test]
fn a_bumper_is_listed_published_and_printed() {
    let checked = output(&["check", ROBOT]);
    let text = String::from_utf8_lossy(&checked.stdout);
    for line in [
        "contact sensor feet",
        "watches      base_link::base_link_collision",
        "publishes    /feet: contacts, 50 Hz, frame world",
    ] {
        assert!(text.contains(line), "'{line}' is not in:\n{text}");
    }

    let simulator = Simulator::start(&["--robot", ROBOT, "--world", "empty", "--drive", "still"]);
    let mut feet = simulator.subscribe("feet");
    let contacts = loop {
        let frame = next_frame(&mut feet);
        assert_eq!(frame.header().kind(), Some(Kind::Contacts));
        if frame.header().stamp_ns >= 1_000_000_000 {
            break bytemuck::pod_collect_to_vec::<u8, Contact>(frame.payload());
        }
    };
    // A box of 5 kg with a load of 2 kg stands on the floor.
    let force: f64 = contacts.iter().map(|contact| contact.force[2]).sum();
    assert!((force - 7.0 * 9.8).abs() < 0.3, "{contacts:?}");
    assert_eq!(contacts[0].collision1.as_str(), "instruments::base_link::base_link_collision");
    let echo = output(&["echo", "feet", "--count", "1", "--domain", simulator.domain()]);
    let echo = String::from_utf8(echo.stdout).unwrap();
    for line in
        ["collision2_name: \"ground_plane::link::collision\"", "total_wrench:", "contact_normals:", "depths:"]
    {
        assert!(echo.contains(line), "'{line}' is not in:\n{echo}");
    }
}
