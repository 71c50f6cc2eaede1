//! What a rangefinder measures.

use std::mem::{offset_of, size_of};

use bytemuck::{Pod, Zeroable};

use super::Message;
use crate::wire::Kind;

/// One distance, as `sensor_msgs/Range` has it: to the nearest thing within the field of view.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Range {
    /// [`Range::ULTRASOUND`] or [`Range::INFRARED`].
    pub radiation_type: u32,
    /// Full angle of the cone that is measured in, radians.
    pub field_of_view: f32,
    /// Metres: nothing nearer is measured.
    pub min_range: f32,
    /// Metres: nothing farther is measured.
    pub max_range: f32,
    /// Metres; −inf too near, +inf nothing in range (REP-117), or as the simulator's description of it says.
    pub range: f32,
}

impl Range {
    /// Radiation: sound.
    pub const ULTRASOUND: u32 = 0;
    /// Radiation: infrared light.
    pub const INFRARED: u32 = 1;
}

impl Message for Range {
    const KINDS: &'static [Kind] = &[Kind::Range];
}

// The wire format, as in `payload.rs`.
const _: () = {
    assert!(size_of::<Range>() == 20);
    assert!(offset_of!(Range, radiation_type) == 0);
    assert!(offset_of!(Range, field_of_view) == 4);
    assert!(offset_of!(Range, min_range) == 8);
    assert!(offset_of!(Range, max_range) == 12);
    assert!(offset_of!(Range, range) == 16);
};
