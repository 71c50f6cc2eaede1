//! [`Head`]: the directions and times of a scanner's firings, from a maker's preset or from the angles of a `<ray>`.

use crate::description::model::{self, RaySensor};
use crate::rig::lidar::beams;
use belvedere_bridge::ScanGeometry;
use belvedere_sensors::lidar::Beams;
use belvedere_sensors::scanner::presets::Preset;
use belvedere_sensors::scanner::{Columns, Firing, Pattern, ScannerConfig};
use glam::DVec3;
use std::f64::consts::TAU;

/// The directions and times of a scanner's firings.
pub(super) enum Head {
    /// A scanner of a maker.
    Preset(Preset),
    /// A grid with the horizontal and vertical angles of a `<ray>`.
    Grid { angles: [Beams; 2], firings: Vec<Firing> },
}

impl Head {
    pub(super) fn of(lidar: &model::Lidar, frame_time_ns: u64) -> Self {
        match lidar.preset {
            Some(preset) => Self::Preset(preset),
            None => Self::grid([beams(&lidar.ray.horizontal), beams(&lidar.ray.vertical)], frame_time_ns),
        }
    }

    pub(super) fn grid(angles: [Beams; 2], frame_time_ns: u64) -> Self {
        Self::Grid { angles, firings: firings(&angles, frame_time_ns) }
    }

    pub(super) fn pattern(&self) -> Pattern<'_> {
        match self {
            Self::Preset(preset) => preset.pattern,
            Self::Grid { firings, .. } => Pattern::Table(firings),
        }
    }

    /// Returns the elevation of each laser.
    pub(super) fn elevations(&self) -> Vec<f64> {
        match self {
            Self::Preset(Preset { pattern: Pattern::Spinning(head), .. }) => {
                head.lasers.iter().map(|laser| laser.elevation_rad).collect()
            }
            Self::Preset(Preset { pattern: Pattern::Raster(raster), .. }) => {
                let [top, down] = raster.angles(1);
                (0..raster.pixels[1]).map(|row| top - down * f64::from(row)).collect()
            }
            Self::Preset(_) => vec![0.0],
            Self::Grid { angles: [_, vertical], .. } => {
                (0..vertical.samples).map(|row| vertical.angle(row)).collect()
            }
        }
    }

    /// Returns true if it fires all beams at once.
    pub(super) fn is_flash(&self) -> bool {
        matches!(self, Self::Preset(Preset { pattern: Pattern::Raster(raster), .. })
            if raster.pixel_time_ns == 0 && raster.row_time_ns == 0)
    }

    /// Returns the number of firings that belong together: a row of an image, or one of each laser.
    pub(super) fn in_row(&self) -> usize {
        match self {
            Self::Preset(Preset { pattern: Pattern::Raster(raster), .. }) => raster.pixels[0] as usize,
            _ => self.elevations().len(),
        }
    }
}

/// Returns the firings of a grid of beams on a head that makes one turn per frame, clockwise like Velodyne's: the
/// columns one after the other, the beams of a column at once.
fn firings([horizontal, vertical]: &[Beams; 2], frame_time_ns: u64) -> Vec<Firing> {
    // Both ends of a full circle have their own times.
    let turn = TAU.max(horizontal.max_angle_rad - horizontal.min_angle_rad + horizontal.increment());
    let mut firings = Vec::with_capacity(horizontal.samples as usize * vertical.samples as usize);
    for column in (0..horizontal.samples).rev() {
        let azimuth = horizontal.angle(column);
        let (sin, cos) = libm::sincos(azimuth);
        let begun = (horizontal.max_angle_rad - azimuth).max(0.0) / turn;
        let time_s = frame_time_ns as f64 * 1e-9 * begun;
        for row in 0..vertical.samples {
            let (up, along) = libm::sincos(vertical.angle(row));
            let direction = DVec3::new(along * cos, along * sin, up);
            firings.push(Firing { time_s, origin: DVec3::ZERO, direction, laser: row });
        }
    }
    firings
}

/// Returns the geometry of a scan with a single beam that is measured at even steps; the times are set later.
pub(super) fn angles(head: &Head, ray: &RaySensor) -> ScanGeometry {
    let (mut angle_min, mut angle_increment) = (ray.horizontal.min_angle_rad, 0.0);
    if let Head::Preset(Preset { pattern: Pattern::Spinning(head), .. }) = head
        && let Columns::Turn { per_turn, first, .. } = head.columns
    {
        angle_increment = TAU / f64::from(per_turn);
        angle_min = head.first_azimuth_rad + f64::from(first) * angle_increment;
    }
    ScanGeometry {
        angle_min,
        angle_increment,
        time_increment: 0.0,
        scan_time: 0.0,
        range_min: ray.range_min_m as f32,
        range_max: ray.range_max_m as f32,
        vertical_angle_min: 0.0,
        vertical_angle_increment: 0.0,
        reserved: [0; 19],
    }
}

/// Returns the scanner's configuration with its pattern.
pub(super) fn config_of<'a>(config: &ScannerConfig<'a>, head: &'a Head) -> ScannerConfig<'a> {
    config.pattern(head.pattern())
}
