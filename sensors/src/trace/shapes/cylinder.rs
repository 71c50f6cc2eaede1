//! Closed cylinders along z: an endless cylinder cut by a slab.

use super::real::Real;
use super::surface::{Surface, around, flat};
use super::{Inside, dot};
use glam::DVec3;

#[inline(always)]
pub(crate) fn inside([x, y, z]: [f64; 3], [dx, dy, dz]: [f64; 3], [radius, half_length]: [f64; 2]) -> Inside {
    // Along the axis: inside for good, or never.
    let along = dot([dx, dy], [dx, dy]) <= 0.0;
    let round = Inside::ball([x, y], [if along { 1.0 } else { dx }, dy], radius);
    let never = dot([x, y], [x, y]) > radius * radius;
    let endless = Inside {
        enter: if along { f64::NEG_INFINITY } else { round.enter },
        exit: if along { f64::INFINITY } else { round.exit },
    };
    endless.when(!(along && never)).intersection(Inside::slab(z, dz, half_length))
}

#[inline(always)]
pub(crate) fn surface<const TEXTURED: bool>(point: DVec3, [radius, half_length]: [f64; 2]) -> Surface {
    let (is_end, sign) = end(point.to_array(), [radius, half_length]);
    let normal = DVec3::from_array(normal(point.to_array(), [radius, half_length]));
    let per_metre = 0.5 / radius;
    let end = flat(normal, point, [DVec3::X * per_metre, DVec3::Y * (sign * per_metre)]);
    let side = around::<TEXTURED>(point, normal, [-half_length, half_length]);
    if is_end { end } else { side }
}

/// Whether a point of the surface is on an end, and the sign of z.
#[inline(always)]
fn end<T: Real>([x, y, z]: [T; 3], [radius, half_length]: [T; 2]) -> (bool, T) {
    let sign = if z < T::ZERO { -T::ONE } else { T::ONE };
    let to_axis = (x * x + y * y).sqrt();
    (half_length - z * sign < radius - to_axis, sign)
}

#[inline(always)]
pub(crate) fn normal<T: Real>(point: [T; 3], [radius, half_length]: [T; 2]) -> [T; 3] {
    let (is_end, sign) = end(point, [radius, half_length]);
    let [x, y, _] = point;
    let zero = T::ZERO;
    if is_end { [zero, zero, sign] } else { [x / radius, y / radius, zero] }
}
