//! Scanners as their makers' manuals have them.

mod continental;
mod hokuyo;
mod livox;
mod ouster;
mod sick;
mod slamtec;
mod velodyne;
mod vls128;

use super::{Beam, Columns, Laser, Pattern, ScannerConfig, Spinning, Spread};
use crate::noise::{GaussianNoise, GaussianNoiseConfig};
pub use continental::HFL_110;
use core::f64::consts::TAU;
pub use hokuyo::{URG_04LX, UTM_30LX};
pub use livox::{HAP, MID_70, MID_360};
pub use ouster::{OS0_32, OS0_64, OS0_128, OS1_32, OS1_64, OS1_128, OS2_32, OS2_64, OS2_128};
pub use sick::{LMS_111, LMS_511};
pub use slamtec::{RPLIDAR_A1, RPLIDAR_A2};
pub use velodyne::{HDL_32E, VLP_16};
pub use vls128::VLS_128;

/// Who makes scanners; by which a driver knows how to send what they measure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Maker {
    /// Continental.
    Continental,
    /// Hokuyo.
    Hokuyo,
    /// Livox.
    Livox,
    /// Ouster.
    Ouster,
    /// SICK.
    Sick,
    /// Slamtec.
    Slamtec,
    /// Velodyne.
    Velodyne,
}

/// A choice of columns and turns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mode {
    /// The columns of a turn.
    pub columns: Columns,
    /// Turns a second.
    pub rate_hz: f64,
}

/// A scanner of a maker: what of it is fixed. How fast its head turns is chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Preset {
    /// What files call it.
    pub name: &'static str,
    /// Who makes it.
    pub maker: Maker,
    /// Lasers and firings; as it comes, if there is a choice of columns.
    pub pattern: Pattern<'static>,
    /// The choices of columns and turns that it has; none if it turns at any rate in its bounds.
    pub modes: &'static [Mode],
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
    /// How wide its beams are, as single rays; lines where nothing is published.
    pub beam: Beam,
}

impl Preset {
    /// A scanner as it is, from one turn to the next in so many nanoseconds; of seed and number 0.
    ///
    /// ```
    /// use belvedere_sensors::scanner::{Scanner, presets::VLP_16};
    /// let scanner = Scanner::new(VLP_16.config(100_000_000))?;
    /// assert_eq!(scanner.firings(0), 1809 * 16);
    /// assert!((scanner.firing(0, 1).direction.z - 1_f64.to_radians().sin()).abs() < 1e-12);
    /// # Ok::<(), belvedere_sensors::ParameterError>(())
    /// ```
    #[must_use]
    pub fn config(&self, frame_time_ns: u64) -> ScannerConfig<'static> {
        let [stddev, bias, step] = [self.stddev_m, self.bias_stddev_m, self.resolution_m].map(|x| x as f32);
        let noise = GaussianNoiseConfig::default().stddev(stddev).bias_stddev(bias).precision(step);
        let [min_m, max_m] = self.range_m;
        ScannerConfig::new(self.pattern)
            .frame_time_ns(frame_time_ns)
            .range_min_m(min_m)
            .range_max_m(max_m)
            .noise(GaussianNoise::new(noise).unwrap_or_default())
            .spreads(self.spreads)
            .beam(self.beam)
    }

    /// Columns of a frame; none if there is no choice of them.
    #[must_use]
    pub fn columns(&self) -> Option<u32> {
        match self.pattern {
            Pattern::Spinning(head) if !self.modes.is_empty() => u32::try_from(head.columns.at_angles()).ok(),
            _ => None,
        }
    }

    /// The same with so many columns a frame and turns a second: the first of its choices that has what is said of
    /// both. None if it has no such choice.
    ///
    /// ```
    /// use belvedere_sensors::scanner::presets::OS1_128;
    /// assert_eq!(OS1_128.in_mode(Some(2048), None).map(|preset| preset.rate_hz), Some(10.0));
    /// assert_eq!(OS1_128.in_mode(Some(2048), Some(20.0)), None);
    /// ```
    #[must_use]
    pub fn in_mode(&self, columns: Option<u32>, rate_hz: Option<f64>) -> Option<Self> {
        if self.modes.is_empty() {
            let [slowest, fastest] = self.rates_hz;
            let rate_hz = rate_hz.unwrap_or(self.rate_hz);
            let is_one = columns.is_none() && (slowest..=fastest).contains(&rate_hz);
            return is_one.then_some(Self { rate_hz, ..*self });
        }
        let mode = self.modes.iter().find(|mode| {
            columns.is_none_or(|columns| mode.columns.at_angles() == u64::from(columns))
                && rate_hz.is_none_or(|rate_hz| mode.rate_hz == rate_hz)
        })?;
        let mut preset = Self { rate_hz: mode.rate_hz, ..*self };
        if let Pattern::Spinning(head) = &mut preset.pattern {
            head.columns = mode.columns;
        }
        Some(preset)
    }
}

/// All presets.
pub const ALL: &[Preset] = &[
    HFL_110, URG_04LX, UTM_30LX, HAP, MID_70, MID_360, OS0_32, OS0_64, OS0_128, OS1_32, OS1_64, OS1_128,
    OS2_32, OS2_64, OS2_128, LMS_111, LMS_511, RPLIDAR_A1, RPLIDAR_A2, HDL_32E, VLP_16, VLS_128,
];

/// The names of all.
pub const NAMES: [&str; ALL.len()] = {
    let mut names = [""; ALL.len()];
    let mut index = 0;
    while index < ALL.len() {
        names[index] = ALL[index].name;
        index += 1;
    }
    names
};

/// The preset that files call so.
#[must_use]
pub fn named(name: &str) -> Option<Preset> {
    ALL.iter().find(|preset| preset.name == name).copied()
}

/// A beam that is traced as a single ray, and is so wide: what drops of rain in it are counted by.
const fn line_of(divergence_rad: [f64; 2], aperture_m: [f64; 2]) -> Beam {
    Beam { divergence_rad, aperture_m, rays: 1 }
}

/// A single beam.
const LEVEL: [Laser; 1] = [Laser::at_degrees(0.0, 0.0)];

/// So many columns of a turn.
const fn some(per_turn: u32, first: u32, count: u32) -> Columns {
    Columns::Turn { per_turn, first, count }
}

/// A single beam that is measured at some steps of a turn, counter-clockwise; `ahead` is the step at which it looks there.
const fn steps(columns: Columns, ahead: u32) -> Pattern<'static> {
    let per_turn = if let Columns::Turn { per_turn, .. } = columns { per_turn } else { 1 };
    Pattern::Spinning(Spinning {
        lasers: &LEVEL,
        columns,
        first_azimuth_rad: -TAU * ahead as f64 / per_turn as f64,
        clockwise: false,
    })
}
