//! Scanners of Slamtec.

use super::{Maker, Preset, some, steps};
use crate::scanner::{Beam, Spread};

/// Slamtec RPLIDAR A1M8 (data sheet rev. 1.0): 360 beams per turn. The error of its triangulation is 3.3·10⁻⁴·r².
pub const RPLIDAR_A1: Preset = Preset {
    name: "rplidar_a1",
    maker: Maker::Slamtec,
    pattern: steps(some(360, 0, 360), 180),
    modes: &[],
    rates_hz: [1.0, 10.0],
    rate_hz: 5.5,
    range_m: [0.15, 12.0],
    stddev_m: 0.0,
    spreads: &[Spread { from_m: 0.0, stddev: [0.0, 0.0, 3.3e-4] }],
    bias_stddev_m: 0.0,
    resolution_m: 0.000_25,
    beam: Beam::RAY,
};

/// Slamtec RPLIDAR A2M8 (data sheet rev. 2.5): 800 beams per turn. The error is at most 1 %.
pub const RPLIDAR_A2: Preset = Preset {
    name: "rplidar_a2",
    maker: Maker::Slamtec,
    pattern: steps(some(800, 0, 800), 400),
    modes: &[],
    rates_hz: [5.0, 15.0],
    rate_hz: 10.0,
    range_m: [0.2, 12.0],
    stddev_m: 0.0,
    spreads: &[Spread { from_m: 0.0, stddev: [0.0, 0.01 / 3.0, 0.0] }],
    bias_stddev_m: 0.0,
    resolution_m: 0.000_25,
    beam: Beam::RAY,
};
