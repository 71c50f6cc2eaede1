//! Payload structs as messages of ROS 1 and ROS 2: their types, their bytes and their definitions.

mod bytes;
mod definition;
mod primitive;

pub use bytes::RosBytes;
pub use primitive::RosPrimitive;

use super::{
    FrameHeader, FrameView, Kind,
    fields::{Fields, RosType, Value},
    layout::Struct,
};
use definition::Definition;

/// ROS 1 or ROS 2. Their types of messages have almost the same fields, and another encoding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Ros {
    /// ROS 1: `ros1msg`, and bytes without alignment.
    One,
    /// ROS 2: `ros2msg`, and CDR.
    Two,
}

impl Ros {
    /// Returns the name of the type that is `package/Type` in ROS 1.
    #[must_use]
    pub fn type_name(self, of_ros1: &str) -> String {
        match (self, of_ros1.split_once('/')) {
            // The messages of Kobuki have moved to another package.
            (Self::Two, Some(("kobuki_msgs", name))) => format!("kobuki_ros_interfaces/msg/{name}"),
            (Self::Two, Some((package, name))) => format!("{package}/msg/{name}"),
            _ => of_ros1.to_owned(),
        }
    }

    /// Returns the definition of the type that is `name` in ROS 1, followed by those of its parts, in the form of
    /// `ros1msg` or `ros2msg`. `describe` passes the fields, with any values.
    #[must_use]
    pub fn definition(self, name: &'static str, describe: &mut dyn FnMut(&mut dyn Fields)) -> String {
        let mut all = Definition::new(self, name);
        describe(&mut all);
        all.text()
    }
}

/// The message of ROS that a stream of structs is published as.
#[derive(Clone, Copy, Debug)]
pub struct RosMessage {
    layout: &'static Struct,
    /// The type of the message in ROS 1.
    pub ros: &'static RosType,
}

impl RosMessage {
    /// Returns the message of a stream; `None` if ROS has no type for it. Images, scans and clouds are no structs.
    #[must_use]
    pub fn of(kind: Kind, topic: &str) -> Option<Self> {
        let last = topic.rsplit('/').next().unwrap_or(topic);
        let layout = kind.layout()?;
        let ros = layout.ros.iter().find(|ros| ros.topic.is_empty() || ros.topic == last)?;
        Some(Self { layout, ros })
    }

    /// Returns the definition of the type followed by those of its parts, in the form of `ros1msg` or `ros2msg`.
    #[must_use]
    pub fn definition(&self, ros: Ros) -> String {
        let mut all = Definition::new(ros, self.ros.name);
        if let Some(describe) = self.layout.describe {
            // The values do not matter.
            let zeros = vec![0; self.layout.size];
            let _ = describe(&mut std::iter::once(&zeros[..]), &mut all);
        }
        if let Some(file) = self.ros.file {
            all.set_own(file);
        }
        all.text()
    }

    /// Appends a frame's message to `out`. `None` if the message cannot hold the frame; then `out` holds a part of it.
    #[must_use]
    pub fn write(&self, ros: Ros, frame: &FrameView<'_>, out: &mut Vec<u8>) -> Option<()> {
        if !self.layout.kinds.contains(&frame.header().kind) {
            return None;
        }
        let mut message =
            Message { ros, name: self.ros.name, header: frame.header(), bytes: RosBytes::begin(ros, out) };
        frame.describe(&mut message)?;
        message.bytes.end()
    }
}

/// The values of a message as bytes.
struct Message<'a> {
    ros: Ros,
    /// The type's name in ROS 1.
    name: &'static str,
    header: &'a FrameHeader,
    bytes: RosBytes<'a>,
}

impl<'a> Message<'a> {
    fn all<T: Copy>(&mut self, values: &[T], append: impl Fn(&mut RosBytes<'a>, T)) {
        self.bytes.count(values.len());
        for &value in values {
            append(&mut self.bytes, value);
        }
    }
}

impl Fields for Message<'_> {
    fn ros(&self) -> Option<&'static str> {
        Some(self.name)
    }

    fn is_ros2(&self) -> bool {
        self.ros == Ros::Two
    }

    fn header(&mut self, frame_id: Option<&str>) {
        self.bytes.header(self.header, frame_id);
    }

    fn value(&mut self, _: &'static str, value: Value<'_>) {
        match value {
            Value::Bool(value) => self.bytes.u8(value.into()),
            Value::U8(value) | Value::Word(value, _) => self.bytes.u8(value),
            Value::I8(value) => self.bytes.i8(value),
            Value::U16(value) => self.bytes.u16(value),
            Value::U32(value) => self.bytes.u32(value),
            Value::U64(value) => self.bytes.u64(value),
            Value::F32(value) => self.bytes.f32(value),
            Value::F64(value) => self.bytes.f64(value),
            Value::Time(time_ns) => self.bytes.time(time_ns),
            Value::Text(text) => self.bytes.text(text),
            Value::Frame(name) => self.bytes.frame_id(name),
            Value::Array(values) => {
                for &value in values {
                    self.bytes.f64(value);
                }
            }
            Value::U8s(values) => self.bytes.bytes(values),
            Value::U16s(values) => self.all(values, RosBytes::u16),
            Value::U32s(values) => self.all(values, RosBytes::u32),
            Value::F32s(values) => self.all(values, RosBytes::f32),
            Value::F64s(values) => self.all(values, RosBytes::f64),
            Value::Pixels(values) => self.all(values.as_flattened(), RosBytes::f64),
            Value::Texts(texts) => self.all(texts, RosBytes::text),
        }
    }

    fn part(&mut self, _: &'static str, _: &'static str, describe: &mut dyn FnMut(&mut dyn Fields)) {
        describe(self);
    }

    fn list(
        &mut self,
        _: &'static str,
        _: &'static str,
        count: usize,
        describe: &mut dyn FnMut(usize, &mut dyn Fields),
    ) {
        self.bytes.count(count);
        (0..count).for_each(|index| describe(index, self));
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use md5::{Digest as _, Md5};

    use super::*;
    use crate::{Encoding, payload, schema};

    /// The sum of a type of ROS: constants, then fields, each part replaced by its own sum.
    fn sum(own: &str, parts: &BTreeMap<&str, &str>) -> String {
        let lines =
            own.lines().map(|line| line.split('#').next().unwrap().trim()).filter(|line| !line.is_empty());
        let (constants, fields): (Vec<_>, Vec<_>) = lines.partition(|line| line.contains('='));
        let fields = fields.into_iter().map(|field| {
            let (of, name) = field.split_once(' ').unwrap();
            let of = of.trim_end_matches("[]");
            let part =
                parts.iter().find(|(known, _)| **known == of || known.rsplit_once('/').unwrap().1 == of);
            part.map_or(field.to_owned(), |(_, own)| format!("{} {}", sum(own, parts), name.trim()))
        });
        let constants = constants.into_iter().map(|line| line.replace(" =", "=").replace("= ", "="));
        let text = constants.chain(fields).collect::<Vec<_>>().join("\n");
        Md5::digest(text).iter().fold(String::new(), |sum, byte| format!("{sum}{byte:02x}"))
    }

    #[test]
    fn definitions_have_the_sums_of_their_types() {
        let mut count = 0;
        for layout in schema::structs() {
            for ros in layout.ros {
                let definition = RosMessage { layout, ros }.definition(Ros::One);
                let line = format!("\n{}\nMSG: ", "=".repeat(80));
                let (own, parts) = definition.split_once(&line).unwrap_or((&definition, ""));
                let parts = parts.split(&line).filter_map(|part| part.split_once('\n')).collect();
                assert_eq!(sum(own, &parts), ros.md5, "{}:\n{definition}", ros.name);
                count += 1;
            }
        }
        assert!(count >= 19, "{count}");
    }

    /// Which fields a message has is in its file and in its description.
    #[test]
    fn files_have_the_fields_that_are_described() {
        for layout in schema::structs() {
            for ros in layout.ros.iter().filter(|ros| ros.file.is_some()) {
                let mut all = Definition::new(Ros::One, ros.name);
                let mut zeros = vec![0; layout.size];
                // The source of a RobotEvent.
                zeros[0] = ["kobuki_msgs/BumperEvent", "kobuki_msgs/CliffEvent", "kobuki_msgs/WheelDropEvent"]
                    .iter()
                    .position(|name| *name == ros.name)
                    .unwrap_or(0) as u8;
                layout.describe.unwrap()(&mut std::iter::once(&zeros[..]), &mut all).unwrap();
                let lines = ros.file.unwrap().lines().map(|line| line.split('#').next().unwrap().trim());
                let fields: Vec<_> = lines.filter(|line| !line.is_empty() && !line.contains('=')).collect();
                assert_eq!(all.own().lines().collect::<Vec<_>>(), fields, "{}", ros.name);
            }
        }
    }

    #[test]
    fn parts_stand_once_behind_what_uses_them() {
        let line = "=".repeat(80);
        let twist = RosMessage::of(Kind::VelocityCommand, "cmd_vel").unwrap().definition(Ros::One);
        let expected = format!(
            "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n{line}\nMSG: geometry_msgs/Vector3\nfloat64 \
             x\nfloat64 y\nfloat64 z"
        );
        assert_eq!(twist, expected);
        let odometry = RosMessage::of(Kind::Odometry, "odom").unwrap().definition(Ros::One);
        assert_eq!(odometry.matches("MSG: geometry_msgs/Point\n").count(), 1);
        assert_eq!(odometry.matches("MSG: ").count(), 8);
    }

    #[test]
    fn a_time_beyond_32_bits_of_seconds_and_an_event_of_another_source_have_no_message() {
        let mut header = FrameHeader::new(Kind::RobotEvent, Encoding::Struct);
        header.payload_len = header.set_packed(1, 1) as u64;
        let bumper = [0_u32, 2, 1, 0];
        let write = |header: &FrameHeader, topic: &str| {
            let mut out = Vec::new();
            let frame = FrameView::new(header, bytemuck::cast_slice(&bumper)).unwrap();
            RosMessage::of(header.kind().unwrap(), topic)
                .unwrap()
                .write(Ros::One, &frame, &mut out)
                .map(|()| out)
        };
        assert_eq!(write(&header, "events/bumper"), Some(vec![2, 1]));
        assert_eq!(write(&header, "events/cliff"), None);
        assert!(RosMessage::of(Kind::RobotEvent, "events/horn").is_none());
        assert!(RosMessage::of(Kind::Image, "image_raw").is_none());

        let mut header = FrameHeader::new(Kind::FluidPressure, Encoding::Struct);
        header.payload_len = header.set_packed(1, 1) as u64;
        header.stamp_ns = 4_294_967_295_999_999_999;
        assert_eq!(write(&header, "pressure").unwrap().len(), 4 + 8 + 4 + 16);
        header.stamp_ns += 1;
        assert_eq!(write(&header, "pressure"), None);
    }

    /// A message of ROS 2, without the four bytes that name its encoding.
    fn cdr(topic: &str, kind: Kind, count: u32, stamp_ns: u64, payload: &[u8]) -> Option<Vec<u8>> {
        let mut header = FrameHeader::new(kind, Encoding::Struct);
        header.payload_len = header.set_packed(1, count) as u64;
        header.stamp_ns = stamp_ns;
        let mut out = vec![7; 3];
        let frame = FrameView::new(&header, payload).unwrap();
        RosMessage::of(kind, topic).unwrap().write(Ros::Two, &frame, &mut out)?;
        assert_eq!(out[..7], [7, 7, 7, 0, 1, 0, 0]);
        Some(out.split_off(7))
    }

    /// Alignment counts from the end of the four bytes, wherever the message begins in its buffer.
    #[test]
    fn numbers_of_ros2_are_aligned_to_their_size() {
        let cliff = [1_u32, 2, 1, 0x1234];
        let cliff = cdr("events/cliff", Kind::RobotEvent, 1, 0, bytemuck::cast_slice(&cliff));
        assert_eq!(cliff.unwrap(), [2, 1, 0x34, 0x12]);

        let mut joint: payload::JointState = bytemuck::Zeroable::zeroed();
        joint.name = crate::Text::new("a").unwrap();
        (joint.position, joint.velocity, joint.effort) = (1.5, f64::NEG_INFINITY, -2.0);
        let stamp_ns = 3_000_000_004;
        let joints = cdr("joint_states", Kind::JointStates, 1, stamp_ns, bytemuck::bytes_of(&joint)).unwrap();
        // Time, and an empty text: its 0, and three bytes to the next number.
        let header = [3, 0, 0, 0, 4, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0];
        let list = |gap: &[u8], value: f64| [&1_u32.to_le_bytes(), gap, &value.to_le_bytes()].concat();
        // A list of one name takes 10 bytes, so the next list begins after a gap of two.
        let expected = [
            &header[..],
            &[1, 0, 0, 0, 2, 0, 0, 0, b'a', 0, 0, 0],
            &list(&[], 1.5),
            &list(&[0; 4], f64::NEG_INFINITY),
            &list(&[0; 4], -2.0),
        ];
        assert_eq!(joints, expected.concat());
        // An empty list ends with its count.
        let joints = cdr("joint_states", Kind::JointStates, 0, stamp_ns, &[]).unwrap();
        assert_eq!(joints, [&header[..], &[0; 16]].concat());
    }

    #[test]
    fn messages_of_ros2_are_never_empty_and_their_time_has_a_sign() {
        assert_eq!(cdr("reset", Kind::ResetOdometry, 1, 0, &[0; 8]).unwrap(), [0]);
        assert_eq!(cdr("power", Kind::MotorPower, 1, 0, &[1, 0, 0, 0]).unwrap(), [1]);
        let last = 2_147_483_647_999_999_999;
        assert_eq!(cdr("pressure", Kind::FluidPressure, 1, last, &[0; 16]).unwrap().len(), 16 + 16);
        assert_eq!(cdr("pressure", Kind::FluidPressure, 1, last + 1, &[0; 16]), None);
    }

    #[test]
    fn definitions_of_ros2_name_packages_and_have_no_capital_letters_in_fields() {
        let line = format!("\n{}\nMSG: ", "=".repeat(80));
        let definition = |kind, topic: &str| RosMessage::of(kind, topic).unwrap().definition(Ros::Two);
        let time = format!("{line}builtin_interfaces/Time\nint32 sec\nuint32 nanosec");
        assert_eq!(definition(Kind::Clock, "clock"), format!("builtin_interfaces/Time clock{time}"));
        let camera = definition(Kind::CameraInfo, "camera_info");
        assert!(camera.starts_with("std_msgs/Header header\nuint32 height\n"), "{camera}");
        assert!(camera.contains("float64[] d\nfloat64[9] k\nfloat64[9] r\nfloat64[12] p\n"), "{camera}");
        let header = format!("{line}std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id{time}");
        assert!(camera.contains(&header), "{camera}");
        let range = definition(Kind::Range, "range");
        assert!(range.contains("float32 range\nfloat32 variance\n=") && !range.contains("seq"), "{range}");
        // Of a type with a file.
        let contacts = definition(Kind::Contacts, "contacts");
        assert!(contacts.contains("\nstd_msgs/Header header\n") && contacts.contains(&header), "{contacts}");
        assert_eq!(Ros::Two.type_name("kobuki_msgs/CliffEvent"), "kobuki_ros_interfaces/msg/CliffEvent");
        assert_eq!(Ros::Two.type_name("sensor_msgs/Imu"), "sensor_msgs/msg/Imu");
    }

    #[test]
    fn a_frame_of_another_kind_has_no_message() {
        let mut header = FrameHeader::new(Kind::MotorPower, Encoding::Struct);
        header.payload_len = header.set_packed(1, 1) as u64;
        let frame = FrameView::new(&header, &[1, 0, 0, 0]).unwrap();
        let mut out = Vec::new();
        assert_eq!(
            RosMessage::of(Kind::MotorPower, "power").unwrap().write(Ros::One, &frame, &mut out),
            Some(())
        );
        assert_eq!(RosMessage::of(Kind::Imu, "imu").unwrap().write(Ros::One, &frame, &mut out), None);
        assert_eq!(out, [1]);
    }
}
