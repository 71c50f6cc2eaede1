//! Rangefinders and lidars with several layers, as seen by other processes.

use crate::live::{Simulator, next_frame, output};
use belvedere_bridge::payload::Range;
use belvedere_bridge::{Kind, Subscriber};

const ROBOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/rangefinders.urdf");
/// The height above the ground; the robot sinks into it by less than a millimetre.
const HEIGHT_M: f32 = 0.55;
const LIDAR_HEIGHT_M: f64 = 1.0;
const SINKING_M: f32 = 1e-3;

fn start(more: &[&str]) -> Simulator {
    Simulator::start(&[&["--robot", ROBOT, "--world", "empty", "--drive", "still"], more].concat())
}

fn settled(subscriber: &mut Subscriber) -> (Range, String) {
    loop {
        let frame = next_frame(subscriber);
        assert_eq!(frame.header().kind(), Some(Kind::Range));
        if frame.header().stamp_ns >= 500_000_000 {
            return (frame.message().unwrap(), frame.header().frame_id.as_str().to_owned());
        }
    }
}

fn range(simulator: &Simulator, topic: &str) -> Range {
    settled(&mut simulator.subscribe(topic)).0
}

#[test]
fn a_rangefinder_measures_the_nearest_surface_in_its_cone() {
    let simulator = start(&[]);
    let (down, frame) = settled(&mut simulator.subscribe("sonar/down"));
    assert!((down.range - HEIGHT_M).abs() < SINKING_M, "{down:?}");
    assert_eq!((down.min_range, down.max_range, down.field_of_view), (0.02, 4.0, 0.2));
    assert_eq!((down.radiation_type, frame.as_str()), (Range::ULTRASOUND, "sonar_link"));
    let short = range(&simulator, "infrared/short");
    assert_eq!((short.range, short.radiation_type), (f32::INFINITY, Range::INFRARED));
    assert_eq!(range(&simulator, "infrared/far").range, f32::NEG_INFINITY);
    // It has the settings of any sensor.
    let command = ["control", "configure", "down", "noise_mean=0.5", "--domain", simulator.domain()];
    assert!(output(&command).status.success());
    let mut down = simulator.subscribe("sonar/down");
    let noisy = next_frame(&mut down).message::<Range>().unwrap();
    assert!((noisy.range - HEIGHT_M - 0.5).abs() < SINKING_M, "{noisy:?}");
    let echo = output(&["echo", "sonar/down", "--count", "1", "--domain", simulator.domain()]);
    let echo = String::from_utf8(echo.stdout).unwrap();
    assert!(echo.contains("radiation_type: \"ultrasound\"\nfield_of_view: 0.2"), "{echo}");
}

#[test]
fn in_gazebo_mode_it_reports_its_largest_range_without_a_hit() {
    let simulator = start(&["--gazebo-compat"]);
    assert!((range(&simulator, "sonar/down").range - HEIGHT_M).abs() < SINKING_M);
    assert_eq!(range(&simulator, "infrared/short").range, 0.4);
    // The ray begins below the ground.
    assert_eq!(range(&simulator, "infrared/far").range, 4.0);
}

#[test]
fn the_layers_of_a_lidar_are_in_order_from_the_lowest() {
    let simulator = start(&[]);
    let mut scan = simulator.subscribe("velodyne_points");
    let frame = loop {
        let frame = next_frame(&mut scan);
        if frame.header().stamp_ns >= 500_000_000 {
            break frame;
        }
    };
    let (header, view) = (frame.header(), frame.view());
    assert_eq!((header.width, header.height, header.frame_id.as_str()), (8, 4, "velodyne"));
    let geometry = header.scan_geometry().unwrap();
    assert!((geometry.vertical_angle_increment - 0.3).abs() < 1e-9);
    assert_eq!((geometry.range_min, geometry.range_max), (0.4, 50.0));
    let ranges: Vec<f32> = view.numbers::<f32>(view.rows()).collect();
    for (index, range) in ranges.into_iter().enumerate() {
        let up_rad = geometry.vertical_angle_min + (index / 8) as f64 * geometry.vertical_angle_increment;
        if up_rad < -1e-6 {
            let expected = LIDAR_HEIGHT_M / -up_rad.sin();
            assert!(
                (f64::from(range) - expected).abs() < 5e-3 * expected,
                "{index}: {range}, not {expected}"
            );
        } else {
            assert_eq!(range, f32::INFINITY, "{index}");
        }
    }
    let streams = simulator.node().streams().unwrap();
    let layers = |topic| streams.iter().find(|stream| stream.topic == topic).unwrap().layers;
    assert_eq!([layers("velodyne_points"), layers("scan"), layers("clock")], [Some(4), Some(1), None]);
}
