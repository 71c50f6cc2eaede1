//! Shapes, one per file: the intersection with a ray, and the properties of the surface.
//!
//! Kernels process one ray in the shape's own frame, in f64, whose errors are far below what an f32 result can show
//! even for grazing rays. Each is a pure function without branches, so that a loop over lanes around it is vectorised;
//! [`match_solid!`] selects the function once for the whole loop.
//!
//! For a convex solid, the result is the interval of t in which the ray is inside ([`Inside`]). The origin of a ray may
//! be far away compared with the size of the shape, so squares are only computed of distances near the shape, where
//! nothing is lost by cancellation (Haines et al. 2019, "Precision Improvements for Ray/Sphere Intersection").

pub(crate) mod capsule;
mod common_origin;
pub(crate) mod cone;
pub(crate) mod cuboid;
pub(crate) mod cylinder;
pub(crate) mod ellipsoid;
pub(crate) mod outside;
pub(crate) mod plane;
pub(crate) mod real;
pub(crate) mod rectangle;
pub(crate) mod sphere;
pub(crate) mod surface;
pub(crate) mod triangle;

#[cfg(test)]
mod tests;

use super::packet::{Faces, Packet};
use crate::scene::Solid;
use crate::simd::{LANES, Lanes, sqrt};
use bytemuck::{Pod, Zeroable};
use glam::DVec3;
use real::Real;
use surface::Surface;

/// Evaluates `$body` with `$inside` bound to the kernel of a [`Solid`] of the given size: a `Fn(origin: [f64; 3],
/// direction: [f64; 3]) -> Inside` for rays in the instance's own (unscaled) frame.
///
/// The match is outside of `$body`, which is compiled once per kind: put the loop over lanes into it, and only fill a
/// separate array with [`Inside::first`] in that loop. If it changed hits in place, LLVM would generate masked stores,
/// which take four times as long as everything else at AVX2.
macro_rules! match_solid {
    ($solid:expr, $size:expr, $inside:ident => $body:expr) => {{
        use $crate::scene::Solid;
        use $crate::trace::shapes;
        let size: [f64; 3] = $size;
        macro_rules! with {
            ($kernel:path, $sizes:expr) => {{
                let sizes = $sizes;
                let $inside = shapes::kernel(
                    #[inline(always)]
                    |origin, direction| $kernel(origin, direction, sizes),
                );
                $body
            }};
        }
        match $solid {
            Solid::Box => with!(shapes::cuboid::inside, size),
            Solid::Rectangle => with!(shapes::rectangle::inside, [size[0], size[1]]),
            Solid::Sphere => with!(shapes::sphere::inside, size[0]),
            Solid::Cylinder => with!(shapes::cylinder::inside, [size[0], size[1]]),
            Solid::Capsule => with!(shapes::capsule::inside, [size[0], size[1]]),
            Solid::Plane => with!(shapes::plane::inside, ()),
            Solid::Ellipsoid => with!(shapes::ellipsoid::inside, size.map(|radius| 1.0 / radius)),
            Solid::Cone => with!(shapes::cone::inside, [1.0 / size[0], 0.5 / size[1]]),
        }
    }};
}
pub(crate) use match_solid;

/// The surface of a solid at a point on it. If `solid` is a constant, the match is compiled away.
#[inline(always)]
pub(crate) fn solid_surface(solid: Solid, size: [f64; 3], point: DVec3) -> Surface {
    let [a, b, c] = size;
    match solid {
        Solid::Box => cuboid::surface(point, DVec3::new(a, b, c)),
        Solid::Rectangle => rectangle::surface(point, [a, b]),
        Solid::Sphere => sphere::surface(point, a),
        Solid::Ellipsoid => ellipsoid::surface(point, size),
        Solid::Cylinder => cylinder::surface(point, [a, b]),
        Solid::Capsule => capsule::surface(point, [a, b]),
        Solid::Cone => cone::surface(point, [a, b]),
        Solid::Plane => plane::surface(point),
    }
}

/// The outward normal of a solid at a point of its surface, of any positive length.
#[inline(always)]
pub(crate) fn solid_normal<T: Real>(solid: Solid, size: [T; 3], point: [T; 3]) -> [T; 3] {
    let [a, b, _] = size;
    match solid {
        Solid::Box => cuboid::normal(point, size),
        Solid::Sphere => sphere::normal(point, a),
        Solid::Ellipsoid => ellipsoid::normal(point, size),
        Solid::Cylinder => cylinder::normal(point, [a, b]),
        Solid::Capsule => capsule::normal(point, [a, b]),
        Solid::Cone => cone::normal(point, [a, b]),
        Solid::Rectangle | Solid::Plane => [T::ZERO, T::ZERO, T::ONE],
    }
}

/// Returns its argument. Only a closure that is passed as an argument can be marked for inlining.
#[inline(always)]
pub(crate) fn kernel<F: Fn([f64; 3], [f64; 3]) -> Inside>(inside: F) -> F {
    inside
}

/// Rays in the frame of one instance.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct LocalRays {
    pub(crate) origin: [Lanes<f64>; 3],
    pub(crate) direction: [Lanes<f64>; 3],
}

impl LocalRays {
    pub(crate) const fn new() -> Self {
        Self { origin: [[0.0; LANES]; 3], direction: [[0.0; LANES]; 3] }
    }
}

/// The interval of t in which a ray is inside a convex solid; empty if `enter` > `exit`.
///
/// A surface without a volume, such as a rectangle, is entered by a ray that hits its outside and left by one that hits
/// its inside; the other end of the interval is infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Inside {
    pub(crate) enter: f64,
    pub(crate) exit: f64,
}

impl Inside {
    pub(crate) const EVERYWHERE: Self = Self { enter: f64::NEG_INFINITY, exit: f64::INFINITY };

    /// The least t ≥ `t_min` at which the ray hits the surface, from outside only unless `both` sides count; ∞ if it
    /// does not.
    #[inline(always)]
    pub(crate) fn first(self, t_min: f64, both: bool) -> f64 {
        let leaving = if both && self.exit >= t_min { self.exit } else { f64::INFINITY };
        let t = if self.enter >= t_min { self.enter } else { leaving };
        if self.enter <= self.exit { t } else { f64::INFINITY }
    }

    /// Returns this interval if the condition holds, otherwise an empty one.
    #[inline(always)]
    pub(crate) fn when(self, condition: bool) -> Self {
        Self {
            enter: if condition { self.enter } else { f64::INFINITY },
            exit: if condition { self.exit } else { f64::NEG_INFINITY },
        }
    }

    #[inline(always)]
    pub(crate) fn intersection(self, other: Self) -> Self {
        Self {
            enter: if other.enter > self.enter { other.enter } else { self.enter },
            exit: if other.exit < self.exit { other.exit } else { self.exit },
        }
    }

    /// The smallest interval that contains both; correct for the parts of a convex solid.
    #[inline(always)]
    pub(crate) fn hull(self, other: Self) -> Self {
        // Empty intervals become +∞ … −∞, which the comparisons then ignore.
        let (a, b) = (self.when(self.enter <= self.exit), other.when(other.enter <= other.exit));
        Self {
            enter: if b.enter < a.enter { b.enter } else { a.enter },
            exit: if b.exit > a.exit { b.exit } else { a.exit },
        }
    }

    /// The interval in which a ray with this origin and direction along one axis is in [−half, half].
    #[inline(always)]
    pub(crate) fn slab(origin: f64, direction: f64, half: f64) -> Self {
        // A direction of exactly 0 gives ±∞, as it should. On the face itself, 0·∞ is NaN, and the comparisons below
        // make it a miss.
        let inverse = 1.0 / direction;
        let (a, b) = ((-half - origin) * inverse, (half - origin) * inverse);
        let ascending = a < b;
        Self { enter: if ascending { a } else { b }, exit: if ascending { b } else { a } }
    }

    /// The interval in which |o + t·d| ≤ r, in as many dimensions as the arrays have, for d ≠ 0.
    #[inline(always)]
    pub(crate) fn ball<const N: usize>(o: [f64; N], d: [f64; N], radius: f64) -> Self {
        let inverse = 1.0 / dot(d, d);
        let middle = -dot(o, d) * inverse;
        // Half a chord back and forth from the ray's point nearest to the centre.
        let mut nearest = o;
        for axis in 0..N {
            nearest[axis] = o[axis] + middle * d[axis];
        }
        let squared = (radius * radius - dot(nearest, nearest)) * inverse;
        let half_chord = sqrt(if squared > 0.0 { squared } else { 0.0 });
        Self { enter: middle - half_chord, exit: middle + half_chord }.when(squared >= 0.0)
    }
}

#[inline(always)]
pub(crate) fn dot<const N: usize>(a: [f64; N], b: [f64; N]) -> f64 {
    let mut sum = a[0] * b[0];
    for axis in 1..N {
        sum += a[axis] * b[axis];
    }
    sum
}

/// Stores a hit on the solid's surface as the packet's nearest hit if it is nearer than the previous one.
#[inline(always)]
pub(crate) fn commit(
    rays: &LocalRays,
    packet: &mut Packet,
    faces: Faces,
    slot: u32,
    inside: impl Fn([f64; 3], [f64; 3]) -> Inside,
) {
    let both = faces == Faces::Both;
    let t_min = packet.t_min;
    let mut t = [0.0; LANES];
    for lane in 0..LANES {
        let origin = [rays.origin[0][lane], rays.origin[1][lane], rays.origin[2][lane]];
        let direction = [rays.direction[0][lane], rays.direction[1][lane], rays.direction[2][lane]];
        t[lane] = inside(origin, direction).first(t_min, both);
    }
    let mut hit = [0; LANES];
    for lane in 0..LANES {
        hit[lane] = if t[lane] < packet.t[lane] { slot } else { packet.hit[lane] };
        t[lane] = if t[lane] < packet.t[lane] { t[lane] } else { packet.t[lane] };
    }
    (packet.t, packet.hit) = (t, hit);
}
