//! Capsules along z: a cylinder and a ball at each end.

use super::common_origin::power_of_point;
use super::cylinder::Side;
use super::real::Real;
use super::surface::{Surface, around};
use super::{Inside, cylinder, dot, sphere};
use crate::simd::sqrt;
use glam::DVec3;

#[inline(always)]
pub(crate) fn inside(origin: [f64; 3], direction: [f64; 3], [radius, half_length]: [f64; 2]) -> Inside {
    let [x, y, z] = origin;
    cylinder::inside(origin, direction, [radius, half_length])
        .hull(sphere::inside([x, y, z - half_length], direction, radius))
        .hull(sphere::inside([x, y, z + half_length], direction, radius))
}

#[inline(always)]
pub(crate) fn surface(point: DVec3, [radius, half_length]: [f64; 2]) -> Surface {
    let normal = DVec3::from_array(normal(point.to_array(), [radius, half_length]));
    around(point, normal, [-half_length - radius, half_length + radius])
}

#[inline(always)]
pub(crate) fn normal<T: Real>([x, y, z]: [T; 3], [radius, half_length]: [T; 2]) -> [T; 3] {
    let above = if z > half_length { z - half_length } else { T::ZERO };
    let below = if z < -half_length { z + half_length } else { T::ZERO };
    [x / radius, y / radius, (above + below) / radius]
}

/// A capsule, seen from a position beside it, in axes in which the sensor has y = 0.
pub(crate) struct Outside {
    side: Side,
    radius_squared: f64,
    half_length: f64,
    height: f64,
    /// The balls at the lower and the upper end.
    balls: [Ball; 2],
}

/// The ball at an end.
#[derive(Clone, Copy)]
struct Ball {
    /// The height of the sensor above its centre.
    height: f64,
    /// The square of the distance from the sensor to its centre.
    distance_squared: f64,
    per_power: f64,
}

impl Ball {
    fn new(distance: f64, height: f64, radius: f64) -> Option<Self> {
        let distance_squared = dot([distance, height], [distance, height]);
        let power = power_of_point(sqrt(distance_squared), radius)?;
        Some(Self { height, distance_squared, per_power: 1.0 / power })
    }
}

impl Outside {
    /// Returns `None` if the sensor is inside the endless cylinder, which includes positions beyond an end.
    pub(super) fn new(
        origin: [f64; 3],
        [radius, half_length]: [f64; 2],
        rows: &mut [[f64; 3]; 3],
    ) -> Option<Self> {
        let side = Side::new(origin, radius, rows).filter(|side| !side.is_around())?;
        let height = origin[2];
        let ball = |height: f64| Ball::new(side.distance, height, radius);
        let balls = [ball(height + half_length)?, ball(height - half_length)?];
        Some(Self { side, radius_squared: radius * radius, half_length, height, balls })
    }

    /// 1/t at which a ray first hits the capsule; 0 or less for a miss.
    #[inline(always)]
    pub(crate) fn inverse(&self, [x, y, z]: [f64; 3]) -> f64 {
        let ([inverse, _], meets) = self.side.ends(x, y);
        // The height at which the ray enters the endless cylinder, divided by t. Beyond an end, the ray can first hit
        // the ball there.
        let height = self.height * inverse + z;
        let on_side = height.abs() <= self.half_length * inverse;
        let [lower, upper] = self.balls;
        let ball = if height > 0.0 { upper } else { lower };
        let cross = ball.height * x - self.side.distance * z;
        let discriminant =
            self.radius_squared * (x * x + y * y + z * z) - (ball.distance_squared * (y * y) + cross * cross);
        let root = sqrt(if discriminant > 0.0 { discriminant } else { 0.0 });
        let on_ball = (root - (self.side.distance * x + ball.height * z)) * ball.per_power;
        let on_cap = if discriminant >= 0.0 { on_ball } else { 0.0 };
        let inverse = if on_side { inverse } else { on_cap };
        if meets { inverse } else { 0.0 }
    }
}
