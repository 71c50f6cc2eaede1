//! Boxes: three slabs (Kay & Kajiya 1986).

use super::Inside;

#[inline(always)]
pub(crate) fn inside(origin: [f64; 3], direction: [f64; 3], half: [f64; 3]) -> Inside {
    let mut inside = Inside::EVERYWHERE;
    for axis in 0..3 {
        inside = inside.intersection(Inside::slab(origin[axis], direction[axis], half[axis]));
    }
    inside
}
