//! The beam of a laser as wide as it is: rays that stand for parts of it.

use super::firing::Firing;
use crate::ParameterError;
use crate::simd::{sin_cos, sqrt};
use core::f64::consts::TAU;
use glam::DVec3;

/// Most rays of a beam.
pub const MAX_BEAM_RAYS: usize = 19;

/// The cross section of a laser's beam: an ellipse, all of it equally bright, that grows with the range.
///
/// It is traced as rays, each of which stands for as much of the area as the others: one in the middle, and the others evenly on
/// rings around it, as HELIOS++ has them (L. Winiwarter et al., 2022, doi:10.1016/j.rse.2021.112772). A ring's radius is
/// that which halves the area that its rays stand for; its first ray lies to the left.
///
/// | `rays` | rings: rays at share of the radius |
/// |---:|---|
/// | 1 | 1 at 0 |
/// | 7 | 1 at 0, 6 at 0.756 |
/// | 8 | 1 at 0, 7 at 0.75 |
/// | 19 | 1 at 0, 6 at 0.459, 12 at 0.827 |
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beam {
    /// Angle by which it widens, from side to side, and from top to bottom: radians, 0 to 0.2.
    pub divergence_rad: [f64; 2],
    /// Its width and height where it leaves the scanner: metres, 0 to 0.2.
    pub aperture_m: [f64; 2],
    /// Rays that stand for it: 1, 7, 8 or 19.
    pub rays: u32,
}

/// Light beside the beam, of the lens and of what lies on it: a disc, all of it equally bright, which eight rays on a ring of
/// 0.707 of its radius stand for. Of most surfaces nothing is noticed of it; but a retroreflector, which sends back up to a
/// hundred times as much, blooms: beams beside it have a return at its range, and it looks larger.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Halo {
    /// Share of the light, 0 to 0.5.
    pub share: f64,
    /// Radius, 0 to 0.2 rad.
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

/// Rays of a halo.
const HALO_RAYS: usize = 8;
/// Most rays of a beam and its halo.
pub(super) const MOST_RAYS: usize = MAX_BEAM_RAYS + HALO_RAYS;

impl Beam {
    /// A single ray, as thin as a line.
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

/// Rays on the rings of so many in all; none if there is no such beam.
const fn ring(rays: u32) -> Option<[u32; 3]> {
    match rays {
        1 => Some([1, 0, 0]),
        7 => Some([1, 6, 0]),
        8 => Some([1, 7, 0]),
        19 => Some([1, 6, 12]),
        _ => None,
    }
}

/// Where the rays of a beam lie in it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bundle {
    /// Of it and its halo.
    pub(super) rays: usize,
    /// Of it alone: the first.
    pub(super) own: usize,
    /// Left and up, how far off its middle they begin, and by how much they get farther off it, a metre.
    starts: [[f64; 2]; MOST_RAYS],
    slopes: [[f64; 2]; MOST_RAYS],
    /// What part of the light each stands for, of its own and of the halo's.
    shares: [f64; 2],
}

impl Bundle {
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

    /// What part of the light a ray stands for.
    #[inline(always)]
    pub(super) fn share(&self, ray: usize) -> f64 {
        self.shares[usize::from(ray >= self.own)]
    }

    /// The cross section of a firing's beam: left and up.
    #[inline(always)]
    pub(super) fn axes(firing: &Firing) -> [DVec3; 2] {
        let ahead = firing.direction;
        // Straight up and down, left is the sensor's.
        let left = DVec3::new(-ahead.y, ahead.x, 0.0);
        let level = left.length_squared();
        let left = if level > 1e-20 { left * (1.0 / sqrt(level)) } else { DVec3::Y };
        [left, ahead.cross(left)]
    }

    /// A ray of a beam from a place, in a direction, with a cross section: where it starts, and its unit direction.
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
