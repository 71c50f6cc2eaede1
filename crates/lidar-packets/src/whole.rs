//! The rounding of all values in packets to whole numbers. Programs that write the same values elsewhere, for example to
//! point clouds, can use these functions to get the same numbers.
//!
//! They consist of comparisons and a sum, which compilers vectorize for every instruction set. `round` and saturating
//! conversions are not vectorized for SSE2. A value halfway between two whole numbers is rounded to the even one.

/// From these values on, `f32` and `f64` have no fractional bits. So adding one of them to a value leaves the nearest whole
/// number in the lower bits of the sum.
const WHOLE_F32: f32 = (1_u32 << 23) as f32;
const WHOLE_F64: f64 = (1_u64 << 52) as f64;

/// Returns the nearest whole number from 0 to `most`, which must be below 2²³. Returns 0 for NaN.
#[inline]
#[must_use]
pub fn nearest(value: f32, most: f32) -> u32 {
    let value = if value > 0.0 { value } else { 0.0 };
    let value = if value < most { value } else { most };
    (value + WHOLE_F32).to_bits() & 0x7F_FFFF
}

/// Returns the whole number that is nearest to a value from 0 to below `limit`, which must be at most 2³² − 0.5. Returns 0
/// for all other values and for NaN.
#[inline]
#[must_use]
pub fn nearest_below(value: f64, limit: f64) -> u32 {
    let value = if value > 0.0 { value } else { 0.0 };
    let value = if value < limit { value } else { 0.0 };
    (value + WHOLE_F64).to_bits() as u32
}

/// Returns the whole number that is nearest to a value from 0 to 2⁵¹.
#[inline]
#[must_use]
pub fn rounded(value: f64) -> f64 {
    (value + WHOLE_F64) - WHOLE_F64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_are_the_nearest_within_their_bounds() {
        for (value, expected) in [(0.49, 0), (0.51, 1), (254.49, 254), (254.51, 255), (1e30, 255), (-3.0, 0)]
        {
            assert_eq!(nearest(value, 255.0), expected, "{value}");
        }
        assert_eq!(
            [f32::NAN, f32::INFINITY, f32::NEG_INFINITY].map(|value| nearest(value, 65_535.0)),
            [0, 65_535, 0]
        );
        let limit = 524_287.5;
        for (value, expected) in [(524_287.49, 524_287), (524_287.5, 0), (1e300, 0), (-1.0, 0), (f64::NAN, 0)]
        {
            assert_eq!(nearest_below(value, limit), expected, "{value}");
        }
        // All values that are not close to halfway between two whole numbers.
        for step in 0..1_000_000_u32 {
            let off = 0.49 * f64::from(step % 1999) / 999.0 - 0.49;
            let value = f64::max(0.0, f64::from(step) + off);
            assert_eq!(nearest_below(value, limit * 2.0), step, "{value}");
            assert_eq!(rounded(value * 1000.0), (value * 1000.0).round_ties_even());
            assert_eq!(nearest(value as f32, 1e6), (value as f32).round_ties_even() as u32);
        }
    }
}
