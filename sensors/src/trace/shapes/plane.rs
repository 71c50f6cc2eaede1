//! The endless plane z = 0; everything below it is inside.

use super::Inside;
use super::surface::Surface;
use glam::DVec3;

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

/// u and v are in metres.
#[inline(always)]
pub(crate) fn surface(point: DVec3) -> Surface {
    Surface { normal: DVec3::Z, uv: [point.x, point.y], uv_gradient: [DVec3::X, DVec3::Y] }
}
