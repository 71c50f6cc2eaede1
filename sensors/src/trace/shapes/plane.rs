//! The plane z = 0, endless; all below it is inside.

use super::Inside;

/// A ray along the plane misses it, even from below.
#[inline(always)]
pub(crate) fn inside(origin: [f64; 3], direction: [f64; 3], (): ()) -> Inside {
    let (height, up) = (origin[2], direction[2]);
    let t = -height / up;
    Inside {
        enter: if up < 0.0 { t } else { f64::NEG_INFINITY },
        exit: if up > 0.0 { t } else { f64::INFINITY },
    }
    .when(up != 0.0)
}
