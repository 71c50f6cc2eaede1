//! Scanners with a spinning head: lasers above each other, columns side by side.

use super::clock::{Clock, Ticks};
use super::firing::FiringLanes;
use crate::ParameterError;
use crate::simd::{LANES, sin_cos};
use core::f64::consts::{FRAC_PI_2, PI, TAU};

/// The largest number of lasers of a head.
pub const MAX_LASERS: usize = 4096;

/// A laser of a spinning head.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Laser {
    /// The elevation above the plane in which the head turns, in radians.
    pub elevation_rad: f64,
    /// The azimuth relative to the direction of the head, counter-clockwise, in radians.
    pub azimuth_rad: f64,
    /// The origin of the beam in metres, in axes that turn with the head: x in the direction of the head, z up.
    pub origin_m: [f64; 3],
    /// The time of firing in seconds after the beginning of its column.
    pub time_s: f64,
}

impl Laser {
    /// Creates a laser on the axis that fires at the beginning of its column. The angles are in degrees, as in data
    /// sheets.
    pub const fn at_degrees(elevation: f64, azimuth: f64) -> Self {
        Self {
            elevation_rad: elevation * (PI / 180.0),
            azimuth_rad: azimuth * (PI / 180.0),
            origin_m: [0.0; 3],
            time_s: 0.0,
        }
    }
}

/// The times at which the columns of a turn are fired. Each laser fires once per column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Columns {
    /// Columns at fixed angles: a turn is divided into `per_turn` columns, some of which are fired.
    Turn {
        /// The number of columns of a whole turn, 1 or more.
        per_turn: u32,
        /// The number of the first column that is fired, counted from 0.
        first: u32,
        /// The number of columns that are fired, 1 or more.
        count: u32,
    },
    /// Columns at fixed times, whatever the angle of the head. The number of columns may differ by one from frame to
    /// frame.
    Every {
        /// The time from one column to the next, in nanoseconds.
        time_ns: u64,
    },
}

impl Columns {
    /// Returns the number of columns per frame if they are at fixed angles, and 0 if they are at fixed times.
    #[must_use]
    pub const fn at_angles(self) -> u64 {
        match self {
            Self::Turn { count, .. } => count as u64,
            Self::Every { .. } => 0,
        }
    }
}

/// Lasers on a head that turns uniformly, once per frame.
///
/// Firings are in the order of time: column by column, and in each column all lasers in their order. The head continues
/// to turn between the lasers of a column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spinning<'a> {
    /// The lasers, in the order in which they fire.
    pub lasers: &'a [Laser],
    /// The times of the columns.
    pub columns: Columns,
    /// The azimuth of the head at the beginning of a frame, in radians, counter-clockwise from +x: -2π to 2π.
    pub first_azimuth_rad: f64,
    /// Whether the head turns clockwise, seen from above.
    pub clockwise: bool,
}

impl Spinning<'_> {
    pub(super) fn check(&self, frame_time_ns: u64) -> Result<(), ParameterError> {
        let wrong = |parameter, value, rule| Err(ParameterError::new("scanner", parameter, value, rule));
        if !(1..=MAX_LASERS).contains(&self.lasers.len()) {
            return wrong("number of lasers", self.lasers.len() as f64, "1 to 4096");
        }
        if !(-TAU..=TAU).contains(&self.first_azimuth_rad) {
            return wrong("first_azimuth_rad", self.first_azimuth_rad, "-2π to 2π");
        }
        match self.columns {
            Columns::Turn { per_turn: 0, .. } => return wrong("per_turn", 0.0, "1 or more"),
            Columns::Turn { count: 0, .. } => return wrong("count", 0.0, "1 or more"),
            Columns::Turn { per_turn, first, count }
                if u64::from(first) + u64::from(count) > per_turn.into() =>
            {
                return wrong("first + count", f64::from(first) + f64::from(count), "no more than per_turn");
            }
            Columns::Every { time_ns } => {
                Clock { tick_ns: time_ns }.check("time_ns of columns", frame_time_ns)?;
            }
            Columns::Turn { .. } => {}
        }
        let (column_s, mut before) = (self.column_time_s(frame_time_ns), 0.0);
        for (index, laser) in self.lasers.iter().enumerate() {
            let wrong = |parameter, value, rule| {
                Err(ParameterError::new("scanner", parameter, value, rule).at(index))
            };
            if !(-FRAC_PI_2..=FRAC_PI_2).contains(&laser.elevation_rad) {
                return wrong("elevation_rad of laser", laser.elevation_rad, "-π/2 to π/2");
            }
            if !(-TAU..=TAU).contains(&laser.azimuth_rad) {
                return wrong("azimuth_rad of laser", laser.azimuth_rad, "-2π to 2π");
            }
            if let Some(value) = laser.origin_m.into_iter().find(|value| !(-100.0..=100.0).contains(value)) {
                return wrong("origin_m of laser", value, "-100 to 100 m");
            }
            if !(before..column_s).contains(&laser.time_s) {
                return wrong(
                    "time_s of laser",
                    laser.time_s,
                    "not before that of the previous laser, and less than a column's (frame_time_ns / per_turn)",
                );
            }
            before = laser.time_s;
        }
        Ok(())
    }

    /// Returns the time from one column to the next, in seconds.
    fn column_time_s(&self, frame_time_ns: u64) -> f64 {
        match self.columns {
            Columns::Turn { per_turn, .. } => frame_time_ns as f64 * 1e-9 / f64::from(per_turn),
            Columns::Every { time_ns } => time_ns as f64 * 1e-9,
        }
    }

    pub(super) fn most_firings(&self, frame_time_ns: u64) -> u128 {
        let columns = match self.columns {
            Columns::Turn { count, .. } => u64::from(count),
            Columns::Every { time_ns } => Clock { tick_ns: time_ns }.most(frame_time_ns),
        };
        u128::from(columns) * self.lasers.len() as u128
    }

    /// Returns the clock of columns at fixed times.
    pub(super) fn clock(&self) -> Option<Clock> {
        match self.columns {
            Columns::Turn { .. } => None,
            Columns::Every { time_ns } => Some(Clock { tick_ns: time_ns }),
        }
    }

    pub(super) fn time_s(&self, ticks: Option<&Ticks>, frame_time_ns: u64, index: usize) -> f64 {
        let (column, laser) = (index / self.lasers.len(), index % self.lasers.len());
        self.column_s(ticks, frame_time_ns, column) + self.lasers[laser].time_s
    }

    /// Returns the beginning of a column, in seconds after the beginning of the frame.
    #[inline(always)]
    fn column_s(&self, ticks: Option<&Ticks>, frame_time_ns: u64, column: usize) -> f64 {
        match (self.columns, ticks) {
            (Columns::Every { .. }, Some(ticks)) => ticks.time_s(column as u64),
            (Columns::Turn { first, .. }, _) => {
                (u64::from(first) + column as u64) as f64 * self.column_time_s(frame_time_ns)
            }
            (Columns::Every { time_ns }, None) => column as f64 * (time_ns as f64 * 1e-9),
        }
    }

    #[inline(always)]
    pub(super) fn fill(
        &self,
        ticks: Option<&Ticks>,
        frame_time_ns: u64,
        (first, count): (usize, usize),
        lanes: &mut FiringLanes,
    ) {
        let (mut column, mut number) = (first / self.lasers.len(), first % self.lasers.len());
        let mut column_s = self.column_s(ticks, frame_time_ns, column);
        let (mut azimuth, mut elevation, mut arm) = ([0.0; LANES], [0.0; LANES], [[0.0; LANES]; 2]);
        for lane in 0..count {
            let laser = &self.lasers[number];
            lanes.laser[lane] = number as u32;
            lanes.time_s[lane] = column_s + laser.time_s;
            (azimuth[lane], elevation[lane]) = (laser.azimuth_rad, laser.elevation_rad);
            [arm[0][lane], arm[1][lane], lanes.origin[2][lane]] = laser.origin_m;
            number += 1;
            if number == self.lasers.len() {
                (number, column) = (0, column + 1);
                column_s = self.column_s(ticks, frame_time_ns, column);
            }
        }
        let turn_s = frame_time_ns as f64 * 1e-9;
        let sense = if self.clockwise { -TAU } else { TAU };
        for lane in 0..LANES {
            let head = self.first_azimuth_rad + sense * (lanes.time_s[lane] / turn_s);
            let (sin, cos) = sin_cos(head + azimuth[lane]);
            let (up, level) = sin_cos(elevation[lane]);
            lanes.direction[0][lane] = cos * level;
            lanes.direction[1][lane] = sin * level;
            lanes.direction[2][lane] = up;
            azimuth[lane] = head;
        }
        if self.lasers.iter().all(|laser| laser.origin_m[0] == 0.0 && laser.origin_m[1] == 0.0) {
            (lanes.origin[0], lanes.origin[1]) = ([0.0; LANES], [0.0; LANES]);
            return;
        }
        for lane in 0..LANES {
            let ((sin, cos), [x, y]) = (sin_cos(azimuth[lane]), [arm[0][lane], arm[1][lane]]);
            lanes.origin[0][lane] = cos * x - sin * y;
            lanes.origin[1][lane] = sin * x + cos * y;
        }
    }
}
