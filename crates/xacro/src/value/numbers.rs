//! Conversion of texts to numbers, and of integers of any size to floats.

use num_bigint::{BigInt, Sign};
use num_traits::{FromPrimitive, Num, ToPrimitive};

/// Returns the float nearest to an integer; infinite beyond the range of floats.
pub(crate) fn float_of(int: &BigInt) -> f64 {
    int.to_f64().unwrap_or(if int.sign() == Sign::Minus { f64::NEG_INFINITY } else { f64::INFINITY })
}

/// Returns the integer part of a finite float.
pub(crate) fn integer_of(float: f64) -> Option<BigInt> {
    BigInt::from_f64(float.trunc())
}

/// Parses an integer like Python's `int`, with white space around it and underscores between digits. With radix 0, the
/// prefixes `0x`, `0o` and `0b` are accepted.
pub(crate) fn parse_int(text: &str, radix: u32) -> Option<BigInt> {
    let text = text.trim();
    let (negative, digits) = match text.strip_prefix('-') {
        Some(digits) => (true, digits),
        None => (false, text.strip_prefix('+').unwrap_or(text)),
    };
    let lower = digits.to_ascii_lowercase();
    let prefixes = [("0x", 16), ("0o", 8), ("0b", 2)];
    let mut prefixed = prefixes.into_iter().filter(|(_, base)| radix == 0 || radix == *base);
    let found = prefixed.find_map(|(prefix, base)| Some((lower.strip_prefix(prefix)?, base)));
    let (digits, base) = match found {
        Some((digits, base)) => (digits.strip_prefix('_').unwrap_or(digits), base),
        // With radix 0, a leading zero without a letter is an error, except in zero itself.
        None if radix == 0 && lower.starts_with('0') && !lower.trim_matches(['0', '_']).is_empty() => {
            return None;
        }
        None => (lower.as_str(), if radix == 0 { 10 } else { radix }),
    };
    let well_formed = !digits.is_empty()
        && digits.chars().all(|c| c.is_digit(base) || c == '_')
        && digits.split('_').all(|part| !part.is_empty());
    if !well_formed || digits.len() > 20_000 {
        return None;
    }
    let int = BigInt::from_str_radix(&digits.replace('_', ""), base).ok()?;
    Some(if negative { -int } else { int })
}

/// Parses a float like Python's `float`.
pub(crate) fn parse_float(text: &str) -> Option<f64> {
    let text = text.trim();
    if !text.contains('_') {
        return text.parse().ok();
    }
    let bytes = text.as_bytes();
    let is_digit = |at: Option<usize>| at.and_then(|at| bytes.get(at)).is_some_and(u8::is_ascii_digit);
    let between = |at: usize| is_digit(at.checked_sub(1)) && is_digit(Some(at + 1));
    let fine = bytes.iter().enumerate().all(|(at, byte)| *byte != b'_' || between(at));
    if fine { text.replace('_', "").parse().ok() } else { None }
}

/// Prints an integer in a radix of 2, 8, 10 or 16, without a prefix, the sign first.
pub(crate) fn int_text(int: &BigInt, radix: u32) -> String {
    int.to_str_radix(radix)
}
