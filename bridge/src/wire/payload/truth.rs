//! What is true of the things in a picture.

use super::Message;
use crate::wire::{Kind, Text, layout::wire_structs};

wire_structs! {
    /// What is seen of a thing, and where all of it is. Its pose is in the optical frame of the sensor (x right, y down, z
    /// forward) at the header's stamp.
    with #[derive(PartialEq)]
    pub struct BoundingBox, 112 bytes, of [Kind::BoundingBoxes] {
        /// Its number, as in the picture of instances.
        pub instance: u32 = 0,
        /// Its class, as in the picture of classes.
        pub label: u32 = 4,
        /// How many pixels show it.
        pub pixels: u32 = 8,
        /// First column and row of these.
        pub min: [u32; 2] = 12,
        /// Last column and row, themselves seen.
        pub max: [u32; 2] = 20,
        /// 0.
        pub reserved: u32 = 28,
        /// Middle of the box that holds the whole of it, along its own axes; metres.
        pub position: [f64; 3] = 32,
        /// x y z w.
        pub orientation: [f64; 4] = 56,
        /// Edges of that box; metres.
        pub size: [f64; 3] = 88,
    }

    /// Where a tag is seen: one of which a corner is in the picture with nothing in front of it. Its pose is in the optical
    /// frame of the sensor (x right, y down, z forward) at the header's stamp; the tag's own x is to the right and y up as one
    /// reads it, z towards the reader, as in OpenCV's `ArUco`.
    with #[derive(PartialEq)]
    pub struct TagDetection, 168 bytes, of [Kind::TagDetections] {
        /// As the file says: `tag36h11`, `qr`.
        pub family: Text<32> = 0,
        /// Its number in the family.
        pub id: u32 = 32,
        /// For each corner 1 if it is in the picture and nothing hides it, else 0.
        pub visible: [u8; 4] = 36,
        /// Edge of its square without the white margin; metres.
        pub size: f64 = 40,
        /// Column and row of each corner, centres of pixels at integers: top left, top right, bottom right, bottom left as one
        /// reads it (OpenCV's `ArUco`), when the row is taken. NaN where no pixel of the lens sees in that direction.
        pub corners: [[f64; 2]; 4] = 48,
        /// Its middle; metres.
        pub position: [f64; 3] = 112,
        /// x y z w.
        pub orientation: [f64; 4] = 136,
    }
}
