//! Camera devices with published figures. Figures that no data sheet gives are marked as assumed where they are set.

mod machine_vision;
mod raspberry_pi;
mod webcam;

use super::DeviceConfig;
pub use machine_vision::machine_vision;
pub use raspberry_pi::raspberry_pi_hq;
pub use webcam::webcam;

/// The names of the presets, by which configuration files refer to them.
pub const NAMES: [&str; 3] = ["webcam", "machine_vision", "raspberry_pi_hq"];

/// Returns the preset with the given name, or `None` if there is none.
///
/// ```
/// use belvedere_sensors::device::presets;
/// assert!(presets::NAMES.iter().all(|name| presets::named(name).is_some()));
/// assert_eq!(presets::named("raspberry_pi_hq").map(|device| device.bits), Some(12));
/// ```
#[must_use]
pub fn named(name: &str) -> Option<DeviceConfig> {
    match name {
        "webcam" => Some(webcam()),
        "machine_vision" => Some(machine_vision()),
        "raspberry_pi_hq" => Some(raspberry_pi_hq()),
        _ => None,
    }
}
