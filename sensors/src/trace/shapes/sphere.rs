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

/// A ball, seen from outside, in axes in which z points away from its centre.
pub(crate) struct Outside {
    radius_squared: f64,
    /// The distance from the sensor to the centre.
    distance: f64,
    /// The square of the length of a tangent from the sensor.
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

    /// 1/t at which a ray first hits the ball; 0 or less for a miss.
    #[inline(always)]
    pub(crate) fn inverse(&self, [x, y, z]: [f64; 3]) -> f64 {
        let discriminant = self.radius_squared * (z * z) - self.power * (x * x + y * y);
        let root = sqrt(if discriminant > 0.0 { discriminant } else { 0.0 });
        let inverse = (root - self.distance * z) * self.per_power;
        if discriminant >= 0.0 { inverse } else { 0.0 }
    }
}
