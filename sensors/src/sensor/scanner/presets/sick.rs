//! Scanners of SICK.

use super::{Maker, Mode, Preset, line_of, some, steps};
use crate::scanner::Spread;

/// SICK LMS111: 270°, in steps of 0.25° at 25 Hz or of 0.5° at 50 Hz.
///
/// The statistical error σ is 12 mm, the systematic error ±30 mm. The beam begins 8 mm wide and has a divergence of 15
/// mrad.
pub const LMS_111: Preset = Preset {
    name: "lms111",
    maker: Maker::Sick,
    pattern: steps(LMS_111_MODES[0].columns, 540),
    modes: &LMS_111_MODES,
    rates_hz: [25.0, 50.0],
    rate_hz: 25.0,
    range_m: [0.5, 20.0],
    stddev_m: 0.012,
    spreads: &[],
    bias_stddev_m: 0.01,
    resolution_m: 0.001,
    beam: line_of([0.015; 2], [0.008; 2]),
};

const LMS_111_MODES: [Mode; 2] = [
    Mode { columns: some(1440, 0, 1081), rate_hz: 25.0 },
    Mode { columns: some(720, 0, 541), rate_hz: 50.0 },
];

/// SICK LMS511 (operating instructions 8013796) with standard resolution: 190°, in steps from 0.1667° at 25 Hz to 1° at
/// 100 Hz.
///
/// The statistical error σ is 6 mm up to 10 m, 8 mm up to 20 m and 14 mm beyond; the systematic error is ±25 mm and
/// more. The beam begins 13 mm wide and has a divergence of 11 mrad.
pub const LMS_511: Preset = Preset {
    name: "lms511",
    maker: Maker::Sick,
    pattern: steps(LMS_511_MODES[0].columns, 570),
    modes: &LMS_511_MODES,
    rates_hz: [25.0, 100.0],
    rate_hz: 25.0,
    range_m: [0.7, 80.0],
    stddev_m: 0.0,
    spreads: &[
        Spread { from_m: 0.0, stddev: [0.006, 0.0, 0.0] },
        Spread { from_m: 10.0, stddev: [0.008, 0.0, 0.0] },
        Spread { from_m: 20.0, stddev: [0.014, 0.0, 0.0] },
    ],
    bias_stddev_m: 0.025 / 3.0,
    resolution_m: 0.001,
    beam: line_of([0.011; 2], [0.013; 2]),
};

/// The finest steps at each rate, then the coarsest.
const LMS_511_MODES: [Mode; 6] = [
    Mode { columns: some(2160, 0, 1141), rate_hz: 25.0 },
    Mode { columns: some(1440, 0, 761), rate_hz: 35.0 },
    Mode { columns: some(1080, 0, 571), rate_hz: 50.0 },
    Mode { columns: some(720, 0, 381), rate_hz: 75.0 },
    Mode { columns: some(540, 0, 286), rate_hz: 100.0 },
    Mode { columns: some(360, 0, 191), rate_hz: 100.0 },
];
