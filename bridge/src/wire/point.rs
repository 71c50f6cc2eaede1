//! The points of clouds. Each layout is declared here once; the bytes of simulated clouds, the messages of ROS, the
//! files of data sets, `belvedere echo`, and the bindings for C and Python follow from it.

use bytemuck::Pod;

/// The type of a field of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Number {
    /// An unsigned number of 8 bits.
    U8,
    /// An unsigned number of 16 bits.
    U16,
    /// An unsigned number of 32 bits.
    U32,
    /// A number in single precision.
    F32,
    /// A number in double precision.
    F64,
    /// A colour: the bytes blue, green, red and 0. ROS and PCL name it a number in single precision.
    Colour,
}

impl Number {
    /// Returns the size in bytes.
    #[must_use]
    pub const fn size(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::U16 => 2,
            Self::U32 | Self::F32 | Self::Colour => 4,
            Self::F64 => 8,
        }
    }

    /// Returns the name of the constant in `sensor_msgs/PointField`.
    #[must_use]
    pub const fn ros_constant(self) -> &'static str {
        match self {
            Self::U8 => "UINT8",
            Self::U16 => "UINT16",
            Self::U32 => "UINT32",
            Self::F32 | Self::Colour => "FLOAT32",
            Self::F64 => "FLOAT64",
        }
    }
}

/// A field of a point.
#[derive(Clone, Copy, Debug)]
pub struct PointField {
    /// Its name in every language, and in ROS.
    pub name: &'static str,
    /// Lines of its Rust documentation.
    pub doc: &'static [&'static str],
    /// Its type.
    pub number: Number,
    /// Its offset in bytes.
    pub offset: usize,
}

impl PointField {
    /// Returns the bytes of the field in a point; `None` if the point is shorter.
    #[must_use]
    pub fn bytes<'a>(&self, point: &'a [u8]) -> Option<&'a [u8]> {
        point.get(self.offset..self.offset + self.number.size())
    }
}

/// The layout of a point. Bytes that belong to no field are 0.
#[derive(Clone, Copy, Debug)]
pub struct PointLayout {
    /// Its size in bytes.
    pub size: usize,
    /// Whether a cloud of one row has no points with NaN coordinates, which mean that there is no point.
    pub row_is_dense: bool,
    /// Its fields in the order of their offsets; the first three are x, y and z.
    pub fields: &'static [PointField],
}

impl PointLayout {
    /// Returns the field with this name.
    #[must_use]
    pub fn field(&self, name: &str) -> Option<&'static PointField> {
        self.fields.iter().find(|field| field.name == name)
    }
}

/// The type in Rust of a [`Number`].
trait Scalar: Pod {
    const NUMBER: Number;
}

macro_rules! scalars {
    ($($type:ty => $number:ident),+) => {
        $(impl Scalar for $type { const NUMBER: Number = Number::$number; })+
    };
}

scalars! { u8 => U8, u16 => U16, u32 => U32, f32 => F32, f64 => F64, [u8; 4] => Colour }

/// Defines points with the offsets of their fields, and describes them as data in `LAYOUT`.
macro_rules! points {
    ($(
        $(#[doc = $doc:literal])*
        pub struct $name:ident, $size:literal bytes, row_is_dense = $row_is_dense:literal {
            $($(#[doc = $field_doc:literal])* $field:ident: $type:ty = $offset:literal,)+
        }
    )+) => {$(
        $(#[doc = $doc])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $name { $($(#[doc = $field_doc])* pub $field: $type,)+ }

        impl $name {
            /// Its size in bytes.
            pub const SIZE: usize = $size;

            /// This layout as data.
            pub const LAYOUT: PointLayout = PointLayout {
                size: $size,
                row_is_dense: $row_is_dense,
                fields: &[$(
                    PointField {
                        name: stringify!($field),
                        doc: &[$($field_doc),*],
                        number: <$type as Scalar>::NUMBER,
                        offset: $offset,
                    },
                )+],
            };

            /// Returns the point as bytes.
            #[inline]
            #[must_use]
            pub fn to_bytes(self) -> [u8; $size] {
                let mut bytes = [0; $size];
                $(bytes[$offset..$offset + size_of::<$type>()].copy_from_slice(bytemuck::bytes_of(&self.$field));)+
                bytes
            }

            /// Reads a point out of its bytes.
            #[inline]
            #[must_use]
            pub fn from_bytes(bytes: &[u8; $size]) -> Self {
                Self {
                    $($field: bytemuck::pod_read_unaligned(&bytes[$offset..$offset + size_of::<$type>()]),)+
                }
            }

            /// Returns its coordinates.
            #[inline]
            #[must_use]
            pub const fn xyz(&self) -> [f32; 3] {
                [self.x, self.y, self.z]
            }
        }

        // Fields follow each other without an overlap.
        const _: () = {
            let PointLayout { size, fields, .. } = $name::LAYOUT;
            let (mut at, mut end) = (0, 0);
            while at < fields.len() {
                assert!(fields[at].offset >= end);
                end = fields[at].offset + fields[at].number.size();
                at += 1;
            }
            assert!(end <= size);
        };
    )+};
}

points! {
    /// A point with a colour, in PCL's layout of `pcl::PointXYZRGB`.
    pub struct XyzRgbPoint, 32 bytes, row_is_dense = false {
        /// Metres.
        x: f32 = 0,
        /// Metres.
        y: f32 = 4,
        /// Metres.
        z: f32 = 8,
        /// Blue, green, red, 0.
        rgb: [u8; 4] = 16,
    }

    /// A point in the layout of Velodyne's driver.
    pub struct XyzIrtPoint, 22 bytes, row_is_dense = true {
        /// Metres.
        x: f32 = 0,
        /// Metres.
        y: f32 = 4,
        /// Metres.
        z: f32 = 8,
        /// Intensity.
        intensity: f32 = 12,
        /// Number of the laser, counted from the lowest.
        ring: u16 = 16,
        /// Seconds after the stamp.
        time: f32 = 18,
    }

    /// A point of a lidar of gz-sim, in the layout of gz-sensors 9 and later.
    pub struct XyzIrPoint, 18 bytes, row_is_dense = false {
        /// Metres.
        x: f32 = 0,
        /// Metres.
        y: f32 = 4,
        /// Metres.
        z: f32 = 8,
        /// Intensity.
        intensity: f32 = 12,
        /// Number of the layer, counted from the first vertical angle.
        ring: u16 = 16,
    }

    /// A point in the layout of Ouster's driver.
    pub struct OusterPoint, 48 bytes, row_is_dense = false {
        /// Metres.
        x: f32 = 0,
        /// Metres.
        y: f32 = 4,
        /// Metres.
        z: f32 = 8,
        /// Intensity.
        intensity: f32 = 16,
        /// Nanoseconds after the stamp.
        t: u32 = 20,
        /// The intensity, limited to 255.
        reflectivity: u16 = 24,
        /// Number of the laser, counted from the highest.
        ring: u16 = 26,
        /// 0.
        ambient: u16 = 28,
        /// Millimetres from the axis; 0 for none.
        range: u32 = 32,
    }

    /// A point in the layout of Livox's driver.
    pub struct LivoxPoint, 26 bytes, row_is_dense = true {
        /// Metres.
        x: f32 = 0,
        /// Metres.
        y: f32 = 4,
        /// Metres.
        z: f32 = 8,
        /// Intensity, 0 to 255.
        intensity: f32 = 12,
        /// The number of the return in bits 4 and 5.
        tag: u8 = 16,
        /// Number of the laser.
        line: u8 = 17,
        /// Nanoseconds since time 0.
        timestamp: f64 = 18,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Encoding;

    /// Returns the word for a type in WIRE.md.
    fn word(number: Number) -> &'static str {
        match number {
            Number::U8 => "u8",
            Number::U16 => "u16",
            Number::U32 => "u32",
            Number::F32 => "f32",
            Number::F64 => "f64",
            Number::Colour => "four bytes",
        }
    }

    #[test]
    fn layouts_are_those_of_wire_md() {
        let (_, table) = include_str!("../../WIRE.md").split_once("## Encodings").unwrap();
        let mut count = 0;
        for encoding in Encoding::ALL {
            let Some(point) = encoding.point() else { continue };
            let row = table.lines().find(|line| line.contains(&format!("| {encoding} |"))).unwrap();
            assert!(row.contains(&format!("| {} bytes: ", point.size)), "{row}");
            // A type stands before the first of the fields that have it: "f32 x 0, y 4, u16 ring 16".
            let words: Vec<&str> = row.split([' ', ',', ';']).filter(|word| !word.is_empty()).collect();
            let (mut of, mut found) = ("", Vec::new());
            for pair in words.windows(2) {
                if ["u8", "u16", "u32", "f32", "f64"].contains(&pair[0]) {
                    of = pair[0];
                } else if let (Some(field), Ok(offset)) = (point.field(pair[0]), pair[1].parse::<usize>()) {
                    let of = if field.number == Number::Colour { "four bytes" } else { of };
                    found.push((of, pair[0], offset));
                }
            }
            let fields = point.fields.iter().map(|field| (word(field.number), field.name, field.offset));
            assert_eq!(found, fields.collect::<Vec<_>>(), "{row}");
            count += 1;
        }
        assert_eq!(count, 5);
    }

    #[test]
    fn bytes_are_at_the_offsets_and_the_rest_is_0() {
        let point = OusterPoint {
            x: 1.0,
            y: 2.0,
            z: 3.0,
            intensity: 4.0,
            t: 5,
            reflectivity: 6,
            ring: 7,
            ambient: 8,
            range: 9,
        };
        let bytes = point.to_bytes();
        let mut expected = [0; 48];
        for (at, value) in [(0, 1.0_f32), (4, 2.0), (8, 3.0), (16, 4.0)] {
            expected[at..at + 4].copy_from_slice(&value.to_le_bytes());
        }
        for (at, value) in [(20, 5), (24, 6), (26, 7), (28, 8), (32, 9)] {
            expected[at] = value;
        }
        assert_eq!(bytes, expected);
        assert_eq!(OusterPoint::from_bytes(&bytes), point);
    }
}
