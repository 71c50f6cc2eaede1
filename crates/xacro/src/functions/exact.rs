//! Integers of any size, and sums and quotients with a single rounding.

use crate::fault::Fault;
use crate::limits::{Work, bits};
use num_bigint::{BigInt, Sign};
use num_traits::{One, Signed, ToPrimitive, Zero};

/// Returns the quotient rounded down, and the remainder, which has the sign of the divisor.
pub(super) fn floor_division(a: &BigInt, b: &BigInt) -> (BigInt, BigInt) {
    let (quotient, remainder) = (a / b, a % b);
    if !remainder.is_zero() && (remainder.is_negative() != b.is_negative()) {
        (quotient - 1, remainder + b)
    } else {
        (quotient, remainder)
    }
}

/// Returns the float that is nearest to the quotient of two integers.
pub(super) fn quotient(a: &BigInt, b: &BigInt) -> Result<f64, Fault> {
    let exact = |int: &BigInt| int.bits() <= 53;
    if let (true, true, Some(a), Some(b)) = (exact(a), exact(b), a.to_f64(), b.to_f64()) {
        return Ok(a / b);
    }
    // A quotient of at least 66 bits, whose last bit is set if anything was cut off, is rounded correctly when it is
    // converted to a float, which uses only the first 54 bits and whether more follow.
    let shift = 66 + b.bits() as i64 - a.bits() as i64;
    let (dividend, divisor) = if shift >= 0 {
        (a.abs() << shift.unsigned_abs(), b.abs())
    } else {
        (a.abs(), b.abs() << shift.unsigned_abs())
    };
    let whole: BigInt = &dividend / &divisor;
    let whole = if (&dividend % &divisor).is_zero() { whole } else { whole | BigInt::one() };
    let value =
        libm::scalbn(whole.to_f64().unwrap_or(f64::INFINITY), i32::try_from(-shift).unwrap_or(i32::MIN));
    // For subnormal results, rounding would happen twice.
    if !value.is_finite() || (value != 0.0 && value < f64::MIN_POSITIVE) {
        return Err(Fault::new(
            "the quotient of two integers is not representable as a float",
            "use smaller numbers",
        ));
    }
    Ok(if a.is_negative() == b.is_negative() { value } else { -value })
}

/// Returns a power with a small integer exponent, with a single rounding: `10 ** -5` is 1e-05, for which libm's `pow`
/// is wrong in the last bit. `None` for other exponents, or if the result is not a normal number.
pub(super) fn power(base: f64, exponent: f64) -> Option<f64> {
    if exponent.fract() != 0.0 || exponent.abs() > 300.0 || !base.is_normal() {
        return None;
    }
    let (fraction, binary) = libm::frexp(base);
    // The mantissa as an integer of 53 bits.
    let mantissa = BigInt::from((fraction * 9_007_199_254_740_992.0) as i64);
    let count = exponent.abs() as u32;
    let shift = (i64::from(binary) - 53) * i64::from(count);
    if shift.abs() > 40_000 {
        return None;
    }
    let (mut above, mut below) = (mantissa.pow(count), BigInt::one());
    if shift >= 0 {
        above <<= shift.unsigned_abs();
    } else {
        below <<= shift.unsigned_abs();
    }
    if exponent < 0.0 {
        std::mem::swap(&mut above, &mut below);
    }
    quotient(&above, &below).ok()
}

/// Returns the sum of floats with a single rounding, like `math.fsum`: it keeps partial sums that do not overlap.
pub(super) fn float_sum(values: impl Iterator<Item = f64>) -> f64 {
    let mut partials: Vec<f64> = Vec::new();
    let mut special = 0.0;
    for mut x in values {
        if !x.is_finite() {
            special += x;
            continue;
        }
        let mut kept = 0;
        for at in 0..partials.len() {
            let mut y = partials[at];
            if x.abs() < y.abs() {
                std::mem::swap(&mut x, &mut y);
            }
            let high = x + y;
            let low = y - (high - x);
            if low != 0.0 {
                partials[kept] = low;
                kept += 1;
            }
            x = high;
        }
        partials.truncate(kept);
        partials.push(x);
    }
    if special != 0.0 || f64::is_nan(special) {
        return special;
    }
    let mut high = 0.0;
    let mut low = 0.0;
    while let Some(y) = partials.pop() {
        let x = high;
        high = x + y;
        low = y - (high - x);
        if low != 0.0 {
            break;
        }
    }
    // Ties are decided by the lower partial sums.
    if let Some(below) = partials.last()
        && ((low < 0.0 && *below < 0.0) || (low > 0.0 && *below > 0.0))
    {
        let doubled = low * 2.0;
        let rounded = high + doubled;
        if doubled == rounded - high {
            high = rounded;
        }
    }
    high
}

pub(super) fn gcd(a: &BigInt, b: &BigInt) -> BigInt {
    let (mut a, mut b) = (a.abs(), b.abs());
    while !b.is_zero() {
        (a, b) = (b.clone(), a % &b);
    }
    a
}

pub(super) fn lcm(a: &BigInt, b: &BigInt) -> Result<BigInt, Fault> {
    if a.is_zero() || b.is_zero() {
        return Ok(BigInt::zero());
    }
    bits(a.bits() + b.bits())?;
    Ok((a / gcd(a, b) * b).abs())
}

/// Returns `high · (high − 1) · …`, with `count` factors.
pub(super) fn falling_product(high: &BigInt, count: u64, work: &Work) -> Result<BigInt, Fault> {
    let mut product = BigInt::one();
    for at in 0..count {
        work.take(1)?;
        product *= high - at;
        bits(product.bits())?;
    }
    Ok(product)
}

/// Returns the number of ways to choose `k` of `n` items.
pub(super) fn choose(n: &BigInt, k: &BigInt, work: &Work) -> Result<BigInt, Fault> {
    if k > n {
        return Ok(BigInt::zero());
    }
    let k = k.clone().min(n - k);
    let count = k.to_u64().unwrap_or(u64::MAX);
    let mut result = BigInt::one();
    for at in 0..count {
        work.take(1)?;
        result = result * (n - at) / (at + 1);
        bits(result.bits())?;
    }
    Ok(result)
}

/// Returns the integer part of the square root of a non-negative integer.
pub(super) fn square_root(int: &BigInt) -> Option<BigInt> {
    (int.sign() != Sign::Minus).then(|| int.sqrt())
}
