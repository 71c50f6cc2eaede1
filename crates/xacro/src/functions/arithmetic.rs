//! `+ - * / // % **` and the bitwise operators, by Python's rules for each type of operand.

use super::items::checked;
use super::{exact, percent, set};
use crate::expression::{Arithmetic, Unary};
use crate::fault::Fault;
use crate::limits::{Work, bits, sized};
use crate::value::{Value, float_of};
use num_bigint::BigInt;
use num_traits::{Signed, ToPrimitive, Zero};
use std::rc::Rc;

/// Applies an operator of one operand.
pub(crate) fn unary(operator: Unary, value: &Value) -> Result<Value, Fault> {
    let sign = match operator {
        Unary::Not => return Ok(Value::Bool(!value.truth())),
        Unary::Negate => "-",
        Unary::Plus => "+",
        Unary::Invert => "~",
    };
    Ok(match (operator, value, value.integer()) {
        (Unary::Negate, Value::Float(float), _) => Value::Float(-float),
        (Unary::Plus, Value::Float(float), _) => Value::Float(*float),
        (Unary::Negate, _, Some(int)) => Value::Int(-int),
        (Unary::Plus, _, Some(int)) => Value::Int(int),
        (Unary::Invert, _, Some(int)) => Value::Int(!int),
        _ => {
            return Err(Fault::new(
                format!("'{sign}' cannot be applied to {} ('{}')", value.kind(), value.shown()),
                "use a number there",
            ));
        }
    })
}

/// Applies an operator of two operands.
pub(crate) fn binary(operator: Arithmetic, left: &Value, right: &Value, work: &Work) -> Result<Value, Fault> {
    if let Some(result) = numbers(operator, left, right)? {
        return Ok(result);
    }
    let result = match (operator, left, right) {
        (Arithmetic::Add, Value::Text(a), Value::Text(b)) => {
            work.take(sized(a.len() + b.len())? / 64)?;
            Some(Value::Text(format!("{a}{b}")))
        }
        (Arithmetic::Add, Value::List(a), Value::List(b)) => {
            let items = a.items.borrow().iter().chain(b.items.borrow().iter()).cloned().collect();
            Some(checked(Value::list(items), work)?)
        }
        (Arithmetic::Add, Value::Tuple(a), Value::Tuple(b)) => {
            Some(checked(Value::tuple(a.items.iter().chain(&b.items).cloned().collect()), work)?)
        }
        (Arithmetic::Multiply, a, b) => {
            repeated(a, b, work)?.map_or_else(|| repeated(b, a, work), |x| Ok(Some(x)))?
        }
        (Arithmetic::Remainder, Value::Text(template), values) => {
            Some(checked(Value::Text(percent::format(template, values, work)?), work)?)
        }
        (Arithmetic::BitOr, Value::Map(a), Value::Map(b)) => {
            let mut entries = a.entries.borrow().clone();
            for (name, value) in b.entries.borrow().iter() {
                entries.insert(super::key(name)?, name.clone(), value.clone());
            }
            Some(checked(Value::map(entries), work)?)
        }
        (_, Value::Set(a), Value::Set(b)) => set::operator(operator, &a.borrow(), &b.borrow(), work)?,
        _ => None,
    };
    result.ok_or_else(|| {
        Fault::new(
            format!(
                "'{}' {} '{}': {} and {} do not go together",
                left.shown(),
                symbol(operator),
                right.shown(),
                left.kind(),
                right.kind()
            ),
            "use numbers on both sides, or str(…) to join texts",
        )
    })
}

fn symbol(operator: Arithmetic) -> &'static str {
    match operator {
        Arithmetic::Add => "+",
        Arithmetic::Subtract => "-",
        Arithmetic::Multiply => "*",
        Arithmetic::Divide => "/",
        Arithmetic::FloorDivide => "//",
        Arithmetic::Remainder => "%",
        Arithmetic::Power => "**",
        Arithmetic::BitAnd => "&",
        Arithmetic::BitOr => "|",
        Arithmetic::BitXor => "^",
        Arithmetic::ShiftLeft => "<<",
        Arithmetic::ShiftRight => ">>",
    }
}

/// Repeats a text, list or tuple; `None` for other operands.
fn repeated(items: &Value, count: &Value, work: &Work) -> Result<Option<Value>, Fault> {
    let Some(count) = count.integer() else { return Ok(None) };
    let count = if count.is_negative() { 0 } else { count.to_usize().unwrap_or(usize::MAX) };
    let fits = |size: usize| -> Result<(), Fault> { work.take(sized(count.saturating_mul(size))? / 64) };
    let cycle = |items: &[Value]| std::iter::repeat_n(items, count).flatten().cloned().collect();
    Ok(Some(match items {
        Value::Text(text) => {
            fits(text.len())?;
            Value::Text(text.repeat(if text.is_empty() { 0 } else { count }))
        }
        Value::List(list) => {
            fits(items.size())?;
            Value::list(cycle(&list.items.borrow()))
        }
        Value::Tuple(tuple) => {
            fits(items.size())?;
            Value::tuple(cycle(&tuple.items))
        }
        _ => return Ok(None),
    }))
}

/// Arithmetic of numbers; `None` if an operand is not a number.
fn numbers(operator: Arithmetic, left: &Value, right: &Value) -> Result<Option<Value>, Fault> {
    if let (Value::Bool(a), Value::Bool(b)) = (left, right) {
        match operator {
            Arithmetic::BitAnd => return Ok(Some(Value::Bool(a & b))),
            Arithmetic::BitOr => return Ok(Some(Value::Bool(a | b))),
            Arithmetic::BitXor => return Ok(Some(Value::Bool(a ^ b))),
            _ => {}
        }
    }
    if let (Some(a), Some(b)) = (left.integer(), right.integer()) {
        return integers(operator, &a, &b).map(Some);
    }
    let (Some(a), Some(b)) = (left.number(), right.number()) else { return Ok(None) };
    let too_large = |value: &Value, float: f64| float.is_infinite() && !matches!(value, Value::Float(_));
    if too_large(left, a) || too_large(right, b) {
        return Err(Fault::new("an integer is too large for a float", "use smaller numbers"));
    }
    floats(operator, a, b)
}

fn zero_division(left: impl std::fmt::Display, operator: Arithmetic) -> Fault {
    Fault::new(format!("{left} {} 0: division by zero", symbol(operator)), "correct the divisor")
}

fn integers(operator: Arithmetic, a: &BigInt, b: &BigInt) -> Result<Value, Fault> {
    let divides = matches!(operator, Arithmetic::Divide | Arithmetic::FloorDivide | Arithmetic::Remainder);
    if divides && b.is_zero() {
        return Err(zero_division(Value::Int(a.clone()).shown(), operator));
    }
    let result = match operator {
        Arithmetic::Add => a + b,
        Arithmetic::Subtract => a - b,
        Arithmetic::Multiply => {
            bits(a.bits() + b.bits())?;
            a * b
        }
        Arithmetic::Divide => return Ok(Value::Float(exact::quotient(a, b)?)),
        Arithmetic::FloorDivide => exact::floor_division(a, b).0,
        Arithmetic::Remainder => exact::floor_division(a, b).1,
        Arithmetic::Power if b.is_negative() => {
            return Ok(floats(operator, float_of(a), float_of(b))?.unwrap_or(Value::None));
        }
        Arithmetic::Power => {
            // The powers of 0, 1 and -1 stay small.
            let Some(exponent) = b.to_u32() else {
                let is_odd = !(b % 2_u32).is_zero();
                return match a.to_i8() {
                    Some(-1) => Ok(Value::int(if is_odd { -1 } else { 1 })),
                    Some(small @ (0 | 1)) => Ok(Value::int(small)),
                    _ => Err(crate::limits::too_large()),
                };
            };
            if a.bits() > 1 {
                bits((a.bits() - 1).saturating_mul(u64::from(exponent)))?;
            }
            a.pow(exponent)
        }
        Arithmetic::BitAnd => a & b,
        Arithmetic::BitOr => a | b,
        Arithmetic::BitXor => a ^ b,
        Arithmetic::ShiftLeft | Arithmetic::ShiftRight => {
            if b.is_negative() {
                return Err(Fault::new(
                    format!("'{}' {b}: the count is negative", symbol(operator)),
                    "correct the count",
                ));
            }
            let count = b.to_u64().unwrap_or(u64::MAX);
            if operator == Arithmetic::ShiftRight {
                // A shift by more bits than any integer has leaves only the sign.
                a >> count.min(1 << 20)
            } else if a.is_zero() {
                BigInt::zero()
            } else {
                bits(a.bits().saturating_add(count))?;
                a << count
            }
        }
    };
    bits(result.bits())?;
    Ok(Value::Int(result))
}

fn floats(operator: Arithmetic, a: f64, b: f64) -> Result<Option<Value>, Fault> {
    let divides = matches!(operator, Arithmetic::Divide | Arithmetic::FloorDivide | Arithmetic::Remainder);
    if (divides && b == 0.0) || (operator == Arithmetic::Power && a == 0.0 && b < 0.0) {
        return Err(zero_division(Value::Float(a), operator));
    }
    Ok(Some(Value::Float(match operator {
        Arithmetic::Add => a + b,
        Arithmetic::Subtract => a - b,
        Arithmetic::Multiply => a * b,
        Arithmetic::Divide => a / b,
        Arithmetic::FloorDivide => floor_division(a, b).0,
        Arithmetic::Remainder => floor_division(a, b).1,
        Arithmetic::Power => {
            let power = exact::power(a, b).unwrap_or_else(|| libm::pow(a, b));
            if power.is_nan() && !a.is_nan() && !b.is_nan() {
                let what = format!("{} ** {} is not a real number", Value::Float(a), Value::Float(b));
                return Err(Fault::new(what, "correct the base"));
            }
            if power.is_infinite() && a.is_finite() && b.is_finite() {
                let what = format!("{} ** {} is larger than any float", Value::Float(a), Value::Float(b));
                return Err(Fault::new(what, "correct the exponent"));
            }
            power
        }
        _ => return Ok(None),
    })))
}

/// Returns quotient and remainder of floats like Python's `divmod`: the remainder has the sign of the divisor, and the
/// quotient is computed from it.
pub(super) fn floor_division(a: f64, b: f64) -> (f64, f64) {
    let mut remainder = a % b;
    let mut quotient = (a - remainder) / b;
    if remainder == 0.0 {
        remainder = 0.0_f64.copysign(b);
    } else if (b < 0.0) != (remainder < 0.0) {
        remainder += b;
        quotient -= 1.0;
    }
    let whole = if quotient == 0.0 {
        0.0_f64.copysign(a / b)
    } else {
        let floor = quotient.floor();
        if quotient - floor > 0.5 { floor + 1.0 } else { floor }
    };
    (whole, remainder)
}

/// Returns the result of `is` for two values.
pub(crate) fn is_same(left: &Value, right: &Value) -> Result<bool, Fault> {
    Ok(match (left, right) {
        (Value::None, Value::None) => true,
        (Value::Bool(a), Value::Bool(b)) => a == b,
        (Value::List(a), Value::List(b)) => Rc::ptr_eq(a, b),
        (Value::Map(a), Value::Map(b)) => Rc::ptr_eq(a, b),
        (Value::Function(_), Value::Function(_)) => left.equals(right),
        // Whether equal numbers and texts are the same object depends on Python's implementation.
        (a, b) if a.type_name() == b.type_name() && !matches!(a, Value::Set(_) | Value::Iterator(_)) => {
            return Err(Fault::new(
                format!("'is' between {} and {} has no defined result", left.kind(), right.kind()),
                "write ==, or compare with None, True or False",
            ));
        }
        _ => false,
    })
}
