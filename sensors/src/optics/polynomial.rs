//! Determines the interval on which a polynomial is positive.
//!
//! The derivative of a radial map is a polynomial (times a positive factor), so the domain of a lens ends at the first
//! root of a polynomial. The root is found without an initial guess: between two neighbouring roots of its derivative a
//! polynomial is monotonic, and has one root if its signs at the ends differ. Roots are therefore bracketed from the
//! highest derivative downwards, and each is found by bisection.

/// The highest power, needed for the condition on Brown–Conrady distortion with all its coefficients.
const DEGREE: usize = 15;

/// The polynomial c₀ + c₁x + … + c₁₅x¹⁵.
#[derive(Clone, Copy)]
pub(super) struct Polynomial([f64; DEGREE + 1]);

impl Polynomial {
    /// Creates a polynomial from its coefficients, lowest power first.
    pub(super) fn new<const N: usize>(coefficients: [f64; N]) -> Self {
        const { assert!(N <= DEGREE + 1) };
        Self(core::array::from_fn(|power| coefficients.get(power).copied().unwrap_or(0.0)))
    }

    /// The value at `x`.
    pub(super) fn at(&self, x: f64) -> f64 {
        self.0.iter().rev().fold(0.0, |sum, coefficient| sum * x + coefficient)
    }

    pub(super) fn plus(&self, other: &Self) -> Self {
        Self(core::array::from_fn(|power| self.0[power] + other.0[power]))
    }

    pub(super) fn minus(&self, other: &Self) -> Self {
        Self(core::array::from_fn(|power| self.0[power] - other.0[power]))
    }

    /// The product, whose degree must not exceed 15.
    pub(super) fn times(&self, other: &Self) -> Self {
        Self(core::array::from_fn(|power| (0..=power).map(|k| self.0[k] * other.0[power - k]).sum()))
    }

    pub(super) fn derivative(&self) -> Self {
        Self(core::array::from_fn(|power| match self.0.get(power + 1) {
            Some(coefficient) => coefficient * (power + 1) as f64,
            None => 0.0,
        }))
    }

    /// The greatest x up to `upper` such that the polynomial is positive on [0, x]; 0 if there is none.
    pub(super) fn positive_up_to(&self, upper: f64) -> f64 {
        let mut derivatives = [*self; DEGREE + 1];
        for order in 1..=DEGREE {
            derivatives[order] = derivatives[order - 1].derivative();
        }
        // Step 1: find the extrema, as the roots of derivatives of ever lower order.
        let (mut roots, mut count) = ([0.0; DEGREE + 1], 0);
        for derivative in derivatives[1..].iter().rev() {
            let (extrema, extrema_count) = (roots, count);
            count = 0;
            let mut low = 0.0;
            for index in 0..=extrema_count {
                let high = if index == extrema_count { upper } else { extrema[index] };
                let sign = derivative.is_positive(low);
                if derivative.is_positive(high) != sign {
                    roots[count] = derivative.change_of_sign(low, high, sign);
                    count += 1;
                }
                low = high;
            }
        }
        // Step 2: find the first extremum that is not positive, and the root before it.
        let mut low = 0.0;
        if !self.is_positive(low) {
            return 0.0;
        }
        for index in 0..=count {
            let high = if index == count { upper } else { roots[index] };
            if !self.is_positive(high) {
                return self.change_of_sign(low, high, true);
            }
            low = high;
        }
        upper
    }

    /// Returns true if the value at `x` is positive; false for NaN, which results from overflow.
    fn is_positive(&self, x: f64) -> bool {
        self.at(x) > 0.0
    }

    /// The last x between `low` and `high` with the same sign as at `low`, by bisection.
    fn change_of_sign(&self, mut low: f64, mut high: f64, sign: bool) -> f64 {
        // Enough iterations for a root of 1e-30 below an upper end of 1e6.
        for _ in 0..200 {
            let middle = low + (high - low) * 0.5;
            if !(middle > low && middle < high) {
                break;
            }
            if self.is_positive(middle) == sign {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    }
}

#[cfg(test)]
mod tests {
    use super::Polynomial;

    /// c·Π(x − root)
    fn with_roots(scale: f64, roots: &[f64]) -> Polynomial {
        roots
            .iter()
            .fold(Polynomial::new([scale]), |product, root| product.times(&Polynomial::new([-root, 1.0])))
    }

    #[test]
    fn first_root_of_many() {
        for (scale, roots, end) in [
            (1.0, &[][..], 9.0),
            (-1.0, &[2.0], 2.0),
            (1.0, &[2.0, 3.0], 2.0),
            // Roots below 0 and beyond the upper end are irrelevant.
            (1.0, &[-1.0, -2.0, 10.0, 11.0], 9.0),
            (-1.0, &[0.5, 0.500_01, 3.0, 4.0, 5.0], 0.5),
            (-1.0, &[1e-3, 1.0, 1.0, 1.0, 8.0], 1e-3),
            (-1.0, &[0.9; 15], 0.9),
            (-1.0, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0], 1.0),
            (-1.0, &[], 0.0),
            (f64::NAN, &[], 0.0),
        ] {
            let found = with_roots(scale, roots).positive_up_to(9.0);
            // A root of multiplicity fifteen is only determined to 1e-12^(1/15).
            let tolerance = if roots.len() == 15 && roots[0] == roots[1] { 0.2 } else { 1e-9 };
            assert!((found - end).abs() < tolerance, "{roots:?}: {found}");
        }
    }
}
