//! The device behind a camera's lens.

use belvedere_sensors::device::{AutoExposureConfig, DeviceConfig, Metering};

/// `<device>` of a `<camera>`, our extension: how light becomes an image, and when it is collected.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraDevice {
    /// Sensor and electronics.
    pub config: DeviceConfig,
    /// Seconds from the reading of the first row to that of the last; 0 for a global shutter.
    pub readout_time_s: f64,
    /// Samples of the exposure that are averaged; 1 for an image of the instant at which it is read.
    pub motion_blur_samples: u32,
    /// Automatic control of exposure time and gain, if it is on.
    pub auto_exposure: Option<AutoExposed>,
}

/// `<auto_exposure>`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AutoExposed {
    /// Target and limits.
    pub config: AutoExposureConfig,
    /// How the brightness of a frame is measured.
    pub metering: Metering,
}

impl CameraDevice {
    /// Returns true if all of an image shows the same instant.
    pub fn is_of_one_moment(&self) -> bool {
        self.readout_time_s == 0.0 && self.motion_blur_samples == 1
    }

    /// Returns the longest exposure time of an image, in seconds.
    pub fn longest_exposure_s(&self) -> f64 {
        let own = self.config.exposure.time_s;
        self.auto_exposure.map_or(own, |automatic| own.max(automatic.config.time_range_s[1]))
    }

    /// Returns how long before its timestamp the first light of an image may be collected, in seconds.
    pub fn window_s(&self) -> f64 {
        let exposure_s = if self.motion_blur_samples > 1 { self.longest_exposure_s() } else { 0.0 };
        self.readout_time_s + exposure_s
    }
}
