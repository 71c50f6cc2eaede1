//! Laser beams of finite width, sampled by several rays.

use super::firing::Firing;
use crate::ParameterError;
use crate::simd::{sin_cos, sqrt};
use core::f64::consts::TAU;
use glam::DVec3;

/// The largest number of rays of a beam.
pub const MAX_BEAM_RAYS: usize = 19;

/// The cross section of a laser beam: an ellipse of uniform brightness that grows with the range.
///
/// A beam is sampled by rays that represent equal areas: one in the middle and the others evenly spaced on rings around
/// it, as in HELIOS++ (L. Winiwarter et al., 2022, doi:10.1016/j.rse.2021.112772). The radius of a ring halves the area
/// that its rays represent; its first ray lies to the left.
///
/// | `rays` | rings: rays at share of the radius |
/// |---:|---|
/// | 1 | 1 at 0 |
/// | 7 | 1 at 0, 6 at 0.756 |
/// | 8 | 1 at 0, 7 at 0.75 |
/// | 19 | 1 at 0, 6 at 0.459, 12 at 0.827 |
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beam {
    /// The full divergence, horizontal and vertical, in radians: 0 to 0.2.
    pub divergence_rad: [f64; 2],
    /// The width and height of the beam where it leaves the scanner, in metres: 0 to 0.2.
    pub aperture_m: [f64; 2],
    /// The number of rays that sample the beam: 1, 7, 8 or 19.
    pub rays: u32,
}

/// Stray light around the beam, from the lens and from what lies on it: a disc of uniform brightness, sampled by eight
/// rays on a ring of 0.707 of its radius.
///
/// From most surfaces it is too weak to be detected. But a retroreflector sends back up to a hundred times as much
/// light and blooms: beams beside it have a return at its range, and it looks larger.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Halo {
    /// The share of the light that is stray light, 0 to 0.5.
    pub share: f64,
    /// The radius of the disc, 0 to 0.2 rad.
    pub radius_rad: f64,
}

impl Halo {
    /// No light beside the beam.
    pub const NONE: Self = Self { share: 0.0, radius_rad: 0.0 };

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        let wrong = |parameter, value, rule| Err(ParameterError::new("scanner", parameter, value, rule));
        if !(0.0..=0.5).contains(&self.share) {
            return wrong("share of the halo", self.share, "0 to 0.5");
        }
        if !(0.0..=0.2).contains(&self.radius_rad) {
            return wrong("radius_rad of the halo", self.radius_rad, "0 to 0.2 rad");
        }
        Ok(())
    }
}

/// The number of rays of a halo.
const HALO_RAYS: usize = 8;
/// The largest number of rays of a beam and its halo.
pub(super) const MOST_RAYS: usize = MAX_BEAM_RAYS + HALO_RAYS;

impl Beam {
    /// A single, infinitely thin ray.
    pub const RAY: Self = Self { divergence_rad: [0.0; 2], aperture_m: [0.0; 2], rays: 1 };

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        let wrong = |parameter, value, rule| Err(ParameterError::new("scanner", parameter, value, rule));
        let within = 0.0..=0.2;
        if let Some(value) = self.divergence_rad.into_iter().find(|value| !within.contains(value)) {
            return wrong("divergence_rad of the beam", value, "0 to 0.2 rad");
        }
        if let Some(value) = self.aperture_m.into_iter().find(|value| !within.contains(value)) {
            return wrong("aperture_m of the beam", value, "0 to 0.2 m");
        }
        if ring(self.rays).is_none() {
            return wrong("rays of the beam", f64::from(self.rays), "1, 7, 8 or 19");
        }
        Ok(())
    }
}

/// Returns the numbers of rays on the rings of a beam with this total; `None` if no beam has so many.
const fn ring(rays: u32) -> Option<[u32; 3]> {
    match rays {
        1 => Some([1, 0, 0]),
        7 => Some([1, 6, 0]),
        8 => Some([1, 7, 0]),
        19 => Some([1, 6, 12]),
        _ => None,
    }
}

/// The rays of a beam, relative to its middle.
#[derive(Debug, Clone, Copy)]
pub(super) struct BeamRays {
    /// The number of rays of the beam and its halo.
    pub(super) rays: usize,
    /// The number of rays of the beam alone, which come first.
    pub(super) own: usize,
    /// The offsets of the rays from the middle, left and up: at the start in metres, and their growth per metre.
    starts: [[f64; 2]; MOST_RAYS],
    slopes: [[f64; 2]; MOST_RAYS],
    /// The shares of the light that one ray of the beam and one of the halo represent.
    shares: [f64; 2],
}

impl BeamRays {
    pub(super) fn new(beam: &Beam, halo: &Halo) -> Self {
        let slope = beam.divergence_rad.map(|angle| tan(0.5 * angle));
        let half = beam.aperture_m.map(|width| 0.5 * width);
        let (mut starts, mut slopes) = ([[0.0; 2]; MOST_RAYS], [[0.0; 2]; MOST_RAYS]);
        let mut rays = 0;
        for count in ring(beam.rays).unwrap_or([1, 0, 0]) {
            let radius = sqrt((rays as f64 + 0.5 * f64::from(count)) / f64::from(beam.rays));
            let radius = if rays == 0 { 0.0 } else { radius };
            for ray in 0..count {
                let (up, left) = sin_cos(TAU * f64::from(ray) / f64::from(count));
                let place = [radius * left, radius * up];
                starts[rays] = [place[0] * half[0], place[1] * half[1]];
                slopes[rays] = [place[0] * slope[0], place[1] * slope[1]];
                rays += 1;
            }
        }
        let own = rays;
        if halo.share > 0.0 {
            let radius = tan(halo.radius_rad * sqrt(0.5));
            for ray in 0..HALO_RAYS {
                let (up, left) = sin_cos(TAU * ray as f64 / HALO_RAYS as f64);
                slopes[rays] = [radius * left, radius * up];
                rays += 1;
            }
        }
        let shares = [(1.0 - halo.share) / own as f64, halo.share / HALO_RAYS as f64];
        Self { rays, own, starts, slopes, shares }
    }

    /// Returns the share of the light that a ray represents.
    #[inline(always)]
    pub(super) fn share(&self, ray: usize) -> f64 {
        self.shares[usize::from(ray >= self.own)]
    }

    /// Returns the axes of the cross section of a firing's beam: left and up.
    #[inline(always)]
    pub(super) fn axes(firing: &Firing) -> [DVec3; 2] {
        let ahead = firing.direction;
        // For a beam straight up or down, left is that of the sensor.
        let left = DVec3::new(-ahead.y, ahead.x, 0.0);
        let level = left.length_squared();
        let left = if level > 1e-20 { left * (1.0 / sqrt(level)) } else { DVec3::Y };
        [left, ahead.cross(left)]
    }

    /// Returns the start and the unit direction of a ray of a beam with this origin, direction and cross section.
    #[inline(always)]
    pub(super) fn ray(&self, ray: usize, origin: DVec3, ahead: DVec3, [left, up]: [DVec3; 2]) -> [DVec3; 2] {
        let ([x, y], [aside, above]) = (self.starts[ray], self.slopes[ray]);
        let direction = ahead + left * aside + up * above;
        let direction = direction * (1.0 / sqrt(direction.length_squared()));
        [origin + left * x + up * y, direction]
    }
}

fn tan(angle: f64) -> f64 {
    let (sin, cos) = sin_cos(angle);
    sin / cos
}
