//! Scanners with two prisms that turn one behind the other (Risley), as Livox's Mid-40 and Mid-70.

use super::clock::{Clock, Ticks, turns};
use super::firing::{Firing, FiringLanes};
use crate::ParameterError;
use crate::simd::{sin_cos, sqrt};
use core::f64::consts::TAU;
use glam::DVec3;

/// One laser behind two wedges of glass that turn about +x, the flat sides both outwards or both inwards: its beam draws a
/// rosette, which begins anew after minutes or never.
///
/// The beam is refracted at each face by Snell's law. Both wedges are thickest towards −y, which is where they bend it to, when
/// time begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rosette {
    /// From a firing to the next, in nanoseconds.
    pub firing_time_ns: u64,
    /// Turns a minute of the wedge at the laser and of that in front of it; negative ones turn the other way.
    pub speeds_rpm: [i32; 2],
    /// Angle between the faces of a wedge, in radians.
    pub wedge_rad: f64,
    /// Index of refraction of the glass, 1 to 4.
    pub refractive_index: f64,
    /// Whether the flat sides of the wedges face each other, as a Mid-70's do; else the slanted ones, as a Mid-40's.
    pub is_flat_inwards: bool,
}

impl Rosette {
    pub(super) fn check(&self, frame_time_ns: u64) -> Result<(), ParameterError> {
        let wrong = |parameter, value, rule| Err(ParameterError::new("scanner", parameter, value, rule));
        if self.firing_time_ns == 0 || self.firing_time_ns > frame_time_ns {
            return wrong("firing_time_ns", self.firing_time_ns as f64, "1 up to the frame's time");
        }
        if !(1.0..=4.0).contains(&self.refractive_index) {
            return wrong("refractive_index", self.refractive_index, "1 to 4");
        }
        // Where both wedges bend the beam the same way it is bent most; beyond some angle it does not leave the glass.
        let is_possible = self.wedge_rad > 0.0
            && self.wedge_rad < core::f64::consts::FRAC_PI_2
            && self.bent([0.0; 2]).is_some();
        if !is_possible {
            return wrong(
                "wedge_rad",
                self.wedge_rad,
                "more than 0, and no more than what lets all light through",
            );
        }
        Ok(())
    }

    /// How far from straight ahead its beam goes at the most, in radians; none if it does not leave the glass there.
    pub fn half_angle_rad(&self) -> Option<f64> {
        self.bent([0.0; 2]).map(|most| libm::acos(most.x.clamp(-1.0, 1.0)))
    }

    pub(super) fn clock(&self) -> Clock {
        Clock { tick_ns: self.firing_time_ns }
    }

    #[inline(always)]
    pub(super) fn fill(&self, ticks: &Ticks, (first, count): (usize, usize), lanes: &mut FiringLanes) {
        for lane in 0..count {
            let tick = (first + lane) as u64;
            let at_ns = ticks.in_minute_ns(tick);
            let turned = self.speeds_rpm.map(|rpm| turns(at_ns, rpm.into()) * TAU);
            let direction = self.bent(turned).unwrap_or(DVec3::X);
            lanes.set(lane, &Firing { time_s: ticks.time_s(tick), origin: DVec3::ZERO, direction, laser: 0 });
        }
    }

    /// Which way the beam goes when the wedges are turned so; none if it does not leave the glass.
    fn bent(&self, turned: [f64; 2]) -> Option<DVec3> {
        let n = self.refractive_index;
        let (sin, cos) = sin_cos(self.wedge_rad);
        // The slanted faces' normals, both ahead, when each is behind the glass: one before it is turned by half.
        let [first, second] = turned.map(|angle| {
            let (across, along) = sin_cos(angle);
            DVec3::new(cos, sin * along, sin * across)
        });
        if self.is_flat_inwards {
            let first = DVec3::new(first.x, -first.y, -first.z);
            let inside = refracted(DVec3::X, first, 1.0 / n)?;
            let between = refracted(inside, DVec3::X, n)?;
            let inside = refracted(between, DVec3::X, 1.0 / n)?;
            return refracted(inside, second, n);
        }
        let second = DVec3::new(second.x, -second.y, -second.z);
        // Straight through the first flat side, which the beam meets at a right angle.
        let between = refracted(DVec3::X, first, n)?;
        let inside = refracted(between, second, 1.0 / n)?;
        refracted(inside, DVec3::X, n)
    }
}

/// A unit direction behind a face with a unit normal ahead of it; `ratio` is the index before over that behind.
fn refracted(direction: DVec3, normal: DVec3, ratio: f64) -> Option<DVec3> {
    let along = direction.dot(normal);
    let rest = 1.0 - ratio * ratio * (1.0 - along * along);
    if rest < 0.0 {
        return None;
    }
    let bent = direction * ratio + normal * (sqrt(rest) - ratio * along);
    Some(bent * (1.0 / sqrt(bent.length_squared())))
}
