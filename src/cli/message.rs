//! A frame as a tree of named values, the way ROS names them, printed as YAML or JSON.

use std::fmt;

use belvedere_bridge::{
    Encoding, FrameHeader, FrameView, Kind, Operation,
    payload::{
        CameraInfo, Clock, CoreSensors, Imu, JointState, ModelState, MotorPower, Odometry, Range,
        ResetOdometry, RobotEvent, SensorSettings, Setting, SimulationCommand, SimulationResult, Transform,
        VelocityCommand,
    },
};
use serde_json::Value;

/// A value of a message.
#[derive(Clone, Debug, PartialEq)]
pub enum Tree {
    /// A whole number.
    Whole(u64),
    /// A number; may be NaN or infinite.
    Number(f64),
    /// Yes or no.
    Flag(bool),
    /// Text.
    Text(String),
    /// The first elements of an array and how many more it has.
    List(Vec<Tree>, usize),
    /// Named values in order.
    Map(Vec<(&'static str, Tree)>),
}

use Tree::{Flag, List, Map, Number, Text, Whole};

impl Tree {
    /// As JSON, which has no NaN (null here) and no infinities (text here). A shortened array ends in a text that
    /// says so.
    #[must_use]
    pub fn to_json(&self) -> Value {
        match self {
            Whole(value) => (*value).into(),
            Number(value) if value.is_infinite() => if *value > 0.0 { "inf" } else { "-inf" }.into(),
            // Turns NaN into null.
            Number(value) => (*value).into(),
            Flag(value) => (*value).into(),
            Text(text) => text.as_str().into(),
            List(values, more) => {
                let mut values: Vec<Value> = values.iter().map(Self::to_json).collect();
                if *more > 0 {
                    values.push(format!("... {more} more").into());
                }
                values.into()
            }
            Map(entries) => {
                entries.iter().map(|(name, value)| ((*name).to_owned(), value.to_json())).collect()
            }
        }
    }

    fn write_yaml(&self, f: &mut fmt::Formatter<'_>, indent: usize) -> fmt::Result {
        match self {
            Map(entries) => {
                for (index, (name, value)) in entries.iter().enumerate() {
                    // The first name after "- " stands on that line.
                    let pad = if index == 0 { 0 } else { indent };
                    write!(f, "{:pad$}{name}:", "")?;
                    match value {
                        Map(_) => {
                            write!(f, "\n{:width$}", "", width = indent + 2)?;
                            value.write_yaml(f, indent + 2)?;
                        }
                        List(values, more) if matches!(values.first(), Some(Map(_))) => {
                            writeln!(f)?;
                            for value in values {
                                write!(f, "{:indent$}- ", "")?;
                                value.write_yaml(f, indent + 2)?;
                            }
                            if *more > 0 {
                                writeln!(f, "{:indent$}# ... {more} more", "")?;
                            }
                        }
                        scalar => {
                            write!(f, " ")?;
                            scalar.write_yaml(f, indent)?;
                            writeln!(f)?;
                        }
                    }
                }
                Ok(())
            }
            List(values, more) => {
                write!(f, "[")?;
                for (index, value) in values.iter().enumerate() {
                    write!(f, "{}", if index > 0 { ", " } else { "" })?;
                    value.write_yaml(f, indent)?;
                }
                if *more > 0 {
                    write!(f, ", ... {more} more")?;
                }
                write!(f, "]")
            }
            Whole(value) => write!(f, "{value}"),
            Number(value) if value.is_nan() => write!(f, ".nan"),
            Number(value) if value.is_infinite() => {
                write!(f, "{}", if *value > 0.0 { ".inf" } else { "-.inf" })
            }
            Number(value) => write!(f, "{value:?}"),
            Flag(value) => write!(f, "{value}"),
            Text(text) => write!(f, "{text:?}"),
        }
    }
}

impl fmt::Display for Tree {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.write_yaml(f, 0)
    }
}

/// What a frame says, arrays shortened to `limit` elements.
#[must_use]
pub fn decode(frame: &FrameView<'_>, limit: usize) -> Tree {
    let header = frame.header();
    let head = ("header", header_tree(header));
    let entries = match header.kind() {
        Some(Kind::Image | Kind::DepthImage) => image(frame, limit),
        Some(Kind::LaserScan) => scan(frame, limit),
        Some(Kind::PointCloud) => cloud(frame, limit),
        Some(Kind::CameraInfo) => one(frame, camera_info),
        Some(Kind::Odometry) => one(frame, odometry),
        Some(Kind::Transforms | Kind::StaticTransforms) => each(frame, "transforms", limit, transform),
        Some(Kind::JointStates) => joints(frame),
        Some(Kind::Clock) => one(frame, |clock: &Clock| vec![("clock", seconds(clock.now_ns))]),
        Some(Kind::VelocityCommand) => one(frame, |command: &VelocityCommand| {
            vec![("linear", xyz(command.linear)), ("angular", xyz(command.angular))]
        }),
        Some(Kind::Imu) => one(frame, imu),
        Some(Kind::RobotEvent) => one(frame, robot_event),
        Some(Kind::CoreSensors) => one(frame, core_sensors),
        Some(Kind::ResetOdometry) => one(frame, |_: &ResetOdometry| Vec::new()),
        Some(Kind::MotorPower) => one(frame, |power: &MotorPower| vec![("state", Whole(power.state.into()))]),
        Some(Kind::SimulationCommand) => one(frame, simulation_command),
        Some(Kind::SimulationResult) => one(frame, simulation_result),
        Some(Kind::ModelStates) => each(frame, "states", limit, model_state),
        Some(Kind::Range) => one(frame, range),
        Some(Kind::SensorSettings) => each(frame, "sensors", limit, sensor_settings),
        None => None,
    };
    let entries = entries.unwrap_or_else(|| unknown(frame, limit));
    Map(std::iter::once(head).chain(entries).collect())
}

type Entries = Vec<(&'static str, Tree)>;

fn header_tree(header: &FrameHeader) -> Tree {
    Map(vec![
        ("seq", Whole(header.seq)),
        ("stamp", seconds(header.stamp_ns)),
        ("frame_id", text(header.frame_id.as_str())),
    ])
}

fn image(frame: &FrameView<'_>, limit: usize) -> Option<Entries> {
    let header = frame.header();
    let encoding = header.encoding()?;
    let data = match encoding {
        Encoding::F32C1 => numbers::<f32>(frame, frame.rows(), limit),
        Encoding::U16C1 => List(
            frame.numbers::<u16>(frame.rows()).take(limit).map(|value| Whole(value.into())).collect(),
            pixels(header).saturating_sub(limit),
        ),
        _ => bytes(frame, limit),
    };
    Some(vec![
        ("height", Whole(header.height.into())),
        ("width", Whole(header.width.into())),
        ("encoding", ros_encoding(encoding)),
        ("is_bigendian", Flag(false)),
        ("step", Whole(header.row_stride.into())),
        ("data", data),
    ])
}

/// The name that `sensor_msgs` has for it: `32fc1` is `32FC1` there, `rgb8` is `rgb8`.
fn ros_encoding(encoding: Encoding) -> Tree {
    let name = encoding.as_str();
    Text(if name.ends_with("c1") { name.to_uppercase() } else { name.to_owned() })
}

fn scan(frame: &FrameView<'_>, limit: usize) -> Option<Entries> {
    let header = frame.header();
    let geometry = header.scan_geometry()?;
    let mut entries = vec![
        ("angle_min", Number(geometry.angle_min)),
        ("angle_max", Number(geometry.angle_max(header.width))),
        ("angle_increment", Number(geometry.angle_increment)),
        ("time_increment", Number(geometry.time_increment)),
        ("scan_time", Number(geometry.scan_time)),
        ("range_min", Number(geometry.range_min.into())),
        ("range_max", Number(geometry.range_max.into())),
    ];
    if header.height > 1 {
        entries.push(("layers", Whole(header.height.into())));
        entries.push(("vertical_angle_min", Number(geometry.vertical_angle_min)));
        entries.push(("vertical_angle_increment", Number(geometry.vertical_angle_increment)));
    }
    let intensities = if header.has_intensities() {
        numbers::<f32>(frame, frame.intensity_rows(), limit)
    } else {
        List(Vec::new(), 0)
    };
    entries.push(("ranges", numbers::<f32>(frame, frame.rows(), limit)));
    entries.push(("intensities", intensities));
    Some(entries)
}

fn cloud(frame: &FrameView<'_>, limit: usize) -> Option<Entries> {
    let header = frame.header();
    if header.encoding()? != Encoding::XyzRgbF32 {
        return None;
    }
    let point = |[x, y, z, _, rgb]: [f32; 5]| {
        let [blue, green, red, _] = rgb.to_bits().to_le_bytes();
        Map(vec![
            ("xyz", List([x, y, z].map(|value| Number(value.into())).to_vec(), 0)),
            ("rgb", List([red, green, blue].map(|value| Whole(value.into())).to_vec(), 0)),
        ])
    };
    Some(vec![
        ("height", Whole(header.height.into())),
        ("width", Whole(header.width.into())),
        ("point_step", Whole(header.elem_stride.into())),
        ("row_step", Whole(header.row_stride.into())),
        (
            "points",
            List(
                frame.numbers::<[f32; 5]>(frame.rows()).take(limit).map(point).collect(),
                pixels(header).saturating_sub(limit),
            ),
        ),
    ])
}

fn camera_info(info: &CameraInfo) -> Entries {
    vec![
        ("height", Whole(info.height.into())),
        ("width", Whole(info.width.into())),
        ("distortion_model", text(info.distortion_model.as_str())),
        ("D", array(&info.d[..(info.d_len as usize).min(info.d.len())])),
        ("K", array(&info.k)),
        ("R", array(&info.r)),
        ("P", array(&info.p)),
    ]
}

fn odometry(odometry: &Odometry) -> Entries {
    vec![
        ("child_frame_id", text(odometry.child_frame_id.as_str())),
        (
            "pose",
            Map(vec![
                (
                    "pose",
                    Map(vec![
                        ("position", xyz(odometry.position)),
                        ("orientation", xyzw(odometry.orientation)),
                    ]),
                ),
                ("covariance", array(&odometry.pose_covariance)),
            ]),
        ),
        (
            "twist",
            Map(vec![
                ("twist", Map(vec![("linear", xyz(odometry.linear)), ("angular", xyz(odometry.angular))])),
                ("covariance", array(&odometry.twist_covariance)),
            ]),
        ),
    ]
}

fn imu(imu: &Imu) -> Entries {
    vec![
        ("orientation", xyzw(imu.orientation)),
        ("orientation_covariance", array(&imu.orientation_covariance)),
        ("angular_velocity", xyz(imu.angular_velocity)),
        ("angular_velocity_covariance", array(&imu.angular_velocity_covariance)),
        ("linear_acceleration", xyz(imu.linear_acceleration)),
        ("linear_acceleration_covariance", array(&imu.linear_acceleration_covariance)),
    ]
}

/// Numbers as they are, with a word for each: what a bumper's 1 is, is a cliff sensor's something else.
fn robot_event(event: &RobotEvent) -> Entries {
    let (source, states) = match event.source {
        RobotEvent::BUMPER => ("bumper", ["released", "pressed"]),
        RobotEvent::CLIFF => ("cliff", ["floor", "cliff"]),
        RobotEvent::WHEEL_DROP => ("wheel_drop", ["raised", "dropped"]),
        _ => ("unknown", ["unknown"; 2]),
    };
    let index = match event.index {
        RobotEvent::LEFT => "left",
        RobotEvent::CENTRE => "centre",
        RobotEvent::RIGHT => "right",
        _ => "unknown",
    };
    vec![
        ("source", text(source)),
        ("index", text(index)),
        ("state", text(states.get(event.state as usize).copied().unwrap_or("unknown"))),
        ("value", Whole(event.value.into())),
    ]
}

fn core_sensors(core: &CoreSensors) -> Entries {
    let signed = |value: i8| Number(value.into());
    vec![
        ("time_stamp", Whole(core.time_stamp.into())),
        ("bumper", Whole(core.bumper.into())),
        ("wheel_drop", Whole(core.wheel_drop.into())),
        ("cliff", Whole(core.cliff.into())),
        ("left_encoder", Whole(core.left_encoder.into())),
        ("right_encoder", Whole(core.right_encoder.into())),
        ("left_pwm", signed(core.left_pwm)),
        ("right_pwm", signed(core.right_pwm)),
        ("buttons", Whole(core.buttons.into())),
        ("charger", Whole(core.charger.into())),
        ("battery", Whole(core.battery.into())),
        ("bottom", List(core.bottom.iter().map(|&reading| Whole(reading.into())).collect(), 0)),
    ]
}

fn transform(transform: &Transform) -> Tree {
    Map(vec![
        ("frame_id", text(transform.parent.as_str())),
        ("child_frame_id", text(transform.child.as_str())),
        (
            "transform",
            Map(vec![("translation", xyz(transform.translation)), ("rotation", xyzw(transform.rotation))]),
        ),
    ])
}

fn joints(frame: &FrameView<'_>) -> Option<Entries> {
    let joints: Vec<JointState> = frame.structs().ok()?.collect();
    let column = |value: fn(&JointState) -> Tree| List(joints.iter().map(value).collect(), 0);
    Some(vec![
        ("name", column(|joint| text(joint.name.as_str()))),
        ("position", column(|joint| Number(joint.position))),
        ("velocity", column(|joint| Number(joint.velocity))),
        ("effort", column(|joint| Number(joint.effort))),
    ])
}

fn simulation_command(command: &SimulationCommand) -> Entries {
    vec![
        ("id", Whole(command.id)),
        ("operation", operation(command.operation)),
        ("steps", Whole(command.steps)),
        ("name", text(command.name.as_str())),
        ("reference_frame", text(command.reference.as_str())),
        ("pose", pose(command.position, command.orientation)),
        ("twist", Map(vec![("linear", xyz(command.linear)), ("angular", xyz(command.angular))])),
        ("text_len", Whole(command.text_len.into())),
    ]
}

fn simulation_result(result: &SimulationResult) -> Entries {
    vec![
        ("id", Whole(result.id)),
        ("operation", operation(result.operation)),
        ("done", Flag(result.done == 1)),
        ("reason", text(result.reason.as_str())),
        ("time", seconds(result.time_ns)),
    ]
}

fn operation(number: u16) -> Tree {
    Operation::from_wire(number).map_or(Whole(number.into()), |operation| text(operation.as_str()))
}

fn model_state(state: &ModelState) -> Tree {
    Map(vec![
        ("name", text(state.name.as_str())),
        ("pose", pose(state.position, state.orientation)),
        ("twist", Map(vec![("linear", xyz(state.linear)), ("angular", xyz(state.angular))])),
    ])
}

fn range(range: &Range) -> Entries {
    let radiation = match range.radiation_type {
        Range::ULTRASOUND => "ultrasound",
        Range::INFRARED => "infrared",
        _ => "unknown",
    };
    vec![
        ("radiation_type", text(radiation)),
        ("field_of_view", Number(range.field_of_view.into())),
        ("min_range", Number(range.min_range.into())),
        ("max_range", Number(range.max_range.into())),
        ("range", Number(range.range.into())),
    ]
}

/// What a sensor has not is left out.
pub(super) fn sensor_settings(sensor: &SensorSettings) -> Tree {
    let topics = sensor.topics().map(text).collect();
    let entries = [("name", text(sensor.name.as_str())), ("topics", List(topics, 0))];
    let number = |Setting { value, min, max }| {
        Map(vec![("value", Number(value)), ("min", Number(min)), ("max", Number(max))])
    };
    let settings = sensor.by_name().into_iter().filter(|(_, setting)| !setting.value.is_nan());
    Map(entries.into_iter().chain(settings.map(|(name, setting)| (name, number(setting)))).collect())
}

fn pose(position: [f64; 3], orientation: [f64; 4]) -> Tree {
    Map(vec![("position", xyz(position)), ("orientation", xyzw(orientation))])
}

/// A kind that this version does not know, or one whose payload is not what its kind promises.
fn unknown(frame: &FrameView<'_>, limit: usize) -> Entries {
    let header = frame.header();
    vec![
        ("kind", Whole(header.kind.into())),
        ("encoding", Whole(header.encoding.into())),
        ("height", Whole(header.height.into())),
        ("width", Whole(header.width.into())),
        ("data", bytes(frame, limit)),
    ]
}

fn one<T: belvedere_bridge::payload::Message>(
    frame: &FrameView<'_>,
    show: impl Fn(&T) -> Entries,
) -> Option<Entries> {
    frame.message().ok().map(|message| show(&message))
}

fn each<T: belvedere_bridge::payload::Message>(
    frame: &FrameView<'_>,
    name: &'static str,
    limit: usize,
    show: impl Fn(&T) -> Tree,
) -> Option<Entries> {
    let structs = frame.structs().ok()?;
    let more = structs.len().saturating_sub(limit);
    Some(vec![(name, List(structs.take(limit).map(|message| show(&message)).collect(), more))])
}

fn pixels(header: &FrameHeader) -> usize {
    header.width as usize * header.height as usize
}

fn bytes(frame: &FrameView<'_>, limit: usize) -> Tree {
    let payload = frame.payload();
    let shown = payload.iter().take(limit).map(|&byte| Whole(byte.into())).collect();
    List(shown, payload.len().saturating_sub(limit))
}

fn numbers<'a, T: bytemuck::Pod + Into<f64>>(
    frame: &FrameView<'a>,
    rows: impl Iterator<Item = &'a [u8]>,
    limit: usize,
) -> Tree {
    let shown = frame.numbers::<T>(rows).take(limit).map(|value| Number(value.into())).collect();
    List(shown, pixels(frame.header()).saturating_sub(limit))
}

fn array(values: &[f64]) -> Tree {
    List(values.iter().map(|&value| Number(value)).collect(), 0)
}

fn xyz([x, y, z]: [f64; 3]) -> Tree {
    Map(vec![("x", Number(x)), ("y", Number(y)), ("z", Number(z))])
}

fn xyzw([x, y, z, w]: [f64; 4]) -> Tree {
    Map(vec![("x", Number(x)), ("y", Number(y)), ("z", Number(z)), ("w", Number(w))])
}

fn text(text: &str) -> Tree {
    Text(text.to_owned())
}

/// A stamp as ROS splits it, exact to the nanosecond.
fn seconds(ns: u64) -> Tree {
    Map(vec![("secs", Whole(ns / 1_000_000_000)), ("nsecs", Whole(ns % 1_000_000_000))])
}

#[cfg(test)]
mod tests {
    use bytemuck::Zeroable as _;

    use super::*;

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
    fn every_kind_is_understood_and_unknown_ones_are_shown() {
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
