//! Camera devices: the sensor and electronics that convert light to image values.
//!
//! ```text
//! colour, linear ─► vignetting ─► photons ─► electrons ─► full well ─► DN ─► image
//!                     lens         time        shot noise              K, black   as it is, or
//!                                  aperture    dark current            level,     on sRGB's curve
//!                                  efficiency  PRNU, DSNU   reading     bits
//! ```
//!
//! A [`DeviceConfig`] is a data sheet in the terms of EMVA 1288; [`presets`] contains some. It is set by
//! [`CameraConfig::device`](crate::camera::CameraConfig::device()); without a device, a camera shows colours as they
//! are shaded. Noise is added before the curve of [`srgb`](mod@crate::srgb). Each colour of an rgb8, bgr8 or rgba8
//! image is a separate pixel, as in a camera with three sensors. A mosaic has one pixel that sees one colour
//! ([`Mosaic`]); mono8 and mono16 have one that sees the brightness. The fixed patterns of PRNU and DSNU depend on the
//! seed and the number of the sensor, and are the same in every frame.
//!
//! Numbers of electrons follow a Poisson distribution. Below a mean of sixteen they are sampled exactly; from there on,
//! a normal number is transformed to one with the same mean, variance and third moment.

mod auto_exposure;
mod config;
pub mod depth_model;
mod format;
mod mosaic;
mod poisson;
pub mod presets;
mod signal;
mod vignetting;

use crate::ParameterError;
use crate::noise::Stream;
use crate::shade::Colours;
use crate::simd::{LANES, Lanes};
use crate::srgb;
use crate::trace::grid::tiling::BLOCKS;
pub(crate) use auto_exposure::meter;
pub use auto_exposure::{AutoExposure, AutoExposureConfig, FrameStatistics, Metering};
pub use config::{DeviceConfig, Exposure, Tone};
use fearless_simd::Simd;
pub use format::PixelFormat;
pub use mosaic::Mosaic;
use signal::Signal;
pub use vignetting::Vignetting;

/// Weights of red, green and blue in the brightness (ITU-R BT.601).
pub(crate) const LUMA: [f32; 3] = [0.299, 0.587, 0.114];

/// The sensor pixels behind each pixel of an image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Planes {
    /// One pixel for each colour.
    Colours,
    /// One pixel that sees the brightness.
    Brightness,
    /// One pixel that sees one colour.
    Mosaic(Mosaic),
}

/// The position of a tile, and the directions of its rays.
pub(crate) struct TileView<'a> {
    pub(crate) directions: &'a [Lanes<f32>; 3],
    /// The optical axis.
    pub(crate) forward: [f32; 3],
    /// Column and row of the first pixel of each of the tile's lines.
    pub(crate) lines: [[usize; 2]; BLOCKS],
    /// The numbers of their random samples, sixteen per line.
    pub(crate) samples: [u32; BLOCKS],
}

/// A checked device.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Device {
    signal: Signal,
    vignetting: Vignetting,
    /// Electrons for a colour of 1, in red, green and blue.
    response: [f32; 3],
    tone: Tone,
}

impl Device {
    pub(crate) fn new(config: &DeviceConfig) -> Result<Self, ParameterError> {
        config.check()?;
        let dn_per_electron = config.dn_per_electron * config.exposure.gain;
        let converter_e = config.converter_noise_dn / dn_per_electron;
        let read_variance = config.read_noise_e * config.read_noise_e + converter_e * converter_e;
        let signal = Signal {
            dark_e: (config.dark_current_e_per_s * config.exposure.time_s) as f32,
            prnu: config.prnu as f32,
            dsnu_e: config.dsnu_e as f32,
            read_e: libm::sqrt(read_variance) as f32,
            full_well_e: config.full_well_e as f32,
            dn_per_electron: dn_per_electron as f32,
            black_level_dn: config.black_level_dn as f32,
            top_dn: config.top_dn() as f32,
        };
        let response = config.electrons_of_white().map(|electrons| electrons as f32);
        Ok(Self { signal, vignetting: config.vignetting, response, tone: config.tone })
    }

    /// The greatest value of a 16-bit format.
    pub(crate) fn full_scale(&self) -> f32 {
        self.signal.top_dn
    }

    /// Converts the linear colours of a tile of an image to values in [0, 1] of the converter's full scale. `stream`
    /// gives the seed, sensor and frame.
    ///
    /// Mosaics and brightness images have one value per pixel, which is written to all three channels.
    pub(crate) fn expose<S: Simd>(
        &self,
        simd: S,
        planes: Planes,
        stream: &Stream,
        view: &TileView<'_>,
        colours: &mut Colours,
    ) {
        simd.vectorize(
            #[inline(always)]
            || {
                // Step 1: compute the mean number of electrons from light.
                if self.vignetting != Vignetting::NONE {
                    let shares = self.vignetting.of_rays(view.directions, view.forward);
                    for channel in &mut *colours {
                        for lane in 0..LANES {
                            channel[lane] *= shares[lane];
                        }
                    }
                }
                for channel in 0..3 {
                    for lane in 0..LANES {
                        let light = colours[channel][lane];
                        colours[channel][lane] =
                            if light > 0.0 { light } else { 0.0 } * self.response[channel];
                    }
                }

                // Step 2: select the pixels that the sensor has.
                let single = match planes {
                    Planes::Colours => None,
                    Planes::Brightness => {
                        let [red, green, blue] = &*colours;
                        let mut sum = [0.0; LANES];
                        for lane in 0..LANES {
                            sum[lane] = red[lane] * LUMA[0] + green[lane] * LUMA[1] + blue[lane] * LUMA[2];
                        }
                        Some(sum)
                    }
                    Planes::Mosaic(mosaic) => Some(mosaic.pick(colours, &view.lines)),
                };
                let planes = if single.is_some() { 1 } else { 3 };
                if let Some(single) = single {
                    colours[0] = single;
                }

                // Step 3: read the pixels.
                for (plane, values) in colours.iter_mut().enumerate().take(planes) {
                    let of_plane = |channel: u16| Stream { channel: channel + plane as u16, ..*stream };
                    self.signal.read(simd, values, of_plane, view.samples);
                    self.develop(values, if planes == 1 { 1 } else { plane });
                }
                if planes == 1 {
                    let value = colours[0];
                    colours[1..].fill(value);
                }
            },
        );
    }

    /// Converts DN to fractions of full scale.
    #[inline(always)]
    fn develop(&self, values: &mut Lanes<f32>, channel: usize) {
        let Signal { top_dn, black_level_dn, .. } = self.signal;
        match self.tone {
            Tone::Raw => {
                let scale = 1.0 / top_dn;
                for value in values {
                    *value *= scale;
                }
            }
            Tone::Srgb { white_balance } => {
                let scale = white_balance[channel] as f32 / (top_dn - black_level_dn);
                for value in values {
                    *value = srgb::encode((*value - black_level_dn) * scale);
                }
            }
        }
    }
}
