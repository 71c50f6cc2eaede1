//! Closed cylinders along z: an endless cylinder cut by a slab.

use super::{Inside, dot};

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
