//! Scanners of Velodyne.

use super::{Maker, Preset, line_of};
use crate::scanner::{Beam, Columns, Laser, Pattern, Spinning};

/// Velodyne VLP-16 (User Manual 63-9243): 16 lasers that fire one after the other, each with its own height of the
/// beam's origin.
///
/// Beams begin 12.7 × 9.5 mm wide and have a divergence of 3 × 1.5 mrad.
pub const VLP_16: Preset = Preset {
    name: "vlp16",
    maker: Maker::Velodyne,
    pattern: clockwise(&VLP_16_LASERS, 55_296),
    modes: &[],
    rates_hz: [5.0, 20.0],
    rate_hz: 10.0,
    range_m: [1.0, 100.0],
    stddev_m: 0.01,
    spreads: &[],
    bias_stddev_m: 0.0,
    resolution_m: 0.002,
    beam: line_of([3e-3, 1.5e-3], [0.0127, 0.0095]),
};

/// Velodyne HDL-32E (User's Manual): 32 lasers that fire one after the other.
pub const HDL_32E: Preset = Preset {
    name: "hdl32e",
    maker: Maker::Velodyne,
    pattern: clockwise(&HDL_32E_LASERS, 46_080),
    modes: &[],
    rates_hz: [5.0, 20.0],
    rate_hz: 10.0,
    range_m: [0.05, 100.0],
    stddev_m: 0.02 / 3.0,
    spreads: &[],
    bias_stddev_m: 0.0,
    resolution_m: 0.002,
    beam: Beam::RAY,
};

/// Elevations in degrees and heights of the beams' origins in millimetres, −41.91·tan of the elevation.
const VLP_16_LASERS: [Laser; 16] = fired_each(
    &[
        (-15.0, 11.2298),
        (1.0, -0.7315),
        (-13.0, 9.6757),
        (3.0, -2.1964),
        (-11.0, 8.1465),
        (5.0, -3.6666),
        (-9.0, 6.6379),
        (7.0, -5.1459),
        (-7.0, 5.1459),
        (9.0, -6.6379),
        (-5.0, 3.6666),
        (11.0, -8.1465),
        (-3.0, 2.1964),
        (13.0, -9.6757),
        (-1.0, 0.7315),
        (15.0, -11.2298),
    ],
    2.304e-6,
);

/// Elevations in degrees and heights of the beams' origins in millimetres, −28.95·tan of the elevation.
const HDL_32E_LASERS: [Laser; 32] = fired_each(
    &[
        (-30.67, 17.1688),
        (-9.33, 4.7563),
        (-29.33, 16.2659),
        (-8.0, 4.0687),
        (-28.0, 15.3930),
        (-6.67, 3.3855),
        (-26.67, 14.5413),
        (-5.33, 2.7009),
        (-25.33, 13.7032),
        (-4.0, 2.0244),
        (-24.0, 12.8894),
        (-2.67, 1.3501),
        (-22.67, 12.0922),
        (-1.33, 0.6721),
        (-21.33, 11.3046),
        (0.0, 0.0),
        (-20.0, 10.5369),
        (1.33, -0.6721),
        (-18.67, 9.7821),
        (2.67, -1.3501),
        (-17.33, 9.0336),
        (4.0, -2.0244),
        (-16.0, 8.3013),
        (5.33, -2.7009),
        (-14.67, 7.5787),
        (6.67, -3.3855),
        (-13.33, 6.8595),
        (8.0, -4.0687),
        (-12.0, 6.1535),
        (9.33, -4.7563),
        (-10.67, 5.4545),
        (10.67, -5.4545),
    ],
    1.152e-6,
);

/// Returns lasers with these elevations and heights, which fire `time_s` seconds after each other.
const fn fired_each<const N: usize>(lasers: &[(f64, f64); N], time_s: f64) -> [Laser; N] {
    let mut made = [Laser::at_degrees(0.0, 0.0); N];
    let mut id = 0;
    while id < N {
        let (elevation, height_mm) = lasers[id];
        made[id] = Laser {
            origin_m: [0.0, 0.0, height_mm * 1e-3],
            time_s: time_s * id as f64,
            ..Laser::at_degrees(elevation, 0.0)
        };
        id += 1;
    }
    made
}

/// Returns the pattern of a head that points ahead at the beginning of a frame and turns clockwise, as Velodyne's do.
const fn clockwise(lasers: &'static [Laser], column_ns: u64) -> Pattern<'static> {
    Pattern::Spinning(Spinning {
        lasers,
        columns: Columns::Every { time_ns: column_ns },
        first_azimuth_rad: 0.0,
        clockwise: true,
    })
}
