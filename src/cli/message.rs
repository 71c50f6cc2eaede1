//! Converts a frame to a tree of values with the names that ROS uses, which is printed as YAML or JSON.

mod parts;
mod robot;
mod sensors;
mod simulation;
mod tree;
mod truth;

pub(super) use simulation::sensor_settings;
pub use tree::Tree;

use Tree::{List, Map, Whole};
use belvedere_bridge::payload::{Clock, Message, MotorPower, ResetOdometry, Vector3, VelocityCommand};
use belvedere_bridge::{FrameHeader, FrameView, Kind};
use parts::{Entries, seconds, text, xyz};

/// Converts a frame to a tree, with arrays shortened to `limit` elements.
#[must_use]
pub fn decode(frame: &FrameView<'_>, limit: usize) -> Tree {
    let header = frame.header();
    let head = ("header", header_tree(header));
    let entries = match header.kind() {
        Some(Kind::Image | Kind::DepthImage) => sensors::image(frame, limit),
        Some(Kind::LaserScan) => sensors::scan(frame, limit),
        Some(Kind::PointCloud) => sensors::cloud(frame, limit),
        Some(Kind::CameraInfo) => one(frame, sensors::camera_info),
        Some(Kind::Odometry) => one(frame, robot::odometry),
        Some(Kind::Transforms | Kind::StaticTransforms) => each(frame, "transforms", limit, robot::transform),
        Some(Kind::JointStates) => robot::joints(frame),
        Some(Kind::Clock) => one(frame, |clock: &Clock| vec![("clock", seconds(clock.now_ns))]),
        Some(Kind::VelocityCommand) => one(frame, |command: &VelocityCommand| {
            vec![("linear", xyz(command.linear)), ("angular", xyz(command.angular))]
        }),
        Some(Kind::Imu) => one(frame, sensors::imu),
        Some(Kind::NavSatFix) => one(frame, sensors::nav_sat_fix),
        Some(Kind::MagneticField) => one(frame, sensors::magnetic_field),
        Some(Kind::FluidPressure) => one(frame, sensors::fluid_pressure),
        Some(Kind::Altimeter) => one(frame, sensors::altimeter),
        Some(Kind::Vector3) => one(frame, |vector: &Vector3| vec![("vector", xyz(vector.vector))]),
        Some(Kind::RobotEvent) => one(frame, robot::event),
        Some(Kind::CoreSensors) => one(frame, robot::core_sensors),
        Some(Kind::ResetOdometry) => one(frame, |_: &ResetOdometry| Vec::new()),
        Some(Kind::MotorPower) => one(frame, |power: &MotorPower| vec![("state", Whole(power.state.into()))]),
        Some(Kind::SimulationCommand) => one(frame, simulation::command),
        Some(Kind::SimulationResult) => one(frame, simulation::result),
        Some(Kind::ModelStates) => each(frame, "states", limit, simulation::model_state),
        Some(Kind::Range) => one(frame, sensors::range),
        Some(Kind::SensorSettings) => each(frame, "sensors", limit, simulation::sensor_settings),
        Some(Kind::BoundingBoxes) => each(frame, "boxes", limit, truth::bounding_box),
        Some(Kind::TagDetections) => each(frame, "tags", limit, truth::tag_detection),
        None => None,
    };
    let entries = entries.unwrap_or_else(|| unknown(frame, limit));
    Map(std::iter::once(head).chain(entries).collect())
}

fn header_tree(header: &FrameHeader) -> Tree {
    Map(vec![
        ("seq", Whole(header.seq)),
        ("stamp", seconds(header.stamp_ns)),
        ("frame_id", text(header.frame_id.as_str())),
    ])
}

/// Shows a frame of a kind that this version does not know, or one whose payload does not match its kind.
fn unknown(frame: &FrameView<'_>, limit: usize) -> Entries {
    let header = frame.header();
    vec![
        ("kind", Whole(header.kind.into())),
        ("encoding", Whole(header.encoding.into())),
        ("height", Whole(header.height.into())),
        ("width", Whole(header.width.into())),
        ("data", sensors::bytes(frame, limit)),
    ]
}

fn one<T: Message>(frame: &FrameView<'_>, show: impl Fn(&T) -> Entries) -> Option<Entries> {
    frame.message().ok().map(|message| show(&message))
}

fn each<T: Message>(
    frame: &FrameView<'_>,
    name: &'static str,
    limit: usize,
    show: impl Fn(&T) -> Tree,
) -> Option<Entries> {
    let structs = frame.structs().ok()?;
    let more = structs.len().saturating_sub(limit);
    Some(vec![(name, List(structs.take(limit).map(|message| show(&message)).collect(), more))])
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_bridge::Encoding;
    use belvedere_bridge::payload::Transform;
    use bytemuck::Zeroable as _;

    #[test]
    fn an_image_is_shortened() {
        let mut header = FrameHeader::new(Kind::DepthImage, Encoding::F32C1);
        header.payload_len = header.set_packed(3, 2) as u64;
        header.stamp_ns = 1_500_000_000;
        let depth = [1.0_f32, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 5.0, 6.0];
        let frame = FrameView::new(&header, bytemuck::cast_slice(&depth)).unwrap();
        let message = decode(&frame, 4);
        assert_eq!(
            message.to_string(),
            "header:\n  seq: 0\n  stamp:\n    secs: 1\n    nsecs: 500000000\n  frame_id: \"\"\nheight: 2\nwidth: 3\n\
             encoding: \"32FC1\"\nis_bigendian: false\nstep: 12\ndata: [1.0, .nan, .inf, -.inf, ... 2 more]\n"
        );
        assert_eq!(message.to_json()["data"], serde_json::json!([1.0, null, "inf", "-inf", "... 2 more"]));
    }

    #[test]
    fn transforms_are_a_list_of_maps() {
        let transform = Transform { translation: [1.0, 2.0, 3.0], ..Transform::zeroed() };
        let mut header = FrameHeader::new(Kind::Transforms, Encoding::Struct);
        header.payload_len = header.set_packed(1, 2) as u64;
        let transforms = [transform; 2];
        let frame = FrameView::new(&header, bytemuck::cast_slice(&transforms)).unwrap();
        let message = decode(&frame, 1);
        let yaml = message.to_string();
        assert!(yaml.contains("transforms:\n- frame_id: \"\"\n  child_frame_id: \"\"\n  transform:\n    translation:\n      x: 1.0\n"), "{yaml}");
        assert!(yaml.ends_with("# ... 1 more\n"), "{yaml}");
        assert_eq!(message.to_json()["transforms"][0]["transform"]["translation"]["z"], 3.0);
    }

    #[test]
    fn every_kind_is_decoded_and_unknown_kinds_are_shown() {
        for &kind in Kind::ALL {
            let encoding = match kind {
                Kind::Image => Encoding::Rgb8,
                Kind::DepthImage => Encoding::U16C1,
                Kind::LaserScan => Encoding::RangesF32,
                Kind::PointCloud => Encoding::XyzRgbF32,
                _ => Encoding::Struct,
            };
            let mut header = FrameHeader::new(kind, encoding);
            let payload = vec![0; header.set_packed(1, 1)];
            header.payload_len = payload.len() as u64;
            let message = decode(&FrameView::new(&header, &payload).unwrap(), 4);
            let Map(entries) = &message else { panic!("{message}") };
            assert!(entries.iter().all(|(name, _)| *name != "kind"), "{kind} was not understood");
        }
        let header = FrameHeader { kind: 999, encoding: 999, payload_len: 2, ..FrameHeader::default() };
        let message = decode(&FrameView::new(&header, &[1, 2]).unwrap(), 4);
        assert_eq!(message.to_json()["kind"], 999);
    }
}
