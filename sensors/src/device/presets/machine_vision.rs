//! A machine-vision camera with a global shutter.

use crate::device::{DeviceConfig, Exposure, Tone};

/// Sony's IMX900 (2064 × 1552 pixels of 2.25 µm), as a monochrome camera at 0 dB and low conversion gain.
///
/// From FRAMOS's EMVA 1288 (3.1) report of the IMX900-AMR-C at 536 nm and 36 °C: K 0.399 DN/e⁻ at 12 bits, quantum
/// efficiency 91.25 %, temporal dark noise 5.56 e⁻, saturation capacity 9458 e⁻, DSNU 3.7 e⁻, PRNU 0.7 %, black level
/// 240 DN. The dark current, 1.473 e⁻/s, is from the report at high conversion gain. Assumed: a lens of f/2.8.
///
/// The dynamic range and the greatest signal-to-noise ratio of the report follow from these figures:
/// ```
/// let device = belvedere_sensors::device::presets::machine_vision();
/// let quantisation = 1.0 / 12.0 / (device.dn_per_electron * device.dn_per_electron);
/// let least_e = (device.read_noise_e * device.read_noise_e + quantisation).sqrt() + 0.5;
/// assert!((20.0 * (device.full_well_e / least_e).log10() - 63.8).abs() < 0.1); // dB
/// assert!((10.0 * device.full_well_e.log10() - 39.76).abs() < 0.01); // dB
/// ```
#[must_use]
pub fn machine_vision() -> DeviceConfig {
    DeviceConfig::default()
        .exposure(Exposure { time_s: 0.005, gain: 1.0 })
        .f_number(2.8)
        .wavelength_nm(536.0)
        .pixel_pitch_um(2.25)
        .quantum_efficiency([0.9125; 3])
        .dn_per_electron(0.399)
        .bits(12)
        .black_level_dn(240.0)
        .full_well_e(9458.0)
        .read_noise_e(5.56)
        .dark_current_e_per_s(1.473)
        .dsnu_e(3.7)
        .prnu(0.007)
        .tone(Tone::Raw)
}
