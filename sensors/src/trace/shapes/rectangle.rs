//! Rectangles in the plane z = 0, with the outside towards +z.

use super::surface::{Surface, flat};
use super::{Inside, plane};
use glam::DVec3;

/// The parameter is half the edges. The rectangle has no volume: see [`Inside`].
#[inline(always)]
pub(crate) fn inside(origin: [f64; 3], direction: [f64; 3], half: [f64; 2]) -> Inside {
    // For a parallel ray, t is infinite or NaN, and so is x or y, so it is a miss in any case.
    let t = -origin[2] / direction[2];
    let (x, y) = (origin[0] + t * direction[0], origin[1] + t * direction[1]);
    plane::inside(origin, direction, ()).when(x.abs() <= half[0] && y.abs() <= half[1])
}

#[inline(always)]
pub(crate) fn surface(point: DVec3, half: [f64; 2]) -> Surface {
    flat(DVec3::Z, point, [DVec3::X / (2.0 * half[0]), DVec3::Y / (2.0 * half[1])])
}

/// A rectangle, seen from its outside, or from either side if both count.
pub(crate) struct Outside {
    half: [f64; 2],
    origin: [f64; 2],
    per_height: f64,
}

impl Outside {
    /// Returns `None` if the sensor is almost in its plane, or behind it while insides do not count.
    pub(super) fn new([x, y, z]: [f64; 3], half: [f64; 2], both: bool) -> Option<Self> {
        let seen = z > 0.0 || both && z < 0.0;
        seen.then_some(Self { half, origin: [x, y], per_height: -1.0 / z })
    }

    /// 1/t at which a ray hits the rectangle; 0 or less for a miss.
    #[inline(always)]
    pub(crate) fn inverse(&self, [x, y, z]: [f64; 3]) -> f64 {
        let inverse = z * self.per_height;
        // The point at which the ray hits the plane, divided by t.
        let (x, y) = (self.origin[0] * inverse + x, self.origin[1] * inverse + y);
        let within = x.abs() <= self.half[0] * inverse && y.abs() <= self.half[1] * inverse;
        if within { inverse } else { 0.0 }
    }
}
