//! The interface of all lens models.

use glam::{DVec2, DVec3};

/// A central lens: the rays of all pixels pass through the origin of the optical frame.
///
/// The two methods are inverses of each other on the model's domain (see [the module](super)), to a few units in the
/// last place of the pixel's coordinates. Neither depends on the size of the image.
///
/// ```
/// use belvedere_sensors::optics::{Intrinsics, Lens, Pinhole};
/// use belvedere_sensors::glam::{DVec2, DVec3};
///
/// /// Distance between the pixels of two points.
/// fn apart(lens: &impl Lens, a: DVec3, b: DVec3) -> Option<f64> {
///     Some(lens.project(a)?.distance(lens.project(b)?))
/// }
/// let intrinsics = Intrinsics { fx: 300.0, fy: 400.0, cx: 319.5, cy: 239.5, skew: 0.0 };
/// let lens = Pinhole::new(intrinsics).unwrap();
/// assert_eq!(apart(&lens, DVec3::Z, DVec3::new(0.5, 0.5, 1.0)), Some(250.0));
/// assert_eq!(apart(&lens, DVec3::Z, DVec3::NEG_Z), None);
/// ```
pub trait Lens {
    /// Returns the pixel (column, row) of a point in the optical frame, in any unit of length, or `None` for the origin
    /// and for points that the lens does not see.
    fn project(&self, point_in_optical: DVec3) -> Option<DVec2>;

    /// Returns the unit direction of a pixel's ray in the optical frame, or `None` if the pixel has no ray.
    fn unproject(&self, pixel: DVec2) -> Option<DVec3>;
}

/// The direction of a vector, or `None` if it has none. Divides by the largest component first, so that no square
/// overflows or underflows.
pub(super) fn unit(vector: DVec3) -> Option<DVec3> {
    let largest = vector.abs().max_element();
    (vector.is_finite() && largest > 0.0).then(|| {
        let scaled = vector / largest;
        scaled / libm::sqrt(scaled.dot(scaled))
    })
}

/// Length of a vector in the plane. If its square overflows or loses digits, it is divided by its largest component
/// first.
pub(super) fn length(vector: DVec2) -> f64 {
    let square = vector.dot(vector);
    if square > 1e-280 && square < f64::INFINITY {
        return libm::sqrt(square);
    }
    let largest = vector.abs().max_element();
    if largest == 0.0 || !vector.is_finite() {
        return libm::sqrt(square);
    }
    let scaled = vector / largest;
    largest * libm::sqrt(scaled.dot(scaled))
}

/// The unit vector at an angle from the axis, in a direction around it. On the axis, that direction may have length 0.
pub(super) fn at_angle(angle: f64, around: DVec2, length_of_around: f64) -> DVec3 {
    if length_of_around == 0.0 {
        return DVec3::Z;
    }
    let (sin, cos) = libm::sincos(angle);
    // If dividing by the length would overflow, the direction around the axis is normalised first.
    if !(1e-300..=1e300).contains(&length_of_around) {
        let scaled = around / around.abs().max_element();
        return (scaled * (sin / length(scaled))).extend(cos);
    }
    (around * (sin / length_of_around)).extend(cos)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_of_every_size() {
        for size in [5e-324, 1e-300, 1.0, 1e300, f64::MAX] {
            let direction = unit(DVec3::new(size, 0.0, -size)).unwrap();
            assert!((direction - DVec3::new(0.5_f64.sqrt(), 0.0, -0.5_f64.sqrt())).length() < 1e-15);
        }
        for none in [DVec3::ZERO, DVec3::new(f64::NAN, 1.0, 1.0), DVec3::new(f64::INFINITY, 1.0, 1.0)] {
            assert_eq!(unit(none), None);
        }
    }
}
