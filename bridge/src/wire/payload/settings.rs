//! What of a sensor can be changed while it runs.

use std::mem::{offset_of, size_of};

use bytemuck::{Pod, Zeroable};

use super::Message;
use crate::wire::{Kind, Text};

/// A number that can be set; all three are NaN where a sensor has no such setting.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Setting {
    /// What it is.
    pub value: f64,
    /// The least that it may be.
    pub min: f64,
    /// The most that it may be.
    pub max: f64,
}

impl Setting {
    /// What a sensor has not.
    pub const NONE: Self = Self { value: f64::NAN, min: f64::NAN, max: f64::NAN };
}

/// The settings of one sensor, under the names by which the operation [`Configure`](crate::Operation::Configure)
/// changes them.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct SensorSettings {
    /// The sensor's name in the robot's description.
    pub name: Text<64>,
    /// The streams that it sends, without leading slashes; the rest is empty.
    pub topics: [Text<256>; 6],
    /// Frames per second.
    pub update_rate: Setting,
    /// Mean of the noise: of colours in [0, 1] for a camera, of ranges in metres for a lidar.
    pub noise_mean: Setting,
    /// Its standard deviation, in the same unit.
    pub noise_stddev: Setting,
    /// Exposure of a camera: the share of the light that its description gives it, 1 as described.
    pub exposure: Setting,
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

impl Message for SensorSettings {
    const KINDS: &'static [Kind] = &[Kind::SensorSettings];
}

// The wire format, as in `payload.rs`.
const _: () = {
    assert!(size_of::<Setting>() == 24);
    assert!(offset_of!(Setting, value) == 0);
    assert!(offset_of!(Setting, min) == 8);
    assert!(offset_of!(Setting, max) == 16);

    assert!(size_of::<SensorSettings>() == 1696);
    assert!(offset_of!(SensorSettings, name) == 0);
    assert!(offset_of!(SensorSettings, topics) == 64);
    assert!(offset_of!(SensorSettings, update_rate) == 1600);
    assert!(offset_of!(SensorSettings, noise_mean) == 1624);
    assert!(offset_of!(SensorSettings, noise_stddev) == 1648);
    assert!(offset_of!(SensorSettings, exposure) == 1672);
};
