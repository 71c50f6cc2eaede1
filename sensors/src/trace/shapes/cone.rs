//! Closed cones along z: the apex at +`half_length`, the base at −`half_length`.
//!
//! In a frame in which the cone is scaled to the unit cone ρ ≤ w, 0 ≤ w ≤ 1, with w downwards from the apex, a ray is
//! inside the endless double cone where A·t² + 2·B·t + C ≤ 0; the slab of w selects the lower nappe.

use super::real::Real;
use super::surface::{Surface, around, flat};
use super::{Inside, dot};
use crate::simd::sqrt;
use glam::DVec3;

/// The parameters are the reciprocals of the base's radius and of the length.
#[inline(always)]
pub(crate) fn inside(
    [x, y, z]: [f64; 3],
    [dx, dy, dz]: [f64; 3],
    [per_radius, per_length]: [f64; 2],
) -> Inside {
    let direction = [dx * per_radius, dy * per_radius, -dz * per_length];
    let mut origin = [x * per_radius, y * per_radius, -z * per_length];
    // t is counted from the ray's point nearest to the middle of the axis; otherwise the squares below would cancel.
    let middle = -dot(origin, direction) / dot(direction, direction);
    for axis in 0..3 {
        origin[axis] += middle * direction[axis];
    }
    let ([u, v, below_middle], [du, dv, dw]) = (origin, direction);
    let w = below_middle + 0.5;

    let a = dot([du, dv], [du, dv]) - dw * dw;
    let b = dot([u, v], [du, dv]) - w * dw;
    let c = dot([u, v], [u, v]) - w * w;
    let discriminant = b * b - a * c;
    let root = sqrt(if discriminant > 0.0 { discriminant } else { 0.0 });
    // One root is computed without cancellation, and the other from their product. For a ray along a side, a = 0, and
    // there is one root at ±∞ with the right sign; q = 0 is a double root.
    let q = if b > 0.0 { -b - root } else { -b + root };
    let t = [q / a, if q == 0.0 { q / a } else { c / q }];
    let (low, high) = if t[0] < t[1] { (t[0], t[1]) } else { (t[1], t[0]) };
    // a ≥ 0: inside between the roots. a < 0: inside beyond them, one nappe on each side.
    let steep = a < 0.0;
    let down = dw > 0.0;
    let double = Inside {
        enter: if steep { if down { high } else { f64::NEG_INFINITY } } else { low },
        exit: if steep { if down { f64::INFINITY } else { low } } else { high },
    };
    // A steep ray always hits the double cone; only at the apex can rounding give the opposite result.
    let lower = double.when(steep || discriminant >= 0.0).intersection(Inside::slab(below_middle, dw, 0.5));
    Inside { enter: lower.enter + middle, exit: lower.exit + middle }
}

/// The parameters are the base's radius and half the length.
#[inline(always)]
pub(crate) fn surface(point: DVec3, [radius, half_length]: [f64; 2]) -> Surface {
    let (is_base, normal) = place(point.to_array(), [radius, half_length]);
    let normal = DVec3::from_array(normal);
    let side = around(point, normal, [-half_length, half_length]);
    let per_metre = 0.5 / radius;
    let base = flat(normal, point, [DVec3::X * per_metre, DVec3::NEG_Y * per_metre]);
    if is_base { base } else { side }
}

#[inline(always)]
pub(crate) fn normal<T: Real>(point: [T; 3], size: [T; 2]) -> [T; 3] {
    place(point, size).1
}

/// Returns true if a point of the surface is on the base, and its normal.
#[inline(always)]
fn place<T: Real>([x, y, z]: [T; 3], [radius, half_length]: [T; 2]) -> (bool, [T; 3]) {
    let to_axis = (x * x + y * y).sqrt();
    // The normal of the side goes outwards by the length while it goes up by the radius.
    let (out, up) = ((T::ONE + T::ONE) * half_length, radius);
    let slant = (out * out + up * up).sqrt();
    let ahead = if to_axis > T::ZERO { out / (slant * to_axis) } else { T::ZERO };
    let below_side = ((half_length - z) * up - to_axis * out) / slant;
    let is_base = z + half_length < below_side;
    let normal = if is_base { [T::ZERO, T::ZERO, -T::ONE] } else { [x * ahead, y * ahead, up / slant] };
    (is_base, normal)
}
