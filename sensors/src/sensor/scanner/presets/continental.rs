//! Scanners of Continental.

use super::{Maker, Preset};
use crate::scanner::{Beam, Pattern, Raster};
use core::f64::consts::PI;

/// Continental HFL110: a flash lidar with 128 × 32 pixels over 120° × 30°, 25 times a second.
///
/// The largest range is 50 m, the resolution a 65536th of that, as in its driver. Pixels are assumed to be evenly
/// spaced in angle. σ is not published; 20 mm is assumed.
pub const HFL_110: Preset = Preset {
    name: "hfl110",
    maker: Maker::Continental,
    pattern: Pattern::Raster(Raster {
        pixels: [128, 32],
        field_rad: [120.0 * (PI / 180.0), 30.0 * (PI / 180.0)],
        pixel_time_ns: 0,
        row_time_ns: 0,
    }),
    modes: &[],
    rates_hz: [1.0, 25.0],
    rate_hz: 25.0,
    range_m: [0.1, 50.0],
    stddev_m: 0.02,
    spreads: &[],
    bias_stddev_m: 0.0,
    resolution_m: 50.0 / 65_536.0,
    // The beam of a pixel is as wide as the pixel's field of view.
    beam: Beam {
        divergence_rad: [120.0 / 128.0 * (PI / 180.0), 30.0 / 32.0 * (PI / 180.0)],
        aperture_m: [0.0; 2],
        rays: 1,
    },
};
