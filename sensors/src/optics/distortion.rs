//! Radial, tangential and thin-prism distortion in the plane at distance 1.
//!
//! With v = (x, y), r² = x² + y², q = (p2, p1), a = (s1, s3) and b = (s2, s4):
//!
//! v′ = v·N(r²)/D(r²) + 2(q·v)v + r²q + r²a + r⁴b,
//! N(s) = 1 + k1s + k2s² + k3s³, D(s) = 1 + k4s + k5s² + k6s³
//!
//! (OpenCV, documentation of `calib3d`; D. C. Brown, "Close-range camera calibration", 1971.)
//!
//! # Domain
//! The domain is a disc on which the map is one to one. A map is one to one on a convex set if the symmetric part of
//! its Jacobian is positive definite everywhere on it: then (v′ − u′)·(v − u) > 0 for any two points. In polar axes
//! that part is, with g(r) = r·N/D and w = 2a + 4br²,
//!
//! | g′ + r(6q_r + w_r) | r(2q_φ + w_φ/2) |
//! |---|---|
//! | r(2q_φ + w_φ/2) | g/r + 2rq_r |
//!
//! It is positive definite if the first diagonal element exceeds half of the off-diagonal one and the second exceeds
//! twice it, since their product then exceeds its square. (Half and twice, since of the two it is g′ that becomes small
//! at the rim of a wide lens.) For this to hold in all directions φ, q_r and the like are replaced by the lengths of
//! the vectors. Both conditions then are polynomials in r, and the disc ends at their first root. Without tangential
//! and prism terms the condition reduces to g′ > 0, which is exactly "the radial map increases". With these terms the
//! disc is slightly smaller than possible. It also ends before the poles of g, since g < 10⁶ is required.

use super::LARGEST_TANGENT;
use super::increasing::solve;
use super::lens::length;
use super::polynomial::Polynomial;
use glam::{DMat2, DVec2};

/// Coefficients and domain of a distortion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Distortion {
    /// 1, k1, k2, k3.
    numerator: [f64; 4],
    /// 1, k4, k5, k6.
    denominator: [f64; 4],
    /// (p2, p1).
    tangential: DVec2,
    /// (s1, s3).
    prism2: DVec2,
    /// (s2, s4).
    prism4: DVec2,
    /// Radius of the domain.
    max_radius: f64,
}

impl Distortion {
    /// Creates a distortion from k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4.
    pub(super) fn new([k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4]: [f64; 12]) -> Self {
        let mut made = Self {
            numerator: [1.0, k1, k2, k3],
            denominator: [1.0, k4, k5, k6],
            tangential: DVec2::new(p2, p1),
            prism2: DVec2::new(s1, s3),
            prism4: DVec2::new(s2, s4),
            max_radius: LARGEST_TANGENT,
        };
        made.max_radius = made.find_max_radius();
        made
    }

    /// Radius of the disc on which the map is one to one, at most [`LARGEST_TANGENT`].
    pub(super) fn max_radius(&self) -> f64 {
        self.max_radius
    }

    /// Returns true if a point is in the domain.
    pub(super) fn contains(&self, point: DVec2) -> bool {
        length(point) <= self.max_radius
    }

    /// Finds the radius of the domain from its conditions, as polynomials in r.
    fn find_max_radius(&self) -> f64 {
        let in_radius = |[c0, c1, c2, c3]: [f64; 4]| Polynomial::new([c0, 0.0, c1, 0.0, c2, 0.0, c3]);
        let (numerator, denominator) = (in_radius(self.numerator), in_radius(self.denominator));
        let [q, a, b] = [self.tangential, self.prism2, self.prism4].map(length);
        // First row, times D²: N·D + r(N′D − ND′) − (r(7q + 5a/2) + 5br³)D².
        let slope = numerator
            .derivative()
            .times(&denominator)
            .minus(&numerator.times(&denominator.derivative()))
            .times(&Polynomial::new([0.0, 1.0]));
        let losses = Polynomial::new([0.0, 7.0 * q + 2.5 * a, 0.0, 5.0 * b]);
        let along =
            numerator.times(&denominator).plus(&slope).minus(&losses.times(&denominator.times(&denominator)));
        // Second row, times D: N − (r(6q + 2a) + 4br³)D.
        let losses = Polynomial::new([0.0, 6.0 * q + 2.0 * a, 0.0, 4.0 * b]);
        let across = numerator.minus(&losses.times(&denominator));

        // Before a pole, D vanishes and g exceeds all bounds.
        let bounded = Polynomial::new([LARGEST_TANGENT])
            .times(&denominator)
            .minus(&numerator.times(&Polynomial::new([0.0, 1.0])));

        [bounded, across, along]
            .iter()
            .fold(LARGEST_TANGENT, |radius, condition| condition.positive_up_to(radius))
    }

    /// N/D and its derivative with respect to r².
    fn radial(&self, square: f64) -> (f64, f64) {
        let value = |[c0, c1, c2, c3]: [f64; 4]| c0 + square * (c1 + square * (c2 + square * c3));
        let slope = |[_, c1, c2, c3]: [f64; 4]| c1 + square * (2.0 * c2 + square * 3.0 * c3);
        let (above, below) = (value(self.numerator), value(self.denominator));
        let factor = above / below;
        (factor, (slope(self.numerator) - factor * slope(self.denominator)) / below)
    }

    /// Distorts a point of the domain.
    pub(super) fn apply(&self, point: DVec2) -> DVec2 {
        let square = point.dot(point);
        point * (self.radial(square).0 + 2.0 * self.tangential.dot(point))
            + (self.tangential + self.prism2 + self.prism4 * square) * square
    }

    /// Jacobian matrix of [`Distortion::apply`]: its columns are the derivatives with respect to x and y.
    fn jacobian(&self, point: DVec2) -> DMat2 {
        let square = point.dot(point);
        let (factor, slope) = self.radial(square);
        let q = self.tangential;
        let diagonal = factor + 2.0 * q.dot(point);
        let along = point * (2.0 * slope) + (q + self.prism2 + self.prism4 * (2.0 * square)) * 2.0;
        DMat2::from_cols(
            along * point.x + point * (2.0 * q.x) + DVec2::new(diagonal, 0.0),
            along * point.y + point * (2.0 * q.y) + DVec2::new(0.0, diagonal),
        )
    }

    /// Returns the point of the domain that is distorted to `target`, or `None` if there is none.
    ///
    /// The search starts from the solution for the radial terms alone, which is exact if there are no other terms.
    /// Newton's method in two dimensions follows, with steps halved until they improve the result, and kept inside the
    /// domain.
    pub(super) fn invert(&self, target: DVec2) -> Option<DVec2> {
        let distance = length(target);
        if distance == 0.0 {
            return Some(target);
        }
        let radial = |r: f64| {
            let (factor, slope) = self.radial(r * r);
            (r * factor, factor + 2.0 * r * r * slope)
        };
        let radius = solve(radial, distance, self.max_radius, distance.min(self.max_radius * 0.9));
        let mut point = target * (radius / distance);
        let mut error = self.apply(point) - target;
        for _ in 0..50 {
            let jacobian = self.jacobian(point);
            let step = DVec2::new(
                jacobian.y_axis.y * error.x - jacobian.y_axis.x * error.y,
                jacobian.x_axis.x * error.y - jacobian.x_axis.y * error.x,
            ) / (jacobian.x_axis.x * jacobian.y_axis.y - jacobian.y_axis.x * jacobian.x_axis.y);
            let mut share = 1.0;
            let better = loop {
                let there = self.nearest_in_domain(point - step * share);
                let error_there = self.apply(there) - target;
                if error_there.dot(error_there) < error.dot(error) {
                    break Some((there, error_there));
                }
                share *= 0.5;
                if share < 1e-3 {
                    break None;
                }
            };
            match better {
                Some(better) => (point, error) = better,
                None => break,
            }
        }
        // The residual inside the domain is rounding error: 1e-8 px at a focal length of 1000 px.
        (length(error) <= 1e-11 * (1.0 + distance) && self.contains(point)).then_some(point)
    }

    fn nearest_in_domain(&self, point: DVec2) -> DVec2 {
        let radius = length(point);
        if radius > self.max_radius { point * (self.max_radius / radius) } else { point }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [f64; 12] = [-0.3, 0.12, 2e-3, -1e-3, -0.02, 0.05, 0.01, 0.002, 1e-3, -5e-4, 8e-4, 3e-4];

    #[test]
    fn jacobian_is_the_slope() {
        let distortion = Distortion::new(ALL);
        for point in [DVec2::new(0.3, -0.4), DVec2::new(-0.7, 0.1), DVec2::ZERO] {
            let jacobian = distortion.jacobian(point);
            for (axis, column) in [(DVec2::X, jacobian.x_axis), (DVec2::Y, jacobian.y_axis)] {
                let step = axis * 1e-5;
                let slope = (distortion.apply(point + step) - distortion.apply(point - step)) / 2e-5;
                assert!((slope - column).length() < 1e-9, "{point}: {slope} {column}");
            }
        }
    }

    /// With a radial map only, the domain ends where its slope vanishes: 1 + 3k1·r² = 0.
    #[test]
    fn domain_ends_at_the_turn() {
        let mut barrel = [0.0; 12];
        barrel[0] = -0.3;
        let end = Distortion::new(barrel).max_radius();
        assert!((end - (1.0 / 0.9_f64).sqrt()).abs() < 1e-12, "{end}");
        // Tangential terms may only move the end inwards, and only slightly.
        (barrel[2], barrel[3]) = (1e-3, -5e-4);
        let nearer = Distortion::new(barrel).max_radius();
        assert!(nearer < end && nearer > end - 0.01, "{nearer}");
        // The pole of a rational map is at 1 − r² = 0, unless the map turns before.
        let mut pole = [0.0; 12];
        pole[5] = -1.0;
        assert!((Distortion::new(pole).max_radius() - 1.0).abs() < 1e-6);
        assert!(Distortion::new([0.0; 12]).max_radius() > 0.999 * LARGEST_TANGENT);
    }

    /// Checks what the domain's condition guarantees: the symmetric part is positive definite in the whole disc.
    #[test]
    fn symmetric_part_is_positive_definite_in_the_domain() {
        let distortion = Distortion::new(ALL);
        let end = distortion.max_radius();
        assert!(end > 0.9 && end < LARGEST_TANGENT, "{end}");
        for step in 0..=100 {
            for turn in 0..100 {
                let (sin, cos) = libm::sincos(f64::from(turn) * 0.062_831_853);
                let jacobian = distortion.jacobian(DVec2::new(cos, sin) * (end * f64::from(step) * 0.01));
                let symmetric = (jacobian + jacobian.transpose()) * 0.5;
                assert!(symmetric.x_axis.x > 0.0 && symmetric.determinant() > 0.0);
            }
        }
    }
}
