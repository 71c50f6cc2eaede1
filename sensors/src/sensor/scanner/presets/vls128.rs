//! Velodyne VLS-128.

use super::{Maker, Preset, line_of};
use crate::scanner::{Columns, Laser, Pattern, Spinning};
use core::f64::consts::PI;

/// Velodyne VLS-128, Alpha Prime (User Manual 63-9483): 128 lasers, of which eight fire at once; one column every 53.3
/// µs.
///
/// The accuracy is ±3 cm. Beams have a divergence of 3 × 1.5 mrad; the origin of each is −58.63 mm·tan of its elevation
/// above the middle.
pub const VLS_128: Preset = Preset {
    name: "vls128",
    maker: Maker::Velodyne,
    pattern: Pattern::Spinning(Spinning {
        lasers: &LASERS,
        columns: Columns::Every { time_ns: 53_300 },
        first_azimuth_rad: 0.0,
        clockwise: true,
    }),
    modes: &[],
    rates_hz: [5.0, 20.0],
    rate_hz: 10.0,
    range_m: [0.4, 245.0],
    stddev_m: 0.01,
    spreads: &[],
    bias_stddev_m: 0.0,
    resolution_m: 0.004,
    beam: line_of([3e-3, 1.5e-3], [0.0127, 0.0095]),
};

/// The distance from the middle back to the point where all beams meet, negative.
const FOCUS_M: f64 = -0.058_63;

/// Returns the tangent of an angle of less than 0.45 rad, accurate to 10⁻⁷, from its power series.
const fn tan(angle: f64) -> f64 {
    let square = angle * angle;
    let (c, d) = (17.0 / 315.0, 62.0 / 2835.0);
    let (e, f) = (1382.0 / 155_925.0, 21_844.0 / 6_081_075.0);
    let rest = c + square * (d + square * (e + square * f));
    angle * (1.0 + square * (1.0 / 3.0 + square * (2.0 / 15.0 + square * rest)))
}

/// The time from one group of eight lasers to the next.
const GROUP_S: f64 = 2.665e-6;

/// Azimuths of the eight lasers that fire at once, in degrees counter-clockwise from the direction of the head.
const ASIDE_DEG: [f64; 8] = [-6.354, -4.548, -2.732, -0.911, 0.911, 2.732, 4.548, 6.354];

/// The elevation of each laser, in degrees.
#[rustfmt::skip]
#[expect(clippy::approx_constant, reason = "6.28 degrees happen to look like a whole turn in radians")]
const ELEVATIONS_DEG: [f64; 128] = [
    -11.742, -1.99, 3.4, -5.29, -0.78, 4.61, -4.08, 1.31,
    -6.5, -1.11, 4.28, -4.41, 0.1, 6.48, -3.2, 2.19,
    -3.86, 1.53, -9.244, -1.77, 2.74, -5.95, -0.56, 4.83,
    -2.98, 2.41, -6.28, -0.89, 3.62, -5.07, 0.32, 7.58,
    -0.34, 5.18, -3.64, 1.75, -25.0, -2.43, 2.96, -5.73,
    0.54, 9.7, -2.76, 2.63, -7.65, -1.55, 3.84, -4.85,
    3.18, -5.51, -0.12, 5.73, -4.3, 1.09, -16.042, -2.21,
    4.06, -4.63, 0.76, 15.0, -3.42, 1.97, -6.85, -1.33,
    -5.62, -0.23, 5.43, -3.53, 0.98, -19.582, -2.32, 3.07,
    -4.74, 0.65, 11.75, -2.65, 1.86, -7.15, -1.44, 3.95,
    -2.1, 3.29, -5.4, -0.01, 4.5, -4.19, 1.2, -13.565,
    -1.22, 4.17, -4.52, 0.87, 6.08, -3.31, 2.08, -6.65,
    1.42, -10.346, -1.88, 3.51, -6.06, -0.67, 4.72, -3.97,
    2.3, -6.39, -1.0, 4.39, -5.18, 0.21, 6.98, -3.09,
    4.98, -3.75, 1.64, -8.352, -2.54, 2.85, -5.84, -0.45,
    8.43, -2.87, 2.52, -6.17, -1.66, 3.73, -4.96, 0.43,
];

const LASERS: [Laser; 128] = {
    let mut made = [Laser::at_degrees(0.0, 0.0); 128];
    let mut id = 0;
    while id < made.len() {
        let group = id / ASIDE_DEG.len();
        // Halfway through a column there is a pause as long as one group takes, and at the end one as long as three.
        let place = group + if group < 8 { 0 } else { 1 };
        made[id] = Laser {
            origin_m: [0.0, 0.0, FOCUS_M * tan(ELEVATIONS_DEG[id] * (PI / 180.0))],
            time_s: GROUP_S * place as f64,
            ..Laser::at_degrees(ELEVATIONS_DEG[id], ASIDE_DEG[id % ASIDE_DEG.len()])
        };
        id += 1;
    }
    made
};
