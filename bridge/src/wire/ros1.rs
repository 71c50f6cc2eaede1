//! Payload structs as messages of ROS 1: their bytes and their definitions.

use std::fmt::Write as _;

use super::{
    FrameHeader, FrameView, Kind,
    fields::{Fields, RosType, Value},
    layout::Struct,
};

/// The message of ROS 1 that a stream of structs is published as.
#[derive(Clone, Copy, Debug)]
pub struct Ros1Message {
    layout: &'static Struct,
    /// The type of the message.
    pub ros: &'static RosType,
}

impl Ros1Message {
    /// Returns the message of a stream; `None` if ROS has no type for it. Images, scans and clouds are no structs.
    #[must_use]
    pub fn of(kind: Kind, topic: &str) -> Option<Self> {
        let last = topic.rsplit('/').next().unwrap_or(topic);
        let layout = kind.layout()?;
        let ros = layout.ros.iter().find(|ros| ros.topic.is_empty() || ros.topic == last)?;
        Some(Self { layout, ros })
    }

    /// Returns the definition of the type followed by those of its parts, in the form of `ros1msg`.
    #[must_use]
    pub fn definition(&self) -> String {
        let mut all = Definition { ros: self.ros.name, fields: String::new(), parts: Vec::new() };
        if let Some(describe) = self.layout.describe {
            // The values do not matter.
            let zeros = vec![0; self.layout.size];
            let _ = describe(&mut std::iter::once(&zeros[..]), &mut all);
        }
        let mut text = self.ros.file.map_or(all.fields.trim_end(), str::trim_end).to_owned();
        for (name, fields) in all.parts {
            let _ = write!(text, "\n{}\nMSG: {name}\n{}", "=".repeat(80), fields.trim_end());
        }
        text
    }

    /// Appends a frame's message to `out`. `None` if the message cannot hold the frame; then `out` holds a part of it.
    #[must_use]
    pub fn write(&self, frame: &FrameView<'_>, out: &mut Vec<u8>) -> Option<()> {
        if !self.layout.kinds.contains(&frame.header().kind) {
            return None;
        }
        let mut bytes = Bytes { ros: self.ros.name, header: frame.header(), out, is_complete: true };
        frame.describe(&mut bytes)?;
        bytes.is_complete.then_some(())
    }
}

/// The bytes of a message: little-endian, field after field, without alignment.
struct Bytes<'a> {
    ros: &'static str,
    header: &'a FrameHeader,
    out: &'a mut Vec<u8>,
    /// False if a value is out of the range of its type.
    is_complete: bool,
}

impl Bytes<'_> {
    fn push<const N: usize>(&mut self, bytes: [u8; N]) {
        self.out.extend_from_slice(&bytes);
    }

    fn count(&mut self, count: usize) {
        self.push((count as u32).to_le_bytes());
    }

    fn sequence<T: Copy, const N: usize>(&mut self, values: &[T], bytes: impl Fn(T) -> [u8; N]) {
        self.count(values.len());
        for &value in values {
            self.push(bytes(value));
        }
    }

    fn text(&mut self, text: &str) {
        self.count(text.len());
        self.out.extend_from_slice(text.as_bytes());
    }

    /// Without the leading slash that tf2 refuses.
    fn frame_id(&mut self, name: &str) {
        self.text(name.strip_prefix('/').unwrap_or(name));
    }

    /// Seconds and nanoseconds, of 32 bits each.
    fn time(&mut self, time_ns: u64) {
        let seconds = u32::try_from(time_ns / 1_000_000_000);
        self.is_complete &= seconds.is_ok();
        self.push(seconds.unwrap_or(u32::MAX).to_le_bytes());
        self.push(((time_ns % 1_000_000_000) as u32).to_le_bytes());
    }
}

impl Fields for Bytes<'_> {
    fn ros(&self) -> Option<&'static str> {
        Some(self.ros)
    }

    fn header(&mut self, frame_id: Option<&str>) {
        let header = self.header;
        self.push((header.seq as u32).to_le_bytes());
        self.time(header.stamp_ns);
        self.frame_id(frame_id.unwrap_or(header.frame_id.as_str()));
    }

    fn value(&mut self, _: &'static str, value: Value<'_>) {
        match value {
            Value::Bool(value) => self.push([value.into()]),
            Value::U8(value) | Value::Word(value, _) => self.push([value]),
            Value::I8(value) => self.push(value.to_le_bytes()),
            Value::U16(value) => self.push(value.to_le_bytes()),
            Value::U32(value) => self.push(value.to_le_bytes()),
            Value::U64(value) => self.push(value.to_le_bytes()),
            Value::F32(value) => self.push(value.to_le_bytes()),
            Value::F64(value) => self.push(value.to_le_bytes()),
            Value::Time(time_ns) => self.time(time_ns),
            Value::Text(text) => self.text(text),
            Value::Frame(name) => self.frame_id(name),
            Value::Array(values) => values.iter().for_each(|value| self.push(value.to_le_bytes())),
            Value::U8s(values) => self.sequence(values, u8::to_le_bytes),
            Value::U16s(values) => self.sequence(values, u16::to_le_bytes),
            Value::U32s(values) => self.sequence(values, u32::to_le_bytes),
            Value::F64s(values) => self.sequence(values, f64::to_le_bytes),
            Value::Pixels(values) => self.sequence(values.as_flattened(), f64::to_le_bytes),
            Value::Texts(texts) => {
                self.count(texts.len());
                for text in texts {
                    self.text(text);
                }
            }
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
        self.count(count);
        (0..count).for_each(|index| describe(index, self));
    }
}

/// The definition of a type, one line for each field, and those of its parts in the order in which they are first used.
struct Definition {
    ros: &'static str,
    fields: String,
    parts: Vec<(&'static str, String)>,
}

impl Definition {
    fn field(&mut self, of: &str, name: &str) {
        let _ = writeln!(self.fields, "{of} {name}");
    }

    /// Adds a part unless it is known.
    fn add(&mut self, of: &'static str, describe: &mut dyn FnMut(&mut dyn Fields)) {
        if self.parts.iter().any(|(known, _)| *known == of) {
            return;
        }
        let own = std::mem::take(&mut self.fields);
        let place = self.parts.len();
        self.parts.push((of, String::new()));
        describe(self);
        self.parts[place].1 = std::mem::replace(&mut self.fields, own);
    }
}

impl Fields for Definition {
    fn ros(&self) -> Option<&'static str> {
        Some(self.ros)
    }

    fn header(&mut self, _: Option<&str>) {
        self.part("header", "std_msgs/Header", &mut |fields| {
            fields.put("seq", 0_u32);
            fields.value("stamp", Value::Time(0));
            fields.put("frame_id", "");
        });
    }

    fn value(&mut self, name: &'static str, value: Value<'_>) {
        let of = match value {
            Value::Bool(_) => "bool",
            Value::U8(_) | Value::Word(..) => "uint8",
            Value::I8(_) => "int8",
            Value::U16(_) => "uint16",
            Value::U32(_) => "uint32",
            Value::U64(_) => "uint64",
            Value::F32(_) => "float32",
            Value::F64(_) => "float64",
            Value::Time(_) => "time",
            Value::Text(_) | Value::Frame(_) => "string",
            Value::Array(values) => return self.field(&format!("float64[{}]", values.len()), name),
            Value::U8s(_) => "uint8[]",
            Value::U16s(_) => "uint16[]",
            Value::U32s(_) => "uint32[]",
            Value::F64s(_) | Value::Pixels(_) => "float64[]",
            Value::Texts(_) => "string[]",
        };
        self.field(of, name);
    }

    fn part(&mut self, name: &'static str, of: &'static str, describe: &mut dyn FnMut(&mut dyn Fields)) {
        self.field(if of == "std_msgs/Header" { "Header" } else { of }, name);
        self.add(of, describe);
    }

    fn list(
        &mut self,
        name: &'static str,
        of: &'static str,
        count: usize,
        describe: &mut dyn FnMut(usize, &mut dyn Fields),
    ) {
        self.field(&format!("{of}[]"), name);
        if count > 0 {
            self.add(of, &mut |fields| describe(0, fields));
        }
    }

    fn constant(&mut self, of: &'static str, name: &'static str, value: i32) {
        let _ = writeln!(self.fields, "{of} {name}={value}");
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use md5::{Digest as _, Md5};

    use super::*;
    use crate::{Encoding, schema};

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
                let definition = Ros1Message { layout, ros }.definition();
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
                let mut all = Definition { ros: ros.name, fields: String::new(), parts: Vec::new() };
                let mut zeros = vec![0; layout.size];
                // The source of a RobotEvent.
                zeros[0] = ["kobuki_msgs/BumperEvent", "kobuki_msgs/CliffEvent", "kobuki_msgs/WheelDropEvent"]
                    .iter()
                    .position(|name| *name == ros.name)
                    .unwrap_or(0) as u8;
                layout.describe.unwrap()(&mut std::iter::once(&zeros[..]), &mut all).unwrap();
                let lines = ros.file.unwrap().lines().map(|line| line.split('#').next().unwrap().trim());
                let fields: Vec<_> = lines.filter(|line| !line.is_empty() && !line.contains('=')).collect();
                assert_eq!(all.fields.lines().collect::<Vec<_>>(), fields, "{}", ros.name);
            }
        }
    }

    #[test]
    fn parts_stand_once_behind_what_uses_them() {
        let line = "=".repeat(80);
        let twist = Ros1Message::of(Kind::VelocityCommand, "cmd_vel").unwrap().definition();
        let expected = format!(
            "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n{line}\nMSG: geometry_msgs/Vector3\nfloat64 \
             x\nfloat64 y\nfloat64 z"
        );
        assert_eq!(twist, expected);
        let odometry = Ros1Message::of(Kind::Odometry, "odom").unwrap().definition();
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
            Ros1Message::of(header.kind().unwrap(), topic).unwrap().write(&frame, &mut out).map(|()| out)
        };
        assert_eq!(write(&header, "events/bumper"), Some(vec![2, 1]));
        assert_eq!(write(&header, "events/cliff"), None);
        assert!(Ros1Message::of(Kind::RobotEvent, "events/horn").is_none());
        assert!(Ros1Message::of(Kind::Image, "image_raw").is_none());

        let mut header = FrameHeader::new(Kind::FluidPressure, Encoding::Struct);
        header.payload_len = header.set_packed(1, 1) as u64;
        header.stamp_ns = 4_294_967_295_999_999_999;
        assert_eq!(write(&header, "pressure").unwrap().len(), 4 + 8 + 4 + 16);
        header.stamp_ns += 1;
        assert_eq!(write(&header, "pressure"), None);
    }

    #[test]
    fn a_frame_of_another_kind_has_no_message() {
        let mut header = FrameHeader::new(Kind::MotorPower, Encoding::Struct);
        header.payload_len = header.set_packed(1, 1) as u64;
        let frame = FrameView::new(&header, &[1, 0, 0, 0]).unwrap();
        let mut out = Vec::new();
        assert_eq!(Ros1Message::of(Kind::MotorPower, "power").unwrap().write(&frame, &mut out), Some(()));
        assert_eq!(Ros1Message::of(Kind::Imu, "imu").unwrap().write(&frame, &mut out), None);
        assert_eq!(out, [1]);
    }
}
