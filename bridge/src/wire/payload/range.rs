//! The measurement of a rangefinder.

use super::Message;
use crate::wire::{Kind, layout::wire_structs};

wire_structs! {
    /// A distance to the nearest surface within the field of view, as in `sensor_msgs/Range`.
    with #[derive(PartialEq)]
    pub struct Range, 20 bytes, of [Kind::Range] {
        /// 0 ultrasound, 1 infrared.
        pub radiation_type: u32 = 0,
        /// Full angle of the measured cone, radians.
        pub field_of_view: f32 = 4,
        /// Smallest measured distance, metres.
        pub min_range: f32 = 8,
        /// Largest measured distance, metres.
        pub max_range: f32 = 12,
        /// The distance, metres. Out of range: −inf too near, +inf nothing in range (REP-117), unless the sensor's
        /// description specifies other values.
        pub range: f32 = 16,
    }
}

impl Range {
    /// Radiation: sound.
    pub const ULTRASOUND: u32 = 0;
    /// Radiation: infrared light.
    pub const INFRARED: u32 = 1;
}
