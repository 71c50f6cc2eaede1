//! The settings of sensors that can be changed while the simulation runs.

use super::{Message, each};
use crate::wire::{
    Kind, Text,
    fields::{Describe, Fields},
    layout::wire_structs,
};

wire_structs! {
    /// The value and limits of a setting; all three are NaN if the sensor does not have the setting.
    with #[derive(PartialEq)]
    pub struct Setting, 24 bytes {
        /// The current value.
        pub value: f64 = 0,
        /// The smallest allowed value.
        pub min: f64 = 8,
        /// The largest allowed value.
        pub max: f64 = 16,
    }

    /// The settings of one sensor, under the names by which the operation [`Configure`](crate::Operation::Configure)
    /// changes them.
    with #[derive(PartialEq)]
    pub struct SensorSettings, 1696 bytes, of [Kind::SensorSettings] {
        /// The sensor's name in the robot's description.
        pub name: Text<64> = 0,
        /// The topics that it publishes, without leading slashes; unused entries are empty.
        pub topics: [Text<256>; 6] = 64,
        /// Frames per second.
        pub update_rate: Setting = 1600,
        /// Mean of the noise: of colours in [0, 1] for a camera, of ranges in metres for a lidar.
        pub noise_mean: Setting = 1624,
        /// Standard deviation of the noise, in the same unit.
        pub noise_stddev: Setting = 1648,
        /// Exposure of a camera, relative to its description: 1 is as described.
        pub exposure: Setting = 1672,
    }
}

impl Setting {
    /// The value of a setting that a sensor does not have.
    pub const NONE: Self = Self { value: f64::NAN, min: f64::NAN, max: f64::NAN };
}

impl SensorSettings {
    /// Returns the settings with their names.
    #[must_use]
    pub fn by_name(&self) -> [(&'static str, Setting); 4] {
        [
            ("update_rate", self.update_rate),
            ("noise_mean", self.noise_mean),
            ("noise_stddev", self.noise_stddev),
            ("exposure", self.exposure),
        ]
    }

    /// Returns the topics that the sensor publishes.
    pub fn topics(&self) -> impl Iterator<Item = &str> {
        self.topics.iter().map(Text::as_str).filter(|topic| !topic.is_empty())
    }
}

impl Describe for SensorSettings {
    /// Settings that the sensor does not have are left out.
    fn describe(&self, fields: &mut dyn Fields) -> Option<()> {
        let topics: Vec<&str> = self.topics().collect();
        fields.put("name", self.name.as_str());
        fields.put("topics", &topics[..]);
        for (name, Setting { value, min, max }) in self.by_name() {
            if !value.is_nan() {
                fields.part(name, "belvedere/Setting", &mut |fields| {
                    fields.put("value", value);
                    fields.put("min", min);
                    fields.put("max", max);
                });
            }
        }
        Some(())
    }

    fn describe_all(messages: &[Self], fields: &mut dyn Fields) -> Option<()> {
        each("sensors", "belvedere/SensorSettings", messages, fields)
    }
}
