//! Scanners of Livox.

use super::{Maker, Preset, line_of};
use crate::scanner::{Axis, Beam, Face, Pattern, Prisms, Rosette, Spread, Swing, Wheel, Wheels};
use core::f64::consts::{FRAC_PI_2, PI};

/// Returns a refracting face with a tilt in degrees and the refractive index behind it.
const fn into(tilt_deg: f64, index: f64) -> Face {
    Face::Refracting { tilt_rad: tilt_deg * (PI / 180.0), index }
}

/// Livox Mid-70: one laser behind two prisms, 100 000 points per second in a cone of 70.4°.
///
/// σ is 20 mm; the largest range is 90 m, for a surface of 10 %. Beams are 0.52 × 4.89 mrad wide.
///
/// The prisms turn at 7294 and −4664 rpm, as those of the Mid-40 do (C. Brazeal et al., "A rigorous observation model
/// for the Risley prism-based Livox Mid-40 lidar sensor", Sensors 21:4722, 2021). Wedges of 18° with an index of
/// 1.8144, the flat sides inwards, reproduce the scan table that Livox published for its simulation (400 000 points, 4
/// s): each of its directions comes 10 µs later here, within 0.001°. The rosette repeats every 30 s.
pub const MID_70: Preset = Preset {
    name: "mid70",
    maker: Maker::Livox,
    pattern: Pattern::Rosette(Rosette {
        firing_time_ns: 10_000,
        speeds_rpm: [7294, -4664],
        wedge_rad: 18.0 * (PI / 180.0),
        refractive_index: 1.8144,
        is_flat_inwards: true,
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

/// Livox Mid-360: four lasers that fire at once, 200 000 points per second all around, from −7.2° to 52.2°.
///
/// σ is 30 mm at 0.2 m and 20 mm at 10 m; here the first holds up to 1 m and the second beyond. The largest range is
/// 70 m, for a surface of 80 %.
///
/// The optics reproduce the scan table that Livox published for its simulation (800 000 points, 4 s). Lasers look up,
/// ±0.709° and ±2.126° from the axis. Above them, a wedge of 31.17° with an index of 1.593 turns to the right at 10345
/// rpm; its angle oscillates by 0.15 rad twice in each tenth of a second. A prism with an index of 1.968 and a mirror
/// at 50° turns to the right at 10945 rpm. Directions agree with that table within 0.01°, half of them within 0.0034°;
/// the table is rounded to 0.01°. After the end of the table the scan continues in the same way; it repeats every 12 s.
/// The angular error of the device (less than 0.15°) is not modelled.
pub const MID_360: Preset = Preset {
    name: "mid360",
    maker: Maker::Livox,
    pattern: Pattern::Prisms(Prisms {
        volley_time_ns: 20_000,
        laser_time_ns: 0,
        axis: Axis::Up,
        lasers_rad: &[
            -2.1258 * (PI / 180.0),
            -0.7092 * (PI / 180.0),
            0.7092 * (PI / 180.0),
            2.1258 * (PI / 180.0),
        ],
        wheels: Wheels::new(&[
            Wheel {
                speed_rpm: -10_345,
                phase_rad: 1.549_318,
                swing: Swing { rad: 0.15, rpm: 1200, phase_rad: 0.001_256_6 },
                faces: &[into(0.0, 1.5929), into(31.17, 1.0)],
            },
            Wheel {
                speed_rpm: -10_945,
                phase_rad: -1.582_258,
                swing: Swing::NONE,
                faces: &[
                    into(0.0, 1.9682),
                    Face::Mirror { tilt_rad: -50.0 * (PI / 180.0) },
                    Face::Refracting { tilt_rad: FRAC_PI_2, index: 1.0 },
                ],
            },
        ]),
    }),
    modes: &[],
    rates_hz: [5.0, 50.0],
    rate_hz: 10.0,
    range_m: [0.1, 70.0],
    stddev_m: 0.0,
    spreads: &[
        Spread { from_m: 0.0, stddev: [0.03, 0.0, 0.0] },
        Spread { from_m: 1.0, stddev: [0.02, 0.0, 0.0] },
    ],
    bias_stddev_m: 0.0,
    resolution_m: 0.001,
    beam: Beam::RAY,
};

/// Livox HAP (TX): six lasers that fire one after the other, 452 000 points per second over 120.5° × 26.5°.
///
/// σ is 20 mm at 20 m, and the bias of a run has a σ of 10 mm (a third of ±30 mm). The largest range is 150 m, for a
/// surface of 10 %. Beams are 0.52 × 4.89 mrad wide.
///
/// The optics reproduce the scan table that Livox published for its simulation (1 048 575 points, 2.3 s). Lasers 0.897°
/// apart, one above the other, are behind wedges of 8.3° and 22.8° with an index of 1.605, the slanted sides to the
/// lasers, and one of 22.6° with an index of 1.818, the flat side to them. These turn at −617, 7722 and −7722 rpm.
/// Directions agree with that table within 0.016° in the first tenth of a second, half of them within 0.006°. Firing
/// times do not: the table has 425 000 firings per second, and 550 000 in the middle 40° × 12°, which is 26 % of its
/// points; here firings are evenly spaced, and 22 % are there.
pub const HAP: Preset = Preset {
    name: "hap",
    maker: Maker::Livox,
    pattern: Pattern::Prisms(Prisms {
        volley_time_ns: 13_274,
        laser_time_ns: 2212,
        axis: Axis::Ahead,
        lasers_rad: &[
            5.0 * HAP_LASER_RAD,
            3.0 * HAP_LASER_RAD,
            HAP_LASER_RAD,
            -HAP_LASER_RAD,
            -3.0 * HAP_LASER_RAD,
            -5.0 * HAP_LASER_RAD,
        ],
        wheels: Wheels::new(&[
            Wheel {
                speed_rpm: -617,
                phase_rad: PI,
                swing: Swing::NONE,
                faces: &[into(8.3, 1.6052), into(0.0, 1.0)],
            },
            Wheel {
                speed_rpm: 7722,
                phase_rad: 0.0,
                swing: Swing::NONE,
                faces: &[into(22.8, 1.6052), into(0.0, 1.0)],
            },
            Wheel {
                speed_rpm: -7722,
                phase_rad: 0.0,
                swing: Swing::NONE,
                faces: &[into(0.0, 1.8176), into(-22.6, 1.0)],
            },
        ]),
    }),
    modes: &[],
    rates_hz: [5.0, 50.0],
    rate_hz: 10.0,
    range_m: [0.5, 150.0],
    stddev_m: 0.02,
    spreads: &[],
    bias_stddev_m: 0.01,
    resolution_m: 0.001,
    beam: line_of([0.52e-3, 4.89e-3], [0.0; 2]),
};

/// Half of the angle between two neighbouring lasers of a HAP.
const HAP_LASER_RAD: f64 = 0.4486 * (PI / 180.0);
