//! Vignetting: the darkening of an image towards its edges by the lens.

use crate::simd::{LANES, Lanes};

/// Vignetting: the light of a ray at the angle θ from the optical axis, as a fraction of that on the axis, is cos⁴θ ·
/// (1 + a·s + b·s² + c·s³) with s = sin²θ.
///
/// cos⁴θ is the natural vignetting of a thin lens in front of a flat sensor. The variable s runs from 0 to 1 at 90°, so
/// the polynomial is defined for every lens. No light passes from 90° on if natural vignetting is enabled, nor where
/// the polynomial is negative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vignetting {
    /// Whether the factor cos⁴θ applies.
    pub natural: bool,
    /// The coefficients a, b and c.
    pub polynomial: [f64; 3],
}

impl Vignetting {
    /// No vignetting.
    pub const NONE: Self = Self { natural: false, polynomial: [0.0; 3] };
    /// Natural vignetting, cos⁴θ, only.
    pub const NATURAL: Self = Self { natural: true, polynomial: [0.0; 3] };

    /// Returns the fraction of the light at an angle from the axis.
    ///
    /// ```
    /// use belvedere_sensors::device::Vignetting;
    /// assert!((Vignetting::NATURAL.at(std::f64::consts::FRAC_PI_4) - 0.25).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn at(&self, angle_rad: f64) -> f64 {
        let cos = libm::cos(angle_rad);
        let s = 1.0 - cos * cos;
        let [a, b, c] = self.polynomial;
        let natural = match self.natural {
            true if cos <= 0.0 => 0.0,
            true => cos * cos * cos * cos,
            false => 1.0,
        };
        natural * (1.0 + s * (a + s * (b + s * c))).max(0.0)
    }

    /// The fractions for the rays of a tile, whose directions may have any length.
    #[inline(always)]
    pub(super) fn of_rays(&self, directions: &[Lanes<f32>; 3], forward: [f32; 3]) -> Lanes<f32> {
        let [x, y, z] = directions;
        let [a, b, c] = self.polynomial.map(|term| term as f32);
        let mut shares = [0.0; LANES];
        for lane in 0..LANES {
            let along = x[lane] * forward[0] + y[lane] * forward[1] + z[lane] * forward[2];
            let square = x[lane] * x[lane] + y[lane] * y[lane] + z[lane] * z[lane];
            let cos2 = along * along / if square > 0.0 { square } else { 1.0 };
            let s = 1.0 - cos2;
            let polynomial = 1.0 + s * (a + s * (b + s * c));
            let natural = if along > 0.0 { cos2 * cos2 } else { 0.0 };
            let natural = if self.natural { natural } else { 1.0 };
            shares[lane] = natural * if polynomial > 0.0 { polynomial } else { 0.0 };
        }
        shares
    }
}
