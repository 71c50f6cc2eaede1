//! The properties of a point of a surface: its normal and its texture coordinates.

use core::f64::consts::{PI, TAU};
use glam::DVec3;

/// A point of a surface, in the unscaled frame of its instance.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Surface {
    /// The outward normal, of any positive length. The inverse transpose transforms it to other frames.
    pub(crate) normal: DVec3,
    /// Texture coordinates.
    pub(crate) uv: [f64; 2],
    /// The change of u and of v per metre along each axis.
    pub(crate) uv_gradient: [DVec3; 2],
}

/// A flat face; u and v run from 0 to 1 over it, with the origin in the middle.
#[inline(always)]
pub(crate) fn flat(normal: DVec3, point: DVec3, uv_gradient: [DVec3; 2]) -> Surface {
    let [u, v] = uv_gradient;
    Surface { normal, uv: [u.dot(point) + 0.5, v.dot(point) + 0.5], uv_gradient }
}

/// A surface of revolution: u once around from −x, v along z.
#[inline(always)]
pub(super) fn around(point: DVec3, normal: DVec3, [low, high]: [f64; 2]) -> Surface {
    let squared = point.x * point.x + point.y * point.y;
    // At the poles, the change of u is unlimited.
    let least = 1e-12 * (high - low) * (high - low);
    let per_turn = 1.0 / (if squared > least { squared } else { least } * TAU);
    let along = 1.0 / (high - low);
    Surface {
        normal,
        uv: [(libm::atan2(point.y, point.x) + PI) / TAU, (point.z - low) * along],
        uv_gradient: [DVec3::new(-point.y * per_turn, point.x * per_turn, 0.0), DVec3::Z * along],
    }
}
