//! The parameters of a camera device: its data sheet.

use super::Vignetting;
use crate::ParameterError;

/// Planck's constant times the speed of light, in J·m.
const PLANCK_LIGHT: f64 = 6.626_070_15e-34 * 299_792_458.0;

/// Exposure time and analogue gain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exposure {
    /// Exposure time in seconds, 0 to 3600.
    pub time_s: f64,
    /// Factor of the analogue gain. At 1 the figures of the data sheet apply.
    pub gain: f64,
}

/// The lens, sensor and converter of a camera, in the terms of EMVA 1288 (release 4.0 linear).
///
/// Colours represent light here: 1 is the radiance `white_radiance_w_m2_sr`, and the light of each colour channel is
/// treated as monochromatic. In the time t, a pixel with the area A behind a lens with f-number N receives π·L·A·t/(1 +
/// 4N²) · λ/(hc) photons.
///
/// ```
/// use belvedere_sensors::device::{DeviceConfig, Exposure};
/// let device = DeviceConfig::default().exposure(Exposure { time_s: 0.01, gain: 1.0 }).quantum_efficiency([0.5; 3]);
/// // White paper at 500 lx through f/2.8 onto 5 µm.
/// assert_eq!(device.photons_per_second().round(), 1_579_987.0);
/// assert_eq!(device.electrons_of_white()[1].round(), 7900.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct DeviceConfig {
    /// Exposure time and gain. Automatic exposure changes them from frame to frame
    /// ([`Camera::set_device_exposure`](crate::camera::Camera::set_device_exposure)). The default is 10 ms at a gain of
    /// 1.
    pub exposure: Exposure,
    /// Radiance of a colour of 1, in W/(m²·sr). 0.233 is white paper in an office, at 500 lx of 555 nm. The default is
    /// 0.233.
    pub white_radiance_w_m2_sr: f64,
    /// Wavelength of the light in nanometres. The default is 555.
    pub wavelength_nm: f64,
    /// Focal length divided by the diameter of the aperture. The default is 2.8.
    pub f_number: f64,
    /// Vignetting of the lens. The default is [`Vignetting::NONE`].
    pub vignetting: Vignetting,
    /// Side length of a pixel in micrometres. The default is 5.
    pub pixel_pitch_um: f64,
    /// Quantum efficiency in electrons per photon for red, green and blue, including the colour filter. The default is
    /// 0.5 for each.
    pub quantum_efficiency: [f64; 3],
    /// Full-well capacity in electrons. The default is 16,000.
    pub full_well_e: f64,
    /// Mean dark current in electrons per second. The default is 0.
    pub dark_current_e_per_s: f64,
    /// Read noise before the gain: standard deviation in electrons. The default is 0.
    pub read_noise_e: f64,
    /// Read noise after the gain: standard deviation in DN. Expressed in electrons, it decreases as the gain increases.
    /// The default is 0.
    pub converter_noise_dn: f64,
    /// Dark signal non-uniformity (DSNU₁₂₈₈): standard deviation of the pixels' dark signal, in electrons. The default
    /// is 0.
    pub dsnu_e: f64,
    /// Photo-response non-uniformity (PRNU₁₂₈₈): standard deviation of the pixels' response, as a fraction of it; 0.01
    /// is 1 %. The default is 0.
    pub prnu: f64,
    /// Overall system gain K at a gain of 1, in DN per electron. The default is 0.25.
    pub dn_per_electron: f64,
    /// Black level: output of the converter without light, in DN. The default is 0.
    pub black_level_dn: f64,
    /// Bits of the converter, 8 to 16. The default is 12.
    pub bits: u32,
    /// Conversion from DN to image values. The default is [`Tone::Raw`].
    pub tone: Tone,
}

/// The conversion from the converter's numbers to image values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tone {
    /// The numbers themselves, including the black level. In 8-bit formats, the greatest number is scaled to 255.
    Raw,
    /// The black level is subtracted, each colour is multiplied by its white-balance factor, and the sRGB curve is
    /// applied, as in cameras with an image processor. The scale is the same as in `Raw`. Mosaics and brightness images
    /// use green's factor.
    Srgb {
        /// White-balance factors of red, green and blue, greater than 0.
        white_balance: [f64; 3],
    },
}

impl Default for DeviceConfig {
    /// A sensor without noise except photon shot noise: 5 µm pixels, f/2.8, a quantum efficiency of 0.5, a full well of
    /// 16,000 electrons at 12 bits, 10 ms of exposure.
    fn default() -> Self {
        Self {
            exposure: Exposure { time_s: 0.01, gain: 1.0 },
            white_radiance_w_m2_sr: 0.233,
            wavelength_nm: 555.0,
            f_number: 2.8,
            vignetting: Vignetting::NONE,
            pixel_pitch_um: 5.0,
            quantum_efficiency: [0.5; 3],
            full_well_e: 16_000.0,
            dark_current_e_per_s: 0.0,
            read_noise_e: 0.0,
            converter_noise_dn: 0.0,
            dsnu_e: 0.0,
            prnu: 0.0,
            dn_per_electron: 0.25,
            black_level_dn: 0.0,
            bits: 12,
            tone: Tone::Raw,
        }
    }
}

impl DeviceConfig {
    setters! {
        /// Sets exposure time and gain.
        exposure: Exposure,
        /// Sets the radiance of a colour of 1, in W/(m²·sr).
        white_radiance_w_m2_sr: f64,
        /// Sets the wavelength in nanometres.
        wavelength_nm: f64,
        /// Sets the f-number.
        f_number: f64,
        /// Sets the vignetting of the lens.
        vignetting: Vignetting,
        /// Sets the side length of a pixel in micrometres.
        pixel_pitch_um: f64,
        /// Sets the quantum efficiency for red, green and blue.
        quantum_efficiency: [f64; 3],
        /// Sets the full-well capacity in electrons.
        full_well_e: f64,
        /// Sets the dark current in electrons per second.
        dark_current_e_per_s: f64,
        /// Sets the read noise before the gain, in electrons.
        read_noise_e: f64,
        /// Sets the read noise after the gain, in DN.
        converter_noise_dn: f64,
        /// Sets the dark signal non-uniformity in electrons.
        dsnu_e: f64,
        /// Sets the photo-response non-uniformity as a fraction of the response.
        prnu: f64,
        /// Sets the overall system gain K at a gain of 1, in DN per electron.
        dn_per_electron: f64,
        /// Sets the black level in DN.
        black_level_dn: f64,
        /// Sets the bits of the converter.
        bits: u32,
        /// Sets the conversion from DN to image values.
        tone: Tone,
    }

    /// Returns the number of photons per second that reach a pixel on the axis for a colour of 1.
    #[must_use]
    pub fn photons_per_second(&self) -> f64 {
        let area = self.pixel_pitch_um * self.pixel_pitch_um * 1e-12;
        let irradiance =
            core::f64::consts::PI * self.white_radiance_w_m2_sr / (1.0 + 4.0 * self.f_number * self.f_number);
        irradiance * area * (self.wavelength_nm * 1e-9) / PLANCK_LIGHT
    }

    /// Returns the mean number of electrons in the exposure time for a colour of 1, on the axis, in red, green and
    /// blue.
    #[must_use]
    pub fn electrons_of_white(&self) -> [f64; 3] {
        self.quantum_efficiency
            .map(|efficiency| efficiency * self.photons_per_second() * self.exposure.time_s)
    }

    /// Returns the greatest number of the converter.
    #[must_use]
    pub const fn top_dn(&self) -> u32 {
        if self.bits < 32 { (1 << self.bits) - 1 } else { u32::MAX }
    }

    /// Checks that all parameters are in range.
    ///
    /// # Errors
    /// Names the first parameter that is out of range.
    pub fn check(&self) -> Result<(), ParameterError> {
        let check = |parameter, value, range| ParameterError::require_in("device", parameter, value, range);
        check("exposure.time_s", self.exposure.time_s, [0.0, 3600.0])?;
        check("exposure.gain", self.exposure.gain, [1e-3, 1e6])?;
        check("white_radiance_w_m2_sr", self.white_radiance_w_m2_sr, [0.0, 1e9])?;
        check("wavelength_nm", self.wavelength_nm, [100.0, 20_000.0])?;
        check("f_number", self.f_number, [0.1, 1000.0])?;
        for term in self.vignetting.polynomial {
            check("vignetting.polynomial", term, [-1e3, 1e3])?;
        }
        check("pixel_pitch_um", self.pixel_pitch_um, [0.1, 1000.0])?;
        for efficiency in self.quantum_efficiency {
            check("quantum_efficiency", efficiency, [0.0, 1.0])?;
        }
        check("bits", f64::from(self.bits), [8.0, 16.0])?;
        let top = f64::from(self.top_dn());
        // f32 resolves single electrons up to 2²², which is also the limit of the rounding of counts.
        check("full_well_e", self.full_well_e, [1.0, 4_194_304.0])?;
        check("dark_current_e_per_s", self.dark_current_e_per_s, [0.0, 1e9])?;
        check("read_noise_e", self.read_noise_e, [0.0, 1e6])?;
        check("converter_noise_dn", self.converter_noise_dn, [0.0, top])?;
        check("dsnu_e", self.dsnu_e, [0.0, 1e6])?;
        check("prnu", self.prnu, [0.0, 1.0])?;
        check("dn_per_electron", self.dn_per_electron, [1e-6, 1e6])?;
        check("black_level_dn", self.black_level_dn, [0.0, top - 1.0])?;
        if let Tone::Srgb { white_balance } = self.tone {
            for factor in white_balance {
                check("white_balance", factor, [1e-3, 1e3])?;
            }
        }
        Ok(())
    }
}
