//! Scanners with two rotating prisms one behind the other (Risley prisms), such as Livox's Mid-40 and Mid-70.

use super::clock::{Clock, Ticks, turns};
use super::firing::{Firing, FiringLanes};
use crate::ParameterError;
use crate::simd::{sin_cos, sqrt};
use core::f64::consts::TAU;
use glam::DVec3;

/// One laser behind two glass wedges that rotate about +x, with the flat sides of both outwards or of both inwards. The
/// beam draws a rosette.
///
/// The beam is refracted at each face by Snell's law. At time 0 both wedges are thickest towards −y and deflect the
/// beam in that direction. The wedges return to the same positions after a minute or sooner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rosette {
    /// The time from one firing to the next, in nanoseconds.
    pub firing_time_ns: u64,
    /// The speeds of the wedge at the laser and of that in front of it, in turns per minute; negative values turn the
    /// other way.
    pub speeds_rpm: [i32; 2],
    /// The angle between the faces of a wedge, in radians.
    pub wedge_rad: f64,
    /// The refractive index of the glass, 1 to 4.
    pub refractive_index: f64,
    /// Whether the flat sides of the wedges face each other, as in a Mid-70. Otherwise the slanted sides do, as in a
    /// Mid-40.
    pub is_flat_inwards: bool,
}

impl Rosette {
    pub(super) fn check(&self, frame_time_ns: u64) -> Result<(), ParameterError> {
        let wrong = |parameter, value, rule| Err(ParameterError::new("scanner", parameter, value, rule));
        self.clock().check("firing_time_ns", frame_time_ns)?;
        if !(1.0..=4.0).contains(&self.refractive_index) {
            return wrong("refractive_index", self.refractive_index, "1 to 4");
        }
        // The deflection is largest where both wedges bend the beam the same way. Beyond some wedge angle the beam is
        // totally reflected there.
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

    /// Returns the largest angle between the beam and +x, in radians; `None` if the beam is totally reflected there.
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

    /// Returns the direction of the beam with the wedges turned by these angles; `None` in case of total reflection.
    fn bent(&self, turned: [f64; 2]) -> Option<DVec3> {
        let n = self.refractive_index;
        let (sin, cos) = sin_cos(self.wedge_rad);
        // The normals of the slanted faces, both pointing ahead, for faces behind the glass. A face in front of it is
        // turned by half a turn.
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
        // The beam passes the first flat side at a right angle, without being refracted.
        let between = refracted(DVec3::X, first, n)?;
        let inside = refracted(between, second, 1.0 / n)?;
        refracted(inside, DVec3::X, n)
    }
}

/// Refracts a unit direction at a face whose unit normal points ahead. `ratio` is the refractive index in front of the
/// face divided by that behind it.
fn refracted(direction: DVec3, normal: DVec3, ratio: f64) -> Option<DVec3> {
    let along = direction.dot(normal);
    let rest = 1.0 - ratio * ratio * (1.0 - along * along);
    if rest < 0.0 {
        return None;
    }
    let bent = direction * ratio + normal * (sqrt(rest) - ratio * along);
    Some(bent * (1.0 / sqrt(bent.length_squared())))
}
