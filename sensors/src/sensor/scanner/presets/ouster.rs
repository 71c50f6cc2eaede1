//! Scanners of Ouster: heads with 128 lasers. Smaller models have every second or every fourth of them.
//!
//! Each unit is calibrated and reports its own angles. The angles here are typical ones, cubic polynomials of the
//! number of the laser: within 0.2° (OS0), 0.03° (OS1) and 0.02° (OS2) of one unit, and within 1.5° of others. Beams
//! begin 10 mm wide, as those of an OS1.

use super::{Maker, Mode, Preset, line_of};
use crate::scanner::{Columns, Laser, Pattern, Spinning};
use core::f64::consts::PI;

/// The lasers of a kind of head.
struct OusterOptics {
    /// Elevation in degrees as a polynomial of the row, counted down from the middle: coefficients of order 0, 1 and 3.
    elevation_deg: [f64; 3],
    /// Azimuths in degrees of each four successive rows, clockwise as in Ouster's metadata, and the coefficient of the
    /// square of the row, counted from the middle.
    azimuths_deg: [(f64, f64); 4],
    /// The distance from the axis to the origin of the beams (n), and the height of that origin, in metres.
    beam_m: [f64; 2],
}

const OS0: OusterOptics = OusterOptics {
    elevation_deg: [-0.33, -0.7035, -4.753e-6],
    azimuths_deg: [(8.31, 6.1e-4), (2.78, 2.0e-4), (-2.76, -2.2e-4), (-8.28, -6.3e-4)],
    beam_m: [0.027_67, 0.036_18],
};
const OS1: OusterOptics = OusterOptics {
    elevation_deg: [0.03, -0.3539, 3.887e-6],
    azimuths_deg: [(4.25, 0.0), (1.42, 0.0), (-1.42, 0.0), (-4.25, 0.0)],
    beam_m: [0.015_806, 0.036_18],
};
const OS2: OusterOptics = OusterOptics {
    elevation_deg: [-0.154, -0.1744, 5.95e-7],
    azimuths_deg: [(2.08, 0.0), (0.70, 0.0), (-0.68, 0.0), (-2.06, 0.0)],
    beam_m: [0.013_762, 0.078_296],
};

/// Ouster OS0-32, with a vertical field of view of 90°.
///
/// The repeatability of all Ouster presets is that of a strong return in the data sheet of the first OS1.
pub const OS0_32: Preset = preset("os0_32", &OS0_32_LASERS, [0.3, 55.0], 6.1e-3);
/// Ouster OS0-64.
pub const OS0_64: Preset = preset("os0_64", &OS0_64_LASERS, [0.3, 55.0], 6.1e-3);
/// Ouster OS0-128.
pub const OS0_128: Preset = preset("os0_128", &OS0_128_LASERS, [0.3, 55.0], 6.1e-3);
/// Ouster OS1-32, with a vertical field of view of 43°.
pub const OS1_32: Preset = preset("os1_32", &OS1_32_LASERS, [0.8, 120.0], 2.27e-3);
/// Ouster OS1-64.
pub const OS1_64: Preset = preset("os1_64", &OS1_64_LASERS, [0.8, 120.0], 2.27e-3);
/// Ouster OS1-128.
pub const OS1_128: Preset = preset("os1_128", &OS1_128_LASERS, [0.8, 120.0], 3.14e-3);
/// Ouster OS2-32, with a vertical field of view of 22°.
pub const OS2_32: Preset = preset("os2_32", &OS2_32_LASERS, [1.0, 240.0], 1.6e-3);
/// Ouster OS2-64.
pub const OS2_64: Preset = preset("os2_64", &OS2_64_LASERS, [1.0, 240.0], 1.6e-3);
/// Ouster OS2-128.
pub const OS2_128: Preset = preset("os2_128", &OS2_128_LASERS, [1.0, 240.0], 1.6e-3);

const OS0_32_LASERS: [Laser; 32] = lasers(&OS0);
const OS0_64_LASERS: [Laser; 64] = lasers(&OS0);
const OS0_128_LASERS: [Laser; 128] = lasers(&OS0);
const OS1_32_LASERS: [Laser; 32] = lasers(&OS1);
const OS1_64_LASERS: [Laser; 64] = lasers(&OS1);
const OS1_128_LASERS: [Laser; 128] = lasers(&OS1);
const OS2_32_LASERS: [Laser; 32] = lasers(&OS2);
const OS2_64_LASERS: [Laser; 64] = lasers(&OS2);
const OS2_128_LASERS: [Laser; 128] = lasers(&OS2);

/// The values of `lidar_mode`.
const MODES: [Mode; 5] =
    [turn(1024, 10.0), turn(1024, 20.0), turn(512, 10.0), turn(512, 20.0), turn(2048, 10.0)];

const fn turn(per_turn: u32, rate_hz: f64) -> Mode {
    Mode { columns: Columns::Turn { per_turn, first: 0, count: per_turn }, rate_hz }
}

/// Returns the lasers from the top down: all of 128, or every second or fourth of them, including the lowest.
const fn lasers<const N: usize>(optics: &OusterOptics) -> [Laser; N] {
    let mut made = [Laser::at_degrees(0.0, 0.0); N];
    let mut index = 0;
    while index < N {
        let row = (index + 1) * (128 / N) - 1;
        let from_middle = row as f64 - 63.5;
        let square = from_middle * from_middle;
        let [level, step, cube] = optics.elevation_deg;
        let (azimuth, bend) = optics.azimuths_deg[row % 4];
        let [along, up] = optics.beam_m;
        let elevation = level + step * from_middle + cube * square * from_middle;
        made[index] =
            Laser { origin_m: [along, 0.0, up], ..Laser::at_degrees(elevation, -(azimuth + bend * square)) };
        index += 1;
    }
    made
}

/// Returns a preset whose head points backwards, to its connector, at the beginning of a frame. The axes are those of
/// the sensor (x ahead), with the origin at its bottom.
const fn preset(
    name: &'static str,
    lasers: &'static [Laser],
    range_m: [f64; 2],
    divergence_rad: f64,
) -> Preset {
    Preset {
        name,
        maker: Maker::Ouster,
        pattern: Pattern::Spinning(Spinning {
            lasers,
            columns: MODES[0].columns,
            first_azimuth_rad: PI,
            clockwise: true,
        }),
        modes: &MODES,
        rates_hz: [10.0, 20.0],
        rate_hz: 10.0,
        range_m,
        stddev_m: 0.015,
        spreads: &[],
        bias_stddev_m: 0.0,
        resolution_m: 0.001,
        beam: line_of([divergence_rad; 2], [0.01; 2]),
    }
}
