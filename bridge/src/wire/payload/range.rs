//! What a rangefinder measures.

use super::Message;
use crate::wire::{Kind, layout::wire_structs};

wire_structs! {
    /// One distance, as `sensor_msgs/Range` has it: to the nearest thing within the field of view.
    with #[derive(PartialEq)]
    pub struct Range, 20 bytes, of [Kind::Range] {
        /// 0 ultrasound, 1 infrared.
        pub radiation_type: u32 = 0,
        /// Full angle of the cone that is measured in, radians.
        pub field_of_view: f32 = 4,
        /// Metres: nothing nearer is measured.
        pub min_range: f32 = 8,
        /// Metres: nothing farther is measured.
        pub max_range: f32 = 12,
        /// Metres; −inf too near, +inf nothing in range (REP-117), or as the simulator's description of it says.
        pub range: f32 = 16,
    }
}

impl Range {
    /// Radiation: sound.
    pub const ULTRASOUND: u32 = 0;
    /// Radiation: infrared light.
    pub const INFRARED: u32 = 1;
}
