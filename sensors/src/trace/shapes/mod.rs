//! One shape a file: where 64 rays meet it.
//!
//! Kernels work in the shape's own frame, in f64, which leaves errors far below what an f32 result shows even
//! for grazing rays. Convex solids give the interval of t in which a ray is inside; [`commit`] turns it into a
//! hit.

pub(crate) mod capsule;
pub(crate) mod cuboid;
pub(crate) mod cylinder;
pub(crate) mod rectangle;
pub(crate) mod sphere;
pub(crate) mod triangle;

use super::packet::{Faces, Packet};
use crate::simd::{Lanes, sqrt};

/// Rays in the frame of one instance.
pub(crate) struct LocalRays {
    pub(crate) origin: [Lanes<f64>; 3],
    pub(crate) direction: [Lanes<f64>; 3],
}

/// Where a ray is inside a convex solid; empty when `enter` > `exit`.
#[derive(Clone, Copy)]
pub(crate) struct Inside {
    pub(crate) enter: f64,
    pub(crate) exit: f64,
}

impl Inside {
    pub(crate) const NOWHERE: Self = Self { enter: f64::INFINITY, exit: f64::NEG_INFINITY };
    pub(crate) const EVERYWHERE: Self = Self { enter: f64::NEG_INFINITY, exit: f64::INFINITY };

    #[inline(always)]
    pub(crate) fn intersection(self, other: Self) -> Self {
        Self {
            enter: if other.enter > self.enter { other.enter } else { self.enter },
            exit: if other.exit < self.exit { other.exit } else { self.exit },
        }
    }

    /// The smallest interval that holds both; right for the parts of a convex solid.
    #[inline(always)]
    pub(crate) fn hull(self, other: Self) -> Self {
        if self.enter > self.exit {
            return other;
        }
        if other.enter > other.exit {
            return self;
        }
        Self {
            enter: if other.enter < self.enter { other.enter } else { self.enter },
            exit: if other.exit > self.exit { other.exit } else { self.exit },
        }
    }

    /// Where a ray with that origin and direction along one axis lies in [−half, half].
    #[inline(always)]
    pub(crate) fn slab(origin: f64, direction: f64, half: f64) -> Self {
        // A direction of exactly 0 gives ±∞ as it should; on the face itself 0·∞ is NaN, and the compares below
        // then make it a miss.
        let inverse = 1.0 / direction;
        let (a, b) = ((-half - origin) * inverse, (half - origin) * inverse);
        if a < b { Self { enter: a, exit: b } } else { Self { enter: b, exit: a } }
    }

    /// Where |o + t·d|² ≤ r², given d·d, o·d and o·o − r².
    #[inline(always)]
    pub(crate) fn quadric(dd: f64, od: f64, oo_rr: f64) -> Self {
        let discriminant = od * od - dd * oo_rr;
        let root = sqrt(if discriminant > 0.0 { discriminant } else { 0.0 });
        let inverse = 1.0 / dd;
        let inside = Self { enter: (-od - root) * inverse, exit: (-od + root) * inverse };
        if discriminant < 0.0 { Self::NOWHERE } else { inside }
    }
}

/// Takes the solid's surface as the packet's nearest hit where it is nearer than what was there.
#[inline(always)]
pub(crate) fn commit(packet: &mut Packet, faces: Faces, placed: u32, inside: impl Fn(usize) -> Inside) {
    let both = faces == Faces::Both;
    let t_min = packet.t_min;
    for lane in 0..crate::simd::LANES {
        let Inside { enter, exit } = inside(lane);
        let leaving = if both && exit >= t_min { exit } else { f64::INFINITY };
        let t = if enter >= t_min { enter } else { leaving };
        let hit = enter <= exit && t < packet.t[lane];
        packet.t[lane] = if hit { t } else { packet.t[lane] };
        packet.placed[lane] = if hit { placed } else { packet.placed[lane] };
    }
}
