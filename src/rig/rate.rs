//! [`Rate`]: rates as exact fractions, so that no timestamp drifts.

/// Frames per second as a fraction. The timestamp of frame k is ⌊k · 10⁹ · `denominator` / `numerator`⌋ ns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rate {
    numerator: u64,
    denominator: u64,
}

impl Rate {
    /// Returns the simplest fraction with a relative error of at most 1e-9, or `None` if the frequency is not between
    /// 1 µHz and 1 MHz.
    pub fn from_hz(hz: f64) -> Option<Self> {
        if !(1e-6..=1e6).contains(&hz) {
            return None;
        }
        // Continued fractions.
        let (mut before, mut now) = ((0_u64, 1_u64), (1_u64, 0_u64));
        let mut rest = hz;
        loop {
            let whole = rest as u64;
            let next = (whole * now.0 + before.0, whole * now.1 + before.1);
            (before, now) = (now, next);
            if (now.0 as f64 / now.1 as f64 - hz).abs() <= hz * 1e-9 {
                return Some(Self { numerator: now.0, denominator: now.1 });
            }
            rest = 1.0 / (rest - whole as f64);
        }
    }

    /// Returns the rate of one frame per period.
    pub fn from_period_ns(period_ns: u64) -> Self {
        Self { numerator: 1_000_000_000, denominator: period_ns.max(1) }
    }

    /// Returns the rate in frames per second.
    pub fn hz(&self) -> f64 {
        self.numerator as f64 / self.denominator as f64
    }

    /// Returns the timestamp of frame `k` in ns.
    pub fn stamp_ns(&self, k: u64) -> u64 {
        let exact = u128::from(k) * 1_000_000_000 * u128::from(self.denominator) / u128::from(self.numerator);
        u64::try_from(exact).unwrap_or(u64::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_become_their_fractions() {
        let fraction = |hz| Rate::from_hz(hz).map(|rate| (rate.numerator, rate.denominator));
        assert_eq!(fraction(30.0), Some((30, 1)));
        assert_eq!(fraction(5.5), Some((11, 2)));
        assert_eq!(fraction(29.97), Some((2997, 100)));
        assert_eq!(fraction(0.1), Some((1, 10)));
        assert_eq!(fraction(1.0 / 3.0), Some((1, 3)));
        assert_eq!([fraction(0.0), fraction(-1.0), fraction(f64::NAN), fraction(f64::INFINITY)], [None; 4]);
    }

    #[test]
    fn stamps_are_exact_for_a_year() {
        let rate = Rate::from_hz(30.0).unwrap();
        assert_eq!(
            [rate.stamp_ns(1), rate.stamp_ns(2), rate.stamp_ns(3)],
            [33_333_333, 66_666_666, 100_000_000]
        );
        let year = 365 * 24 * 3600;
        assert_eq!(rate.stamp_ns(30 * year), year * 1_000_000_000);
        assert_eq!(Rate::from_period_ns(5_000_000).stamp_ns(7), 35_000_000);
    }
}
