//! Ellipsoids along the axes, as the unit ball in a scaled frame.

use super::common_origin::turn;
use super::real::Real;
use super::surface::{Surface, around};
use super::{Inside, sphere};
use glam::DVec3;

/// The parameters are the reciprocals of the radii.
#[inline(always)]
pub(crate) fn inside([x, y, z]: [f64; 3], [dx, dy, dz]: [f64; 3], inverse_radii: [f64; 3]) -> Inside {
    let [a, b, c] = inverse_radii;
    Inside::ball([x * a, y * b, z * c], [dx * a, dy * b, dz * c], 1.0)
}

/// The parameters are the radii. Texture coordinates are those of the unit ball in the scaled frame.
#[inline(always)]
pub(crate) fn surface(point: DVec3, [a, b, c]: [f64; 3]) -> Surface {
    let inverse = DVec3::new(1.0 / a, 1.0 / b, 1.0 / c);
    let stretched = point * inverse;
    let surface = around(stretched, stretched, [-1.0, 1.0]);
    Surface {
        normal: DVec3::from_array(normal(point.to_array(), [a, b, c])),
        uv_gradient: surface.uv_gradient.map(|gradient| gradient * inverse),
        ..surface
    }
}

/// The parameters are the radii.
#[inline(always)]
pub(crate) fn normal<T: Real>([x, y, z]: [T; 3], [a, b, c]: [T; 3]) -> [T; 3] {
    let [a, b, c] = [T::ONE / a, T::ONE / b, T::ONE / c];
    [x * a * a, y * b * b, z * c * c]
}

/// The parameters are the radii.
pub(super) fn outside(
    [x, y, z]: [f64; 3],
    radii: [f64; 3],
    rows: &mut [[f64; 3]; 3],
) -> Option<sphere::Outside> {
    let [a, b, c] = radii.map(|radius| 1.0 / radius);
    turn(rows, [[a, 0.0, 0.0], [0.0, b, 0.0], [0.0, 0.0, c]]);
    sphere::Outside::new([x * a, y * b, z * c], 1.0, rows)
}
