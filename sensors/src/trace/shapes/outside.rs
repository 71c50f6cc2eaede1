//! Where rays from one point outside a solid meet it first: 1/t, without a division.
//!
//! Rays of a picture share their origin. Then 1/t of a plane is linear in the direction, and 1/t of a ball or a
//! cylinder is the greater root of c·u² + 2·b·u + a = 0, whose c is the same for all rays. What is the same is worked
//! out once, in axes in which the origin has few coordinates, and what is left for a ray is some products and at most
//! two square roots: a third of what [`Inside`](super::Inside) takes. In double precision as there, and to as many digits.

use super::{capsule, cuboid, cylinder, ellipsoid, rectangle, sphere};
use crate::scene::Solid;

/// A sensor whose distance from a surface is less than this share of the solid's size has too few digits of it.
const BESIDE: f64 = 1e-6;

/// A solid before a sensor.
pub(crate) enum Outside {
    Box(cuboid::Outside),
    Flat(rectangle::Outside),
    Ball(sphere::Outside),
    Cylinder(cylinder::Outside),
    Capsule(capsule::Outside),
}

/// Evaluates an expression for the kernel that there is, which has `inverse`: 1/t of a ray by its direction in the axes
/// that [`Outside::new`] tells, or nothing above 0.
macro_rules! match_outside {
    ($outside:expr, $kernel:ident => $body:expr) => {
        match $outside {
            $crate::trace::shapes::outside::Outside::Box($kernel) => $body,
            $crate::trace::shapes::outside::Outside::Flat($kernel) => $body,
            $crate::trace::shapes::outside::Outside::Ball($kernel) => $body,
            $crate::trace::shapes::outside::Outside::Cylinder($kernel) => $body,
            $crate::trace::shapes::outside::Outside::Capsule($kernel) => $body,
        }
    };
}
pub(crate) use match_outside;

impl Outside {
    /// Of a solid of that size, seen from `origin`, by the rows of a matrix to the axes of the instance; and those of the
    /// matrix to the axes of the kernel. None of a solid that the sensor is in or all but on, of one that shows its inside,
    /// and of those that have no such kernel.
    pub(crate) fn new(
        solid: Solid,
        size: [f64; 3],
        origin: [f64; 3],
        both: bool,
        mut rows: [[f64; 3]; 3],
    ) -> Option<(Self, [[f64; 3]; 3])> {
        let [a, b, _] = size;
        let turned = &mut rows;
        let kernel = match solid {
            Solid::Box => cuboid::Outside::new(origin, size).map(Self::Box),
            Solid::Rectangle => rectangle::Outside::new(origin, [a, b], both).map(Self::Flat),
            Solid::Plane => rectangle::Outside::new(origin, [f64::INFINITY; 2], both).map(Self::Flat),
            Solid::Sphere => sphere::Outside::new(origin, a, turned).map(Self::Ball),
            Solid::Ellipsoid => ellipsoid::outside(origin, size, turned).map(Self::Ball),
            Solid::Cylinder => cylinder::Outside::new(origin, [a, b], turned).map(Self::Cylinder),
            Solid::Capsule => capsule::Outside::new(origin, [a, b], turned).map(Self::Capsule),
            Solid::Cone => None,
        };
        kernel.map(|kernel| (kernel, rows))
    }
}

/// |o|² − r² of a ball or a cylinder, where that is exact enough.
pub(super) fn beyond(distance: f64, radius: f64) -> Option<f64> {
    let beyond = (distance - radius) * (distance + radius);
    (beyond.abs() > BESIDE * radius * radius).then_some(beyond)
}

/// |x| ≤ half along an axis: 1/t of where rays enter and leave it.
#[derive(Clone, Copy)]
pub(super) struct Slab {
    /// What 1/t is for a direction of 1, and what is added: ∞ for rays that start in it.
    enter: [f64; 2],
    /// The planes by which rays may leave.
    leave: [f64; 2],
}

impl Slab {
    /// None for a sensor that is all but on a face.
    pub(super) fn new(origin: f64, half: f64) -> Option<Self> {
        let [low, high] = [-half - origin, half - origin];
        if low.abs().min(high.abs()) <= BESIDE * half {
            return None;
        }
        let (per_low, per_high) = (1.0 / low, 1.0 / high);
        Some(if low > 0.0 {
            Self { enter: [per_low, 0.0], leave: [per_high; 2] }
        } else if high < 0.0 {
            Self { enter: [per_high, 0.0], leave: [per_low; 2] }
        } else {
            Self { enter: [0.0, f64::INFINITY], leave: [per_low, per_high] }
        })
    }

    /// Whether all rays start in it.
    pub(super) fn is_around(&self) -> bool {
        self.enter[1] > 0.0
    }

    #[inline(always)]
    pub(super) fn enter(&self, direction: f64) -> f64 {
        direction * self.enter[0] + self.enter[1]
    }

    #[inline(always)]
    pub(super) fn leave(&self, direction: f64) -> f64 {
        greater(direction * self.leave[0], direction * self.leave[1])
    }
}

/// 1/t of what is entered before it is left.
#[inline(always)]
pub(super) fn first(enter: f64, leave: f64) -> f64 {
    if enter >= leave { enter } else { 0.0 }
}

#[inline(always)]
pub(super) fn lesser(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

#[inline(always)]
pub(super) fn greater(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// Multiplies a matrix by another from the left, both given by rows.
pub(super) fn turn(rows: &mut [[f64; 3]; 3], by: [[f64; 3]; 3]) {
    let [x, y, z] = *rows;
    for (row, [a, b, c]) in rows.iter_mut().zip(by) {
        for axis in 0..3 {
            row[axis] = (a * x[axis] + b * y[axis]) + c * z[axis];
        }
    }
}
