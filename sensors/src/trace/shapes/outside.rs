//! The first hits of rays from one point outside a solid: 1/t, without a division.
//!
//! The rays of a picture share their origin. Then 1/t of a plane is linear in the direction, and 1/t of a ball or a
//! cylinder is the greater root of c·u² + 2·b·u + a = 0, whose c is the same for all rays. Everything that all rays
//! have in common is computed once, in axes in which the origin has few coordinates. For each ray, only some products
//! and at most two square roots remain: a third of the cost of [`Inside`](super::Inside), in double precision and with
//! the same accuracy.

use super::{capsule, cuboid, cylinder, ellipsoid, rectangle, sphere};
use crate::scene::Solid;

/// A solid, seen from outside.
pub(crate) enum Outside {
    Box(cuboid::Outside),
    Flat(rectangle::Outside),
    Ball(sphere::Outside),
    Cylinder(cylinder::Outside),
    Capsule(capsule::Outside),
}

/// Evaluates an expression for the kernel of an [`Outside`]. Its `inverse` returns 1/t of a ray, given by its direction
/// in the axes that [`Outside::new`] returns, or 0 or less for a miss.
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
    /// Creates the kernel of a solid of the given size, seen from `origin`, and returns it with the rows of the matrix
    /// to the axes of the kernel; `rows` are those of the matrix to the axes of the instance. Returns `None` if the
    /// sensor is inside the solid or almost on its surface, if it sees the inside of a surface that only counts from
    /// outside, or if the solid has no such kernel.
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
