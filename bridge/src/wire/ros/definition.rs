//! The definition of a message's type.

use std::fmt::Write as _;

use super::{Ros, RosPrimitive};
use crate::wire::fields::{Fields, Value};

/// The definition of a type, one line for each field, and those of its parts in the order in which they are first used.
pub(super) struct Definition {
    ros: Ros,
    /// The type's name in ROS 1.
    name: &'static str,
    fields: String,
    parts: Vec<(&'static str, String)>,
}

impl Definition {
    /// A definition without fields, of the type of this name in ROS 1.
    pub(super) fn new(ros: Ros, name: &'static str) -> Self {
        Self { ros, name, fields: String::new(), parts: Vec::new() }
    }

    /// Returns the definition of the type itself.
    #[cfg(test)]
    pub(super) fn own(&self) -> &str {
        &self.fields
    }

    /// Replaces the definition of the type itself by that of a file for ROS 1.
    pub(super) fn set_own(&mut self, file: &str) {
        self.fields = match self.ros {
            Ros::One => file.to_owned(),
            // Only ROS 1 knows the header without its package.
            Ros::Two => file.replace("\nHeader header\n", "\nstd_msgs/Header header\n"),
        };
    }

    /// Returns the definition followed by those of its parts.
    pub(super) fn text(self) -> String {
        let mut text = self.fields.trim_end().to_owned();
        for (name, fields) in self.parts {
            let _ = write!(text, "\n{}\nMSG: {name}\n{}", "=".repeat(80), fields.trim_end());
        }
        text
    }

    /// Adds a field. Names of ROS 2 have no capital letters.
    fn field(&mut self, of: &str, name: &str) {
        let _ = match self.ros {
            Ros::One => writeln!(self.fields, "{of} {name}"),
            Ros::Two => writeln!(self.fields, "{of} {}", name.to_lowercase()),
        };
    }

    fn time(&mut self, name: &str) {
        if self.ros == Ros::One {
            return self.field("time", name);
        }
        let of = "builtin_interfaces/Time";
        self.field(of, name);
        self.add(of, &mut |time| time.fields.push_str("int32 sec\nuint32 nanosec\n"));
    }

    /// Adds a part unless it is known.
    fn add(&mut self, of: &'static str, describe: &mut dyn FnMut(&mut Self)) {
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
        Some(self.name)
    }

    fn is_ros2(&self) -> bool {
        self.ros == Ros::Two
    }

    fn header(&mut self, _: Option<&str>) {
        let of = "std_msgs/Header";
        self.field(if self.ros == Ros::One { "Header" } else { of }, "header");
        self.add(of, &mut |header| {
            if header.ros == Ros::One {
                header.field(RosPrimitive::Uint32.word(), "seq");
            }
            header.time("stamp");
            header.field(RosPrimitive::String.word(), "frame_id");
        });
    }

    fn value(&mut self, name: &'static str, value: Value<'_>) {
        let (of, list) = match value {
            Value::Bool(_) => (RosPrimitive::Bool, ""),
            Value::U8(_) | Value::Word(..) => (RosPrimitive::Uint8, ""),
            Value::I8(_) => (RosPrimitive::Int8, ""),
            Value::U16(_) => (RosPrimitive::Uint16, ""),
            Value::U32(_) => (RosPrimitive::Uint32, ""),
            Value::U64(_) => (RosPrimitive::Uint64, ""),
            Value::F32(_) => (RosPrimitive::Float32, ""),
            Value::F64(_) => (RosPrimitive::Float64, ""),
            Value::Time(_) => return self.time(name),
            Value::Text(_) | Value::Frame(_) => (RosPrimitive::String, ""),
            Value::Array(values) => {
                return self.field(&format!("{}[{}]", RosPrimitive::Float64.word(), values.len()), name);
            }
            Value::U8s(_) => (RosPrimitive::Uint8, "[]"),
            Value::U16s(_) => (RosPrimitive::Uint16, "[]"),
            Value::U32s(_) => (RosPrimitive::Uint32, "[]"),
            Value::F32s(_) => (RosPrimitive::Float32, "[]"),
            Value::F64s(_) | Value::Pixels(_) => (RosPrimitive::Float64, "[]"),
            Value::Texts(_) => (RosPrimitive::String, "[]"),
        };
        self.field(&format!("{}{list}", of.word()), name);
    }

    fn part(&mut self, name: &'static str, of: &'static str, describe: &mut dyn FnMut(&mut dyn Fields)) {
        self.field(of, name);
        self.add(of, &mut |part| describe(part));
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
            self.add(of, &mut |part| describe(0, part));
        }
    }

    fn constant(&mut self, of: &'static str, name: &'static str, value: i32) {
        let _ = writeln!(self.fields, "{of} {name}={value}");
    }
}
