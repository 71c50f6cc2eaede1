//! Boxes: three slabs (Kay & Kajiya 1986).

use super::Inside;
use super::surface::{Surface, flat};
use glam::DVec3;

#[inline(always)]
pub(crate) fn inside(origin: [f64; 3], direction: [f64; 3], half: [f64; 3]) -> Inside {
    let mut inside = Inside::EVERYWHERE;
    for axis in 0..3 {
        inside = inside.intersection(Inside::slab(origin[axis], direction[axis], half[axis]));
    }
    inside
}

#[inline(always)]
pub(crate) fn surface(point: DVec3, half: DVec3) -> Surface {
    // The face is the one that the point is nearest to.
    let depth = half - point.abs();
    let on_x = depth.x <= depth.y && depth.x <= depth.z;
    let on_y = !on_x && depth.y <= depth.z;
    let on_z = !on_x && !on_y;
    let across = if on_x {
        point.x
    } else if on_y {
        point.y
    } else {
        point.z
    };
    let sign = if across < 0.0 { -1.0 } else { 1.0 };
    let when = |face: bool, value: f64| if face { value } else { 0.0 };
    let normal = DVec3::new(when(on_x, sign), when(on_y, sign), when(on_z, sign));
    let right = DVec3::new(when(on_y, -sign) + when(on_z, 1.0), when(on_x, sign), 0.0);
    let up = DVec3::new(0.0, when(on_z, sign), when(!on_z, 1.0));
    let per_metre = DVec3::new(0.5 / half.x, 0.5 / half.y, 0.5 / half.z);
    flat(normal, point, [right * per_metre, up * per_metre])
}
