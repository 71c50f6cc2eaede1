//! A webcam.

use crate::device::{DeviceConfig, Exposure, Tone, Vignetting};

/// `OmniVision`'s OV5647 (2592 × 1944 pixels of 1.4 µm) behind a USB interface, with the sRGB curve.
///
/// From the user guide of such a camera (`OptArc` AF51, v1.02, page 21): well capacity 4.3 ke⁻; dynamic range 68 dB,
/// which implies a read noise of 1.71 e⁻; greatest signal-to-noise ratio 36 dB; fixed-pattern noise below 1 %, which is
/// used as PRNU. Its dark current is given in mV/s at 60 °C and is omitted. Assumed: 10 bits that a full well just
/// fills above a black level of 16, f/2.4 and a lens with cos⁴θ vignetting, and the quantum efficiencies with the
/// colour filters and a matching white balance.
///
/// ```
/// let device = belvedere_sensors::device::presets::webcam();
/// assert!((20.0 * (device.full_well_e / device.read_noise_e).log10() - 68.0).abs() < 0.05);
/// assert!((10.0 * device.full_well_e.log10() - 36.0).abs() < 0.5);
/// ```
#[must_use]
pub fn webcam() -> DeviceConfig {
    DeviceConfig::default()
        .exposure(Exposure { time_s: 0.01, gain: 1.0 })
        .f_number(2.4)
        .vignetting(Vignetting::NATURAL)
        .pixel_pitch_um(1.4)
        .quantum_efficiency([0.3, 0.45, 0.33])
        .dn_per_electron(1007.0 / 4300.0)
        .bits(10)
        .black_level_dn(16.0)
        .full_well_e(4300.0)
        .read_noise_e(1.71)
        .prnu(0.01)
        .tone(Tone::Srgb { white_balance: [1.5, 1.0, 1.364] })
}
