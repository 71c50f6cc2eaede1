//! The Raspberry Pi High Quality Camera.

use crate::device::{DeviceConfig, Exposure, Tone, Vignetting};

/// Sony's IMX477 (4056 × 3040 pixels of 1.55 µm, 12 bits) on the Raspberry Pi HQ camera, with the sRGB curve.
///
/// From "Pi HQ Cam Sensor Performance" (strollswithmydog.com, 2020), measured in raw images: K 0.47 DN/e⁻ at an
/// analogue gain of 1, clipping at 8180 e⁻, black level 256.3 DN, noise of black frames 1.53 DN at a gain of 1 and
/// 11.50 DN at 16. The last two are equivalent to 1.52 e⁻ before the gain and 1.32 DN after it. Assumed: f/2.8 and a
/// lens with cos⁴θ vignetting, the quantum efficiencies with the colour filters and a matching white balance, and a
/// PRNU of 0.5 %. The dark current is not published and set to 0.
///
/// ```
/// let device = belvedere_sensors::device::presets::raspberry_pi_hq();
/// let noise_dn = |gain: f64| {
///     let before = device.read_noise_e * device.dn_per_electron * gain;
///     (before * before + device.converter_noise_dn * device.converter_noise_dn + 1.0 / 12.0).sqrt()
/// };
/// assert!((noise_dn(1.0) - 1.53).abs() < 0.01 && (noise_dn(16.0) - 11.50).abs() < 0.01);
/// ```
#[must_use]
pub fn raspberry_pi_hq() -> DeviceConfig {
    DeviceConfig::default()
        .exposure(Exposure { time_s: 0.01, gain: 1.0 })
        .f_number(2.8)
        .vignetting(Vignetting::NATURAL)
        .pixel_pitch_um(1.55)
        .quantum_efficiency([0.3, 0.54, 0.36])
        .dn_per_electron(0.47)
        .bits(12)
        .black_level_dn(256.3)
        .full_well_e(8180.0)
        .read_noise_e(1.519)
        .converter_noise_dn(1.322)
        .prnu(0.005)
        .tone(Tone::Srgb { white_balance: [1.8, 1.0, 1.5] })
}
