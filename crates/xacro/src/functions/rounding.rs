//! `round`, which rounds the exact binary value, with ties to the even digit.

use super::exact::floor_division;
use crate::fault::Fault;
use crate::limits::too_large;
use crate::value::{Value, integer_of};
use num_bigint::BigInt;
use num_traits::{One, Zero};

/// Rounds to an integer.
pub(super) fn to_integer(value: &Value) -> Option<Result<Value, Fault>> {
    match value {
        Value::Float(float) => {
            let rounded = integer_of(float.round_ties_even()).map(Value::Int);
            Some(
                rounded
                    .ok_or_else(|| Fault::new(format!("round({value}) has no value"), "correct the number")),
            )
        }
        other => other.integer().map(|int| Ok(Value::Int(int))),
    }
}

/// Rounds to a number of digits after the point, which may be negative.
pub(super) fn to_digits(value: &Value, digits: i64) -> Option<Result<Value, Fault>> {
    let Value::Float(float) = value else {
        let int = value.integer()?;
        return Some(if digits >= 0 {
            Ok(Value::Int(int))
        } else {
            to_power(&int, digits, false).map(Value::Int)
        });
    };
    if !float.is_finite() || digits > 330 {
        return Some(Ok(value.clone()));
    }
    if let Ok(digits) = usize::try_from(digits) {
        // Decimal formatting rounds the exact binary value.
        return format!("{float:.digits$}").parse().ok().map(|float| Ok(Value::Float(float)));
    }
    if digits < -310 {
        return Some(Ok(Value::Float(0.0_f64.copysign(*float))));
    }
    let int = integer_of(float.abs())?;
    let rounded = to_power(&int, digits, float.fract() != 0.0);
    Some(rounded.map(|rounded| Value::Float(crate::value::float_of(&rounded).copysign(*float))))
}

/// Rounds to a multiple of a power of ten. With `is_more`, the number is a fraction greater than the integer.
fn to_power(int: &BigInt, digits: i64, is_more: bool) -> Result<BigInt, Fault> {
    let power = u32::try_from(-digits).ok().filter(|power| *power < 5000).ok_or_else(too_large)?;
    let unit = BigInt::from(10).pow(power);
    let (whole, rest) = floor_division(int, &unit);
    let twice: BigInt = rest * 2;
    let is_odd = !(&whole % 2_u32).is_zero();
    let up = twice > unit || (twice == unit && (is_more || is_odd));
    Ok(if up { (whole + BigInt::one()) * unit } else { whole * unit })
}
