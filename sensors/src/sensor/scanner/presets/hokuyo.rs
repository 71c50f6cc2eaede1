//! Scanners of Hokuyo.

use super::{Maker, Preset, line_of, some, steps};
use crate::scanner::Spread;

/// Hokuyo URG-04LX (specification C-42-03320): 682 of 1024 steps of a turn.
///
/// The error is ±10 mm up to a metre and 1 % beyond. The beam has a spot of 40 mm at 4 m.
pub const URG_04LX: Preset = Preset {
    name: "urg04lx",
    maker: Maker::Hokuyo,
    pattern: steps(some(1024, 44, 682), 384),
    modes: &[],
    rates_hz: [10.0, 10.0],
    rate_hz: 10.0,
    range_m: [0.02, 5.6],
    stddev_m: 0.0,
    spreads: &[
        Spread { from_m: 0.0, stddev: [0.01 / 3.0, 0.0, 0.0] },
        Spread { from_m: 1.0, stddev: [0.0, 0.01 / 3.0, 0.0] },
    ],
    bias_stddev_m: 0.0,
    resolution_m: 0.001,
    beam: line_of([0.01; 2], [0.0; 2]),
};

/// Hokuyo UTM-30LX: 1081 of 1440 steps of a turn.
///
/// The repeatability σ is 10 mm up to 10 m and 30 mm beyond. The edge of the beam is taken at two σ to each side, with
/// σ of 1.5 mm and 0.6 mrad (F. Pomerleau et al., 2012).
pub const UTM_30LX: Preset = Preset {
    name: "utm30lx",
    maker: Maker::Hokuyo,
    pattern: steps(some(1440, 0, 1081), 540),
    modes: &[],
    rates_hz: [40.0, 40.0],
    rate_hz: 40.0,
    range_m: [0.1, 30.0],
    stddev_m: 0.0,
    spreads: &[
        Spread { from_m: 0.0, stddev: [0.01, 0.0, 0.0] },
        Spread { from_m: 10.0, stddev: [0.03, 0.0, 0.0] },
    ],
    bias_stddev_m: 0.0,
    resolution_m: 0.001,
    beam: line_of([2.4e-3; 2], [6e-3; 2]),
};
