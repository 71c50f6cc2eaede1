//! What is true of the things in a picture.

use std::mem::{offset_of, size_of};

use bytemuck::{Pod, Zeroable};

use super::Message;
use crate::wire::{Kind, Text};

/// What is seen of a thing, and where all of it is. Its pose is in the optical frame of the sensor (x right, y down, z
/// forward) at the header's stamp.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct BoundingBox {
    /// Its number, as in the picture of instances.
    pub instance: u32,
    /// Its class, as in the picture of classes.
    pub label: u32,
    /// How many pixels show it.
    pub pixels: u32,
    /// First column and row of these.
    pub min: [u32; 2],
    /// Last column and row, themselves seen.
    pub max: [u32; 2],
    /// 0.
    pub reserved: u32,
    /// Middle of the box that holds the whole of it, along its own axes; metres.
    pub position: [f64; 3],
    /// x y z w.
    pub orientation: [f64; 4],
    /// Edges of that box; metres.
    pub size: [f64; 3],
}

/// Where a tag is seen: one of which a corner is in the picture with nothing in front of it. Its pose is in the optical
/// frame of the sensor (x right, y down, z forward) at the header's stamp; the tag's own x is to the right and y up as one
/// reads it, z towards the reader, as in OpenCV's `ArUco`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct TagDetection {
    /// As the file says: `tag36h11`, `qr`.
    pub family: Text<32>,
    /// Its number in the family.
    pub id: u32,
    /// For each corner 1 if it is in the picture and nothing hides it, else 0.
    pub visible: [u8; 4],
    /// Edge of its square without the white margin; metres.
    pub size: f64,
    /// Column and row of each corner, centres of pixels at integers: top left, top right, bottom right, bottom left as one
    /// reads it (OpenCV's `ArUco`), when the row is taken. NaN where no pixel of the lens sees in that direction.
    pub corners: [[f64; 2]; 4],
    /// Its middle; metres.
    pub position: [f64; 3],
    /// x y z w.
    pub orientation: [f64; 4],
}

impl Message for BoundingBox {
    const KINDS: &'static [Kind] = &[Kind::BoundingBoxes];
}
impl Message for TagDetection {
    const KINDS: &'static [Kind] = &[Kind::TagDetections];
}

// The wire format, as in `payload.rs`.
const _: () = {
    assert!(size_of::<BoundingBox>() == 112);
    assert!(offset_of!(BoundingBox, instance) == 0);
    assert!(offset_of!(BoundingBox, label) == 4);
    assert!(offset_of!(BoundingBox, pixels) == 8);
    assert!(offset_of!(BoundingBox, min) == 12);
    assert!(offset_of!(BoundingBox, max) == 20);
    assert!(offset_of!(BoundingBox, reserved) == 28);
    assert!(offset_of!(BoundingBox, position) == 32);
    assert!(offset_of!(BoundingBox, orientation) == 56);
    assert!(offset_of!(BoundingBox, size) == 88);

    assert!(size_of::<TagDetection>() == 168);
    assert!(offset_of!(TagDetection, family) == 0);
    assert!(offset_of!(TagDetection, id) == 32);
    assert!(offset_of!(TagDetection, visible) == 36);
    assert!(offset_of!(TagDetection, size) == 40);
    assert!(offset_of!(TagDetection, corners) == 48);
    assert!(offset_of!(TagDetection, position) == 112);
    assert!(offset_of!(TagDetection, orientation) == 136);
};
