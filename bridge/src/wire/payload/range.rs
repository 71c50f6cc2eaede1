//! The measurement of a rangefinder.

use super::Message;
use crate::wire::{
    Kind,
    fields::{Describe, Fields, RosType, Value},
    layout::wire_structs,
};

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

impl Describe for Range {
    const ROS: &'static [RosType] = &[RosType::new("sensor_msgs/Range", "c005c34273dc426c67a020a87bc24148")];

    fn describe(&self, fields: &mut dyn Fields) -> Option<()> {
        fields.constant("uint8", "ULTRASOUND", 0);
        fields.constant("uint8", "INFRARED", 1);
        fields.header(None);
        let radiation = match self.radiation_type {
            Self::ULTRASOUND => Value::Word(0, "ultrasound"),
            Self::INFRARED => Value::Word(1, "infrared"),
            _ => Value::Word(1, "unknown"),
        };
        fields.value("radiation_type", radiation);
        fields.put("field_of_view", self.field_of_view);
        fields.put("min_range", self.min_range);
        fields.put("max_range", self.max_range);
        fields.put("range", self.range);
        if fields.is_ros2() {
            // Unknown. Before Iron, ROS 2 has no such field and ignores it.
            fields.put("variance", 0.0_f32);
        }
        Some(())
    }
}
