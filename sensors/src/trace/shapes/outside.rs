//! Where rays from one point outside a solid meet it first: 1/t, without a division.
//!
//! Rays of a picture share their origin. Then 1/t of a plane is linear in the direction, and 1/t of a ball or a
//! cylinder is the greater root of c·u² + 2·b·u + a = 0, whose c is the same for all rays. What is the same is worked
//! out once, in axes in which the origin has few coordinates, and what is left for a ray is some products and at most
//! two square roots: a third of what [`Inside`](super::Inside) takes. In double precision as there, and to as many
//! digits.

use super::{capsule, cuboid, cylinder, ellipsoid, rectangle, sphere};
use crate::scene::Solid;

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
    /// Of a solid of that size, seen from `origin`, by the rows of a matrix to the axes of the instance; and those of
    /// the matrix to the axes of the kernel. None of a solid that the sensor is in or all but on, of one that shows its
    /// inside, and of those that have no such kernel.
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
