//! Closed cylinders along z: an endless cylinder cut by a slab.

use super::surface::{Surface, around, flat};
use super::{Inside, dot};
use crate::simd::sqrt;
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
    let sign = if point.z < 0.0 { -1.0 } else { 1.0 };
    let to_axis = sqrt(point.x * point.x + point.y * point.y);
    let per_metre = 0.5 / radius;
    let end = flat(DVec3::Z * sign, point, [DVec3::X * per_metre, DVec3::Y * (sign * per_metre)]);
    let radial = DVec3::new(point.x, point.y, 0.0);
    let side = around::<TEXTURED>(point, radial / radius, [-half_length, half_length]);
    if half_length - point.z * sign < radius - to_axis { end } else { side }
}
