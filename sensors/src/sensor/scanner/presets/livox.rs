//! Livox.

use super::{Maker, Preset, line_of};
use crate::scanner::{Pattern, Rosette};
use core::f64::consts::PI;

/// Livox Mid-70: one laser behind two prisms, 100 000 points a second in a cone of 70.4°, σ 20 mm, up to 90 m of a surface of 10 %.
/// Beams of 0.52 × 4.89 mrad.
///
/// The prisms turn as those of the Mid-40 do (C. Brazeal et al., "A rigorous observation model for the Risley prism-based
/// Livox Mid-40 lidar sensor", Sensors 21:4722, 2021), at 7294 and −4664 turns a minute; the angle of their wedges is
/// that which bends a beam by 35.2°. The rosette begins anew every 30 s.
pub const MID_70: Preset = Preset {
    name: "mid70",
    maker: Maker::Livox,
    pattern: Pattern::Rosette(Rosette {
        firing_time_ns: 10_000,
        speeds_rpm: [7294, -4664],
        wedge_rad: 29.68 * (PI / 180.0),
        refractive_index: 1.51,
    }),
    modes: &[],
    rates_hz: [5.0, 50.0],
    rate_hz: 10.0,
    range_m: [0.05, 90.0],
    stddev_m: 0.02,
    spreads: &[],
    bias_stddev_m: 0.0,
    resolution_m: 0.001,
    beam: line_of([0.52e-3, 4.89e-3], [0.0; 2]),
};
