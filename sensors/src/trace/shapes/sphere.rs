//! Balls around the origin.

use super::Inside;
use super::common_origin::{power_of_point, turn};
use super::real::Real;
use super::surface::{Surface, around};
use crate::simd::sqrt;
use glam::DVec3;

#[inline(always)]
pub(crate) fn inside(origin: [f64; 3], direction: [f64; 3], radius: f64) -> Inside {
    Inside::ball(origin, direction, radius)
}

#[inline(always)]
pub(crate) fn surface(point: DVec3, radius: f64) -> Surface {
    let normal = DVec3::from_array(normal(point.to_array(), radius));
    around(point, normal, [-radius, radius])
}

#[inline(always)]
pub(crate) fn normal<T: Real>([x, y, z]: [T; 3], radius: T) -> [T; 3] {
    [x / radius, y / radius, z / radius]
}

/// A ball before a sensor that is outside, in axes of which z points away from its centre.
pub(crate) struct Outside {
    radius_squared: f64,
    /// Of the centre.
    distance: f64,
    /// The square of a tangent's length.
    power: f64,
    per_power: f64,
}

impl Outside {
    pub(super) fn new(origin: [f64; 3], radius: f64, rows: &mut [[f64; 3]; 3]) -> Option<Self> {
        let origin = DVec3::from_array(origin);
        let distance = origin.length();
        let power = power_of_point(distance, radius).filter(|&power| power > 0.0)?;
        let z = origin / distance;
        let (x, y) = z.any_orthonormal_pair();
        turn(rows, [x, y, z].map(|axis| axis.to_array()));
        Some(Self { radius_squared: radius * radius, distance, power, per_power: 1.0 / power })
    }

    /// 1/t of a ray.
    #[inline(always)]
    pub(crate) fn inverse(&self, [x, y, z]: [f64; 3]) -> f64 {
        let discriminant = self.radius_squared * (z * z) - self.power * (x * x + y * y);
        let root = sqrt(if discriminant > 0.0 { discriminant } else { 0.0 });
        let inverse = (root - self.distance * z) * self.per_power;
        if discriminant >= 0.0 { inverse } else { 0.0 }
    }
}
