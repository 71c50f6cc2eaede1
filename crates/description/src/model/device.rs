//! The device behind a camera's lens.

use belvedere_sensors::device::{AutoExposureConfig, DeviceConfig, Metering};

/// `<device>` of a `<camera>`, which is ours: what becomes of the light, and when it is collected.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraDevice {
    /// Sensor and electronics.
    pub config: DeviceConfig,
    /// Seconds from the reading of the first row to that of the last; 0 for a global shutter.
    pub readout_time_s: f64,
    /// Moments of the exposure whose light is averaged; 1 for a picture of the moment in which it is read.
    pub motion_blur_samples: u32,
    /// How time of exposure and gain follow the pictures, if they do.
    pub auto_exposure: Option<AutoExposed>,
}

/// `<auto_exposure>`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AutoExposed {
    /// Target and limits.
    pub config: AutoExposureConfig,
    /// What a frame is metered by.
    pub metering: Metering,
}

impl CameraDevice {
    /// Whether all of a picture is of one moment.
    pub fn is_of_one_moment(&self) -> bool {
        self.readout_time_s == 0.0 && self.motion_blur_samples == 1
    }

    /// The longest time of exposure that a picture may have, in seconds.
    pub fn longest_exposure_s(&self) -> f64 {
        let own = self.config.exposure.time_s;
        self.auto_exposure.map_or(own, |automatic| own.max(automatic.config.time_range_s[1]))
    }

    /// How long before its stamp the first light of a picture may be collected, in seconds.
    pub fn window_s(&self) -> f64 {
        let exposure_s = if self.motion_blur_samples > 1 { self.longest_exposure_s() } else { 0.0 };
        self.readout_time_s + exposure_s
    }
}
