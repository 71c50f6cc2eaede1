//! Scanners as their makers' manuals have them.

use super::{Columns, Laser, Pattern, ScannerConfig, Spinning, Spread};
use crate::noise::GaussianNoise;
use core::f64::consts::TAU;

/// A scanner of a maker: what of it is fixed. How fast its head turns is chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Preset {
    /// What files call it.
    pub name: &'static str,
    /// Lasers and firings.
    pub pattern: Pattern<'static>,
    /// Slowest and fastest head, in turns a second.
    pub rates_hz: [f64; 2],
    /// Turns a second as it comes.
    pub rate_hz: f64,
    /// Smallest and largest range, in metres.
    pub range_m: [f64; 2],
    /// Standard deviation of a range, in metres; where data sheets promise bounds, a third of them.
    pub stddev_m: f64,
    /// What depends on the range of it.
    pub spreads: &'static [Spread],
    /// Standard deviation of what all ranges of a run are wrong by, in metres.
    pub bias_stddev_m: f64,
    /// Step of a range, in metres.
    pub resolution_m: f64,
}

impl Preset {
    /// A scanner as it is, from one turn to the next in so many nanoseconds; of seed and number 0.
    ///
    /// ```
    /// use belvedere_sensors::scanner::{Scanner, presets::VLP_16};
    /// let scanner = Scanner::new(VLP_16.config(100_000_000))?;
    /// assert_eq!(scanner.firings(0), 1809 * 16);
    /// assert!((scanner.firing(0, 1).direction.z - 1_f64.to_radians().sin()).abs() < 1e-12);
    /// # Ok::<(), belvedere_sensors::scanner::ScannerError>(())
    /// ```
    #[must_use]
    pub fn config(&self, frame_time_ns: u64) -> ScannerConfig<'static> {
        let [stddev, bias, step] = [self.stddev_m, self.bias_stddev_m, self.resolution_m].map(|x| x as f32);
        let noise = GaussianNoise::new(0.0, stddev, 0.0, bias, step);
        let [min_m, max_m] = self.range_m;
        ScannerConfig::new(self.pattern)
            .frame_time_ns(frame_time_ns)
            .range_min_m(min_m)
            .range_max_m(max_m)
            .noise(noise.unwrap_or_default())
            .spreads(self.spreads)
    }
}

/// Velodyne VLP-16 (User Manual 63-9243): 16 lasers that fire one after the other, each a little above its like.
pub const VLP_16: Preset = Preset {
    name: "vlp16",
    pattern: clockwise(&VLP_16_LASERS, 55_296),
    rates_hz: [5.0, 20.0],
    rate_hz: 10.0,
    range_m: [1.0, 100.0],
    stddev_m: 0.01,
    spreads: &[],
    bias_stddev_m: 0.0,
    resolution_m: 0.002,
};

/// Velodyne HDL-32E (User's Manual): 32 lasers.
pub const HDL_32E: Preset = Preset {
    name: "hdl32e",
    pattern: clockwise(&HDL_32E_LASERS, 46_080),
    rates_hz: [5.0, 20.0],
    rate_hz: 10.0,
    range_m: [0.05, 100.0],
    stddev_m: 0.02 / 3.0,
    spreads: &[],
    bias_stddev_m: 0.0,
    resolution_m: 0.002,
};

/// Hokuyo URG-04LX (specification C-42-03320): 682 of 1024 steps of a turn, ±10 mm up to a metre and 1 % beyond.
pub const URG_04LX: Preset = Preset {
    name: "urg04lx",
    pattern: steps(1024, 44, 682, 384),
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
};

/// Hokuyo UTM-30LX: 1081 of 1440 steps of a turn; repeatability σ 10 mm up to 10 m, 30 mm beyond.
pub const UTM_30LX: Preset = Preset {
    name: "utm30lx",
    pattern: steps(1440, 0, 1081, 540),
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
};

/// SICK LMS111 at 25 Hz: 270° by 0.25°; statistical error σ 12 mm, systematic ±30 mm.
pub const LMS_111: Preset = Preset {
    name: "lms111",
    pattern: steps(1440, 0, 1081, 540),
    rates_hz: [25.0, 25.0],
    rate_hz: 25.0,
    range_m: [0.5, 20.0],
    stddev_m: 0.012,
    spreads: &[],
    bias_stddev_m: 0.01,
    resolution_m: 0.001,
};

/// Slamtec RPLIDAR A1M8 (data sheet rev. 1.0): 360 beams; triangulation errs by 3.3·10⁻⁴·r².
pub const RPLIDAR_A1: Preset = Preset {
    name: "rplidar_a1",
    pattern: steps(360, 0, 360, 180),
    rates_hz: [1.0, 10.0],
    rate_hz: 5.5,
    range_m: [0.15, 12.0],
    stddev_m: 0.0,
    spreads: &[Spread { from_m: 0.0, stddev: [0.0, 0.0, 3.3e-4] }],
    bias_stddev_m: 0.0,
    resolution_m: 0.000_25,
};

/// Slamtec RPLIDAR A2M8 (data sheet rev. 2.5): 800 beams, within 1 %.
pub const RPLIDAR_A2: Preset = Preset {
    name: "rplidar_a2",
    pattern: steps(800, 0, 800, 400),
    rates_hz: [5.0, 15.0],
    rate_hz: 10.0,
    range_m: [0.2, 12.0],
    stddev_m: 0.0,
    spreads: &[Spread { from_m: 0.0, stddev: [0.0, 0.01 / 3.0, 0.0] }],
    bias_stddev_m: 0.0,
    resolution_m: 0.000_25,
};

/// All presets.
pub const ALL: [Preset; 7] = [VLP_16, HDL_32E, URG_04LX, UTM_30LX, LMS_111, RPLIDAR_A1, RPLIDAR_A2];

/// The preset that files call so.
#[must_use]
pub fn named(name: &str) -> Option<Preset> {
    ALL.into_iter().find(|preset| preset.name == name)
}

/// Elevation in degrees and height of the beam's origin in millimetres, −41.91·tan of the elevation.
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

/// The same; the origins are −28.95·tan of the elevation.
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

/// Lasers by elevation and height, so many seconds from one to the next.
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

/// A single beam.
const LEVEL: [Laser; 1] = [Laser::at_degrees(0.0, 0.0)];

/// A single beam that is measured at some steps of a turn, counter-clockwise; `ahead` is the step at which it looks there.
const fn steps(per_turn: u32, first: u32, count: u32, ahead: u32) -> Pattern<'static> {
    Pattern::Spinning(Spinning {
        lasers: &LEVEL,
        columns: Columns::Turn { per_turn, first, count },
        first_azimuth_rad: -TAU * ahead as f64 / per_turn as f64,
        clockwise: false,
    })
}

/// A head that looks ahead when a frame begins, and turns as Velodyne's do.
const fn clockwise(lasers: &'static [Laser], column_ns: u64) -> Pattern<'static> {
    Pattern::Spinning(Spinning {
        lasers,
        columns: Columns::Every { time_ns: column_ns },
        first_azimuth_rad: 0.0,
        clockwise: true,
    })
}
