//! Boxes: three slabs (Kay & Kajiya 1986).

use super::Inside;
use super::common_origin::{Slab, first, greater, lesser};
use super::real::Real;
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
    let ([on_x, on_y, on_z], sign) = face(point.to_array(), half.to_array());
    let when = |face: bool, value: f64| if face { value } else { 0.0 };
    let normal = DVec3::new(when(on_x, sign), when(on_y, sign), when(on_z, sign));
    let right = DVec3::new(when(on_y, -sign) + when(on_z, 1.0), when(on_x, sign), 0.0);
    let up = DVec3::new(0.0, when(on_z, sign), when(!on_z, 1.0));
    let per_metre = DVec3::new(0.5 / half.x, 0.5 / half.y, 0.5 / half.z);
    flat(normal, point, [right * per_metre, up * per_metre])
}

/// The axis that is perpendicular to the face nearest to a point, and the sign of its side.
#[inline(always)]
fn face<T: Real>([x, y, z]: [T; 3], [a, b, c]: [T; 3]) -> ([bool; 3], T) {
    let [to_x, to_y, to_z] = [a - x.abs(), b - y.abs(), c - z.abs()];
    let on_x = to_x <= to_y && to_x <= to_z;
    let on_y = !on_x && to_y <= to_z;
    let across = if on_x {
        x
    } else if on_y {
        y
    } else {
        z
    };
    ([on_x, on_y, !on_x && !on_y], if across < T::ZERO { -T::ONE } else { T::ONE })
}

#[inline(always)]
pub(crate) fn normal<T: Real>(point: [T; 3], half: [T; 3]) -> [T; 3] {
    let ([on_x, on_y, on_z], sign) = face(point, half);
    let when = |face: bool| if face { sign } else { T::ZERO };
    [when(on_x), when(on_y), when(on_z)]
}

/// A box, seen from outside.
pub(crate) struct Outside([Slab; 3]);

impl Outside {
    pub(super) fn new(origin: [f64; 3], half: [f64; 3]) -> Option<Self> {
        let slab = |axis: usize| Slab::new(origin[axis], half[axis]);
        let slabs = [slab(0)?, slab(1)?, slab(2)?];
        (!slabs.iter().all(Slab::is_around)).then_some(Self(slabs))
    }

    /// 1/t at which a ray first hits the box; 0 or less for a miss.
    #[inline(always)]
    pub(crate) fn inverse(&self, [x, y, z]: [f64; 3]) -> f64 {
        let Self([across_x, across_y, across_z]) = self;
        first(
            lesser(lesser(across_x.enter(x), across_y.enter(y)), across_z.enter(z)),
            greater(greater(across_x.leave(x), across_y.leave(y)), across_z.leave(z)),
        )
    }
}
