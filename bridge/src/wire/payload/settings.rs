//! What of a sensor can be changed while it runs.

use super::Message;
use crate::wire::{Kind, Text, layout::wire_structs};

wire_structs! {
    /// A number that can be set; all three are NaN where a sensor has no such setting.
    with #[derive(PartialEq)]
    pub struct Setting, 24 bytes {
        /// What it is.
        pub value: f64 = 0,
        /// The least that it may be.
        pub min: f64 = 8,
        /// The most that it may be.
        pub max: f64 = 16,
    }

    /// The settings of one sensor, under the names by which the operation [`Configure`](crate::Operation::Configure)
    /// changes them.
    with #[derive(PartialEq)]
    pub struct SensorSettings, 1696 bytes, of [Kind::SensorSettings] {
        /// The sensor's name in the robot's description.
        pub name: Text<64> = 0,
        /// The streams that it sends, without leading slashes; the rest is empty.
        pub topics: [Text<256>; 6] = 64,
        /// Frames per second.
        pub update_rate: Setting = 1600,
        /// Mean of the noise: of colours in [0, 1] for a camera, of ranges in metres for a lidar.
        pub noise_mean: Setting = 1624,
        /// Its standard deviation, in the same unit.
        pub noise_stddev: Setting = 1648,
        /// Exposure of a camera: the share of the light that its description gives it, 1 as described.
        pub exposure: Setting = 1672,
    }
}

impl Setting {
    /// What a sensor has not.
    pub const NONE: Self = Self { value: f64::NAN, min: f64::NAN, max: f64::NAN };
}

impl SensorSettings {
    /// The settings with their names.
    #[must_use]
    pub fn by_name(&self) -> [(&'static str, Setting); 4] {
        [
            ("update_rate", self.update_rate),
            ("noise_mean", self.noise_mean),
            ("noise_stddev", self.noise_stddev),
            ("exposure", self.exposure),
        ]
    }

    /// The streams that it sends.
    pub fn topics(&self) -> impl Iterator<Item = &str> {
        self.topics.iter().map(Text::as_str).filter(|topic| !topic.is_empty())
    }
}
