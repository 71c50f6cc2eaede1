//! Scanner presets, from the manuals of their makers.

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

/// The maker of a scanner, from which a driver knows the format of its messages.
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

/// An operating mode of a spinning head: columns and rotation rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mode {
    /// The columns of a turn.
    pub columns: Columns,
    /// The rotation rate, in turns per second.
    pub rate_hz: f64,
}

/// A scanner of a maker. It holds the fixed properties; the frame rate is chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Preset {
    /// The name by which files refer to the scanner.
    pub name: &'static str,
    /// The maker.
    pub maker: Maker,
    /// The firing pattern; if there are several modes, that of the default one.
    pub pattern: Pattern<'static>,
    /// The operating modes. If the list is empty, any frame rate within `rates_hz` is possible.
    pub modes: &'static [Mode],
    /// The lowest and the highest frame rate, in Hz. For a spinning head this is the rotation rate.
    pub rates_hz: [f64; 2],
    /// The default frame rate, in Hz.
    pub rate_hz: f64,
    /// The smallest and the largest range, in metres.
    pub range_m: [f64; 2],
    /// The standard deviation of a range, in metres; a third of the bounds if a data sheet gives bounds.
    pub stddev_m: f64,
    /// Additional range noise that depends on the range.
    pub spreads: &'static [Spread],
    /// The standard deviation of the bias that all ranges of a run have in common, in metres.
    pub bias_stddev_m: f64,
    /// The resolution of a range, in metres.
    pub resolution_m: f64,
    /// The size of the beams, which are traced as single rays; without width if nothing is published.
    pub beam: Beam,
}

impl Preset {
    /// Returns the configuration of the scanner at the preset's frame rate (`rate_hz`), with seed and sensor number 0.
    /// Another rate is set by [`ScannerConfig::frame_time_ns`], or taken from the operating modes by
    /// [`Preset::in_mode`].
    ///
    /// Intensities are the `laser_retro` of instances, which is 0 unless it is set: choose
    /// [`Intensity::Reflectivity`](super::Intensity::Reflectivity) for intensities that follow from materials.
    ///
    /// ```
    /// use belvedere_sensors::scanner::{Scanner, presets::VLP_16};
    /// let scanner = Scanner::new(VLP_16.config())?; // ten turns per second
    /// assert_eq!(scanner.firings(0), 1809 * 16);
    /// assert!((scanner.firing(0, 1).direction.z - 1_f64.to_radians().sin()).abs() < 1e-12);
    ///
    /// let fast = Scanner::new(VLP_16.config().frame_time_ns(50_000_000))?;
    /// assert_eq!(fast.firings(0), 905 * 16);
    /// # Ok::<(), belvedere_sensors::ParameterError>(())
    /// ```
    #[must_use]
    pub fn config(&self) -> ScannerConfig<'static> {
        let [stddev, bias, step] = [self.stddev_m, self.bias_stddev_m, self.resolution_m].map(|x| x as f32);
        let noise = GaussianNoiseConfig::default().stddev(stddev).bias_stddev(bias).precision(step);
        let [min_m, max_m] = self.range_m;
        ScannerConfig::new(self.pattern)
            .frame_time_ns(libm::round(1e9 / self.rate_hz) as u64)
            .range_min_m(min_m)
            .range_max_m(max_m)
            .noise(GaussianNoise::new(noise).unwrap_or_default())
            .spreads(self.spreads)
            .beam(self.beam)
    }

    /// Returns the number of columns per frame, or `None` if the scanner has no operating modes.
    #[must_use]
    pub fn columns(&self) -> Option<u32> {
        match self.pattern {
            Pattern::Spinning(head) if !self.modes.is_empty() => u32::try_from(head.columns.at_angles()).ok(),
            _ => None,
        }
    }

    /// Returns the preset with this number of columns per frame and this frame rate; `None` for either accepts any
    /// value.
    ///
    /// It is the first operating mode that matches. Returns `None` if no mode matches.
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

preset_names!(ALL: Preset);

/// Returns a beam that is traced as a single ray. Its width is used for counting raindrops and snowflakes in it.
const fn line_of(divergence_rad: [f64; 2], aperture_m: [f64; 2]) -> Beam {
    Beam { divergence_rad, aperture_m, rays: 1 }
}

/// A single laser at elevation 0 and azimuth 0.
const LEVEL: [Laser; 1] = [Laser::at_degrees(0.0, 0.0)];

/// Returns columns that cover a part of a turn.
const fn some(per_turn: u32, first: u32, count: u32) -> Columns {
    Columns::Turn { per_turn, first, count }
}

/// Returns a pattern with a single beam at some steps of a turn, counter-clockwise. The beam points ahead at step
/// `ahead`.
const fn steps(columns: Columns, ahead: u32) -> Pattern<'static> {
    let per_turn = if let Columns::Turn { per_turn, .. } = columns { per_turn } else { 1 };
    Pattern::Spinning(Spinning {
        lasers: &LEVEL,
        columns,
        first_azimuth_rad: -TAU * ahead as f64 / per_turn as f64,
        clockwise: false,
    })
}
