//! What a point of a surface shows: its normal, and where on a texture it lies.

use crate::scene::{
    KIND_BOX, KIND_CAPSULE, KIND_CONE, KIND_CYLINDER, KIND_ELLIPSOID, KIND_PLANE, KIND_RECTANGLE, KIND_SPHERE,
};
use core::f64::consts::{PI, TAU};
use glam::DVec3;

use super::real::Real;
use super::{capsule, cone, cuboid, cylinder, ellipsoid, plane, rectangle, sphere};

/// A point of a surface, in the unscaled frame of its instance.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Surface {
    /// Outwards; of whatever length above 0. The inverse transpose takes it to other frames.
    pub(crate) normal: DVec3,
    /// Texture coordinates.
    pub(crate) uv: [f64; 2],
    /// Change of u and of v per metre along each axis.
    pub(crate) uv_gradient: [DVec3; 2],
}

/// The surface of a shape that is not made of triangles, at a point on it. What belongs to a texture is only there
/// if there is one. A constant kind leaves nothing of the match.
#[inline(always)]
pub(crate) fn solid_surface<const TEXTURED: bool>(kind: u32, size: [f64; 3], point: DVec3) -> Surface {
    let [a, b, c] = size;
    match kind {
        KIND_BOX => cuboid::surface(point, DVec3::new(a, b, c)),
        KIND_RECTANGLE => rectangle::surface(point, [a, b]),
        KIND_SPHERE => sphere::surface::<TEXTURED>(point, a),
        KIND_ELLIPSOID => ellipsoid::surface::<TEXTURED>(point, size),
        KIND_CYLINDER => cylinder::surface::<TEXTURED>(point, [a, b]),
        KIND_CAPSULE => capsule::surface::<TEXTURED>(point, [a, b]),
        KIND_CONE => cone::surface::<TEXTURED>(point, [a, b]),
        KIND_PLANE => plane::surface(point),
        _ => flat(DVec3::Z, point, [DVec3::ZERO; 2]),
    }
}

/// The outward normal, of whatever length above 0, of a shape that is not made of triangles at a point of its surface.
#[inline(always)]
pub(crate) fn solid_normal<T: Real>(kind: u32, size: [T; 3], point: [T; 3]) -> [T; 3] {
    let [a, b, _] = size;
    match kind {
        KIND_BOX => cuboid::normal(point, size),
        KIND_SPHERE => sphere::normal(point, a),
        KIND_ELLIPSOID => ellipsoid::normal(point, size),
        KIND_CYLINDER => cylinder::normal(point, [a, b]),
        KIND_CAPSULE => capsule::normal(point, [a, b]),
        KIND_CONE => cone::normal(point, [a, b]),
        _ => [T::ZERO, T::ZERO, T::ONE],
    }
}

/// A flat face centred on the origin of u and v, which run from 0 to 1 over it.
#[inline(always)]
pub(crate) fn flat(normal: DVec3, point: DVec3, uv_gradient: [DVec3; 2]) -> Surface {
    let [u, v] = uv_gradient;
    Surface { normal, uv: [u.dot(point) + 0.5, v.dot(point) + 0.5], uv_gradient }
}

/// A surface of revolution: u once around from −x, v along z.
#[inline(always)]
pub(super) fn around<const TEXTURED: bool>(point: DVec3, normal: DVec3, [low, high]: [f64; 2]) -> Surface {
    if !TEXTURED {
        return Surface { normal, uv: [0.0; 2], uv_gradient: [DVec3::ZERO; 2] };
    }
    let squared = point.x * point.x + point.y * point.y;
    // At the very poles u changes without limit.
    let least = 1e-12 * (high - low) * (high - low);
    let per_turn = 1.0 / (if squared > least { squared } else { least } * TAU);
    let along = 1.0 / (high - low);
    Surface {
        normal,
        uv: [(libm::atan2(point.y, point.x) + PI) / TAU, (point.z - low) * along],
        uv_gradient: [DVec3::new(-point.y * per_turn, point.x * per_turn, 0.0), DVec3::Z * along],
    }
}
