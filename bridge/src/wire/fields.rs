//! The values of a message by name. A struct describes itself once, and each encoding is an implementation of
//! [`Fields`]: the bytes and the definition of ROS 1 and ROS 2, and what `belvedere echo` prints.

use bytemuck::Pod;

/// A value of a message.
#[derive(Clone, Copy, Debug)]
pub enum Value<'a> {
    /// True or false.
    Bool(bool),
    /// A number of 8 bits.
    U8(u8),
    /// A signed number of 8 bits.
    I8(i8),
    /// A number of 16 bits.
    U16(u16),
    /// A number of 32 bits.
    U32(u32),
    /// A number of 64 bits.
    U64(u64),
    /// A number in single precision.
    F32(f32),
    /// A number in double precision.
    F64(f64),
    /// A number of 8 bits, for which people read a word.
    Word(u8, &'a str),
    /// A time in nanoseconds.
    Time(u64),
    /// A text.
    Text(&'a str),
    /// The name of a coordinate frame.
    Frame(&'a str),
    /// Numbers whose count is part of the type.
    Array(&'a [f64]),
    /// Any number of bytes.
    U8s(&'a [u8]),
    /// Any number of numbers of 16 bits.
    U16s(&'a [u16]),
    /// Any number of numbers of 32 bits.
    U32s(&'a [u32]),
    /// Any number of numbers in single precision.
    F32s(&'a [f32]),
    /// Any number of numbers in double precision.
    F64s(&'a [f64]),
    /// Any number of points in an image.
    Pixels(&'a [[f64; 2]]),
    /// Any number of texts.
    Texts(&'a [&'a str]),
}

macro_rules! values {
    ($($type:ty => $value:ident),+) => {
        $(impl<'a> From<$type> for Value<'a> {
            fn from(value: $type) -> Self { Self::$value(value) }
        })+
    };
}

values! {
    bool => Bool, u8 => U8, i8 => I8, u16 => U16, u32 => U32, u64 => U64, f32 => F32, f64 => F64, &'a str => Text,
    &'a [u8] => U8s, &'a [u16] => U16s, &'a [u32] => U32s, &'a [f32] => F32s, &'a [f64] => F64s, &'a [[f64; 2]] => Pixels,
    &'a [&'a str] => Texts
}

impl<'a, const N: usize> From<&'a [f64; N]> for Value<'a> {
    fn from(values: &'a [f64; N]) -> Self {
        Self::Array(values)
    }
}

/// A reader of the values of a message, which come in the order of its ROS type and under the names of its fields in
/// ROS 1.
pub trait Fields {
    /// Returns the ROS type that is written, by its name in ROS 1; `None` if the values are for people.
    fn ros(&self) -> Option<&'static str>;

    /// Returns true if the message is of ROS 2, for the few types that have other fields there.
    fn is_ros2(&self) -> bool {
        false
    }

    /// Takes a `std_msgs/Header` with the frame's stamp: that of the whole message, or one with another frame id.
    fn header(&mut self, frame_id: Option<&str>);

    /// Takes a value.
    fn value(&mut self, name: &'static str, value: Value<'_>);

    /// Takes a field that is a message of the type `of`, whose values `describe` passes.
    fn part(&mut self, name: &'static str, of: &'static str, describe: &mut dyn FnMut(&mut dyn Fields));

    /// Takes an array of `count` messages of the type `of`.
    fn list(
        &mut self,
        name: &'static str,
        of: &'static str,
        count: usize,
        describe: &mut dyn FnMut(usize, &mut dyn Fields),
    );

    /// Takes a constant of the ROS type, which is in its definition and in no message.
    fn constant(&mut self, of: &'static str, name: &'static str, value: i32) {
        let _ = (of, name, value);
    }
}

impl dyn Fields + '_ {
    /// Passes a value.
    pub fn put<'v>(&mut self, name: &'static str, value: impl Into<Value<'v>>) {
        self.value(name, value.into());
    }

    /// Passes a `geometry_msgs/Vector3`.
    pub fn vector(&mut self, name: &'static str, xyz: [f64; 3]) {
        self.part(name, "geometry_msgs/Vector3", &mut |fields| fields.numbers(["x", "y", "z"], xyz));
    }

    /// Passes a `geometry_msgs/Point`.
    pub fn point(&mut self, name: &'static str, xyz: [f64; 3]) {
        self.part(name, "geometry_msgs/Point", &mut |fields| fields.numbers(["x", "y", "z"], xyz));
    }

    /// Passes a `geometry_msgs/Quaternion`.
    pub fn quaternion(&mut self, name: &'static str, xyzw: [f64; 4]) {
        self.part(name, "geometry_msgs/Quaternion", &mut |fields| {
            fields.numbers(["x", "y", "z", "w"], xyzw);
        });
    }

    /// Passes a `geometry_msgs/Pose`.
    pub fn pose(&mut self, name: &'static str, position: [f64; 3], orientation: [f64; 4]) {
        self.part(name, "geometry_msgs/Pose", &mut |fields| {
            fields.point("position", position);
            fields.quaternion("orientation", orientation);
        });
    }

    /// Passes a `geometry_msgs/Twist`.
    pub fn twist(&mut self, name: &'static str, linear: [f64; 3], angular: [f64; 3]) {
        self.part(name, "geometry_msgs/Twist", &mut |fields| {
            fields.vector("linear", linear);
            fields.vector("angular", angular);
        });
    }

    fn numbers<const N: usize>(&mut self, names: [&'static str; N], values: [f64; N]) {
        names.into_iter().zip(values).for_each(|(name, value)| self.put(name, value));
    }
}

/// A payload struct that describes the message it stands for.
pub trait Describe: Pod {
    /// The types of ROS that streams of the struct are published as; empty if ROS has none.
    const ROS: &'static [RosType] = &[];

    /// Passes the values of one struct, for kinds that carry one.
    ///
    /// `None` if the type of ROS that `fields` writes cannot hold them.
    fn describe(&self, fields: &mut dyn Fields) -> Option<()>;

    /// Passes the values of a whole payload. Kinds that carry an array implement this.
    fn describe_all(messages: &[Self], fields: &mut dyn Fields) -> Option<()> {
        messages.first()?.describe(fields)
    }
}

/// [`Describe`] for the rows of a payload whose kind is known only at run time.
pub(super) type DescribeRows = fn(&mut dyn Iterator<Item = &[u8]>, &mut dyn Fields) -> Option<()>;

/// Passes the values of a payload whose rows begin with a `T` each.
pub(super) fn describe_rows<T: Describe>(
    rows: &mut dyn Iterator<Item = &[u8]>,
    fields: &mut dyn Fields,
) -> Option<()> {
    let messages: Vec<T> = rows.map(|row| bytemuck::pod_read_unaligned(&row[..size_of::<T>()])).collect();
    T::describe_all(&messages, fields)
}

/// A type of message of ROS 1, from which that of ROS 2 follows.
#[derive(Debug)]
pub struct RosType {
    /// `package/Type`.
    pub name: &'static str,
    /// The sum of its definition in ROS 1, as `rosmsg md5` prints it.
    pub md5: &'static str,
    /// The last word of the topics that have this type, if a kind has several; otherwise empty.
    pub(super) topic: &'static str,
    /// The definition in ROS 1, if it is in a file; otherwise it follows from the described values.
    pub(super) file: Option<&'static str>,
}

impl RosType {
    /// A type whose definition follows from the described values.
    pub(super) const fn new(name: &'static str, md5: &'static str) -> Self {
        Self { name, md5, topic: "", file: None }
    }

    /// A type with a file of its definition.
    pub(super) const fn in_file(name: &'static str, md5: &'static str, file: &'static str) -> Self {
        Self { name, md5, topic: "", file: Some(file) }
    }

    /// The same for topics that end in this word.
    pub(super) const fn of_topic(self, topic: &'static str) -> Self {
        Self { topic, ..self }
    }
}
