//! Closed cylinders along z: an endless cylinder cut by a slab.

use super::common_origin::{Slab, first, greater, lesser, power_of_point, turn};
use super::real::Real;
use super::surface::{Surface, around, flat};
use super::{Inside, dot};
use crate::simd::sqrt;
use glam::DVec3;

#[inline(always)]
pub(crate) fn inside([x, y, z]: [f64; 3], [dx, dy, dz]: [f64; 3], [radius, half_length]: [f64; 2]) -> Inside {
    // A ray along the axis is either always inside or never.
    let along = dot([dx, dy], [dx, dy]) <= 0.0;
    let round = Inside::ball([x, y], [if along { 1.0 } else { dx }, dy], radius);
    let never = dot([x, y], [x, y]) > radius * radius;
    let endless = Inside {
        enter: if along { f64::NEG_INFINITY } else { round.enter },
        exit: if along { f64::INFINITY } else { round.exit },
    };
    endless.when(!(along && never)).intersection(Inside::slab(z, dz, half_length))
}

#[inline(always)]
pub(crate) fn surface(point: DVec3, [radius, half_length]: [f64; 2]) -> Surface {
    let (is_end, sign) = end(point.to_array(), [radius, half_length]);
    let normal = DVec3::from_array(normal(point.to_array(), [radius, half_length]));
    let per_metre = 0.5 / radius;
    let end = flat(normal, point, [DVec3::X * per_metre, DVec3::Y * (sign * per_metre)]);
    let side = around(point, normal, [-half_length, half_length]);
    if is_end { end } else { side }
}

/// Returns true if a point of the surface is on an end, and the sign of z.
#[inline(always)]
fn end<T: Real>([x, y, z]: [T; 3], [radius, half_length]: [T; 2]) -> (bool, T) {
    let sign = if z < T::ZERO { -T::ONE } else { T::ONE };
    let to_axis = (x * x + y * y).sqrt();
    (half_length - z * sign < radius - to_axis, sign)
}

#[inline(always)]
pub(crate) fn normal<T: Real>(point: [T; 3], [radius, half_length]: [T; 2]) -> [T; 3] {
    let (is_end, sign) = end(point, [radius, half_length]);
    let [x, y, _] = point;
    let zero = T::ZERO;
    if is_end { [zero, zero, sign] } else { [x / radius, y / radius, zero] }
}

/// An endless cylinder, in axes in which the sensor has y = 0. The sensor may be inside.
#[derive(Clone, Copy)]
pub(super) struct Side {
    radius_squared: f64,
    /// The distance from the sensor to the axis.
    pub(super) distance: f64,
    /// The square of the length of a tangent from the sensor; negative inside.
    power: f64,
    per_power: f64,
}

impl Side {
    pub(super) fn new(origin: [f64; 3], radius: f64, rows: &mut [[f64; 3]; 3]) -> Option<Self> {
        let [x, y, _] = origin;
        let distance = sqrt(dot([x, y], [x, y]));
        let power = power_of_point(distance, radius)?;
        let (cos, sin) = if distance > 0.0 { (x / distance, y / distance) } else { (1.0, 0.0) };
        turn(rows, [[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]]);
        Some(Self { radius_squared: radius * radius, distance, power, per_power: 1.0 / power })
    }

    /// Returns true if the sensor is inside.
    pub(super) fn is_around(&self) -> bool {
        self.power < 0.0
    }

    /// 1/t at which a ray enters, if the sensor is outside, and at which it leaves; and whether the ray hits the
    /// cylinder.
    #[inline(always)]
    pub(super) fn ends(&self, x: f64, y: f64) -> ([f64; 2], bool) {
        let discriminant = self.radius_squared * (x * x) - self.power * (y * y);
        let root = sqrt(if discriminant > 0.0 { discriminant } else { 0.0 });
        let middle = -self.distance * x;
        ([(middle + root) * self.per_power, (middle - root) * self.per_power], discriminant >= 0.0)
    }
}

/// A cylinder, seen from outside.
pub(crate) struct Outside {
    side: Side,
    ends: Slab,
    /// Added to 1/t of entering through the side: ∞ if the sensor is inside the endless cylinder, beyond an end.
    before_end: f64,
}

impl Outside {
    pub(super) fn new(
        origin: [f64; 3],
        [radius, half_length]: [f64; 2],
        rows: &mut [[f64; 3]; 3],
    ) -> Option<Self> {
        let ends = Slab::new(origin[2], half_length)?;
        let side = Side::new(origin, radius, rows)?;
        let before_end = if side.is_around() { f64::INFINITY } else { 0.0 };
        (!(side.is_around() && ends.is_around())).then_some(Self { side, ends, before_end })
    }

    /// 1/t at which a ray first hits the cylinder; 0 or less for a miss.
    #[inline(always)]
    pub(crate) fn inverse(&self, [x, y, z]: [f64; 3]) -> f64 {
        let ([enter, leave], meets) = self.side.ends(x, y);
        let inverse =
            first(lesser(enter + self.before_end, self.ends.enter(z)), greater(leave, self.ends.leave(z)));
        if meets { inverse } else { 0.0 }
    }
}
