//! Camera devices with published figures. Figures that no data sheet gives are marked as assumed where they are set.

mod machine_vision;
mod raspberry_pi;
mod webcam;

use super::DeviceConfig;
pub use machine_vision::machine_vision;
pub use raspberry_pi::raspberry_pi_hq;
pub use webcam::webcam;

/// A camera device with a name.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct DevicePreset {
    /// The name by which configuration files refer to the preset.
    pub name: &'static str,
    config: fn() -> DeviceConfig,
}

impl DevicePreset {
    /// Returns the configuration of the device.
    #[must_use]
    pub fn config(&self) -> DeviceConfig {
        (self.config)()
    }
}

/// All presets.
pub const ALL: &[DevicePreset] = &[
    DevicePreset { name: "webcam", config: webcam },
    DevicePreset { name: "machine_vision", config: machine_vision },
    DevicePreset { name: "raspberry_pi_hq", config: raspberry_pi_hq },
];

preset_names!(ALL: DevicePreset);
