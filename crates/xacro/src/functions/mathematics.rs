//! The functions of Python's `math`, and the methods of numbers.

use super::items::items;
use super::{Arguments, exact};
use crate::fault::Fault;
use crate::limits::Work;
use crate::value::{Value, integer_of};
use num_bigint::BigInt;
use num_traits::{One, Signed, ToPrimitive, Zero};
use std::f64::consts;

pub(super) const NAMES: [&str; 54] = [
    "acos",
    "acosh",
    "asin",
    "asinh",
    "atan",
    "atan2",
    "atanh",
    "cbrt",
    "ceil",
    "comb",
    "copysign",
    "cos",
    "cosh",
    "degrees",
    "dist",
    "erf",
    "erfc",
    "exp",
    "exp2",
    "expm1",
    "fabs",
    "factorial",
    "floor",
    "fmod",
    "frexp",
    "fsum",
    "gamma",
    "gcd",
    "hypot",
    "isclose",
    "isfinite",
    "isinf",
    "isnan",
    "isqrt",
    "lcm",
    "ldexp",
    "lgamma",
    "log",
    "log10",
    "log1p",
    "log2",
    "modf",
    "nextafter",
    "perm",
    "pow",
    "prod",
    "radians",
    "remainder",
    "sin",
    "sinh",
    "sqrt",
    "tan",
    "tanh",
    "trunc",
];

/// Calls a function of numbers; `None` for another function, or if it has no real value.
pub(super) fn call(name: &str, arguments: &Arguments, work: &Work) -> Result<Option<Value>, Fault> {
    if !NAMES.contains(&name) {
        return Ok(None);
    }
    match name {
        "isclose" => return is_close(arguments),
        "prod" => return product(arguments, work),
        _ => {}
    }
    let arguments = arguments.unnamed(name)?;
    if let Some(result) = of_integers(name, arguments, work) {
        return result.map(Some);
    }
    match (name, arguments) {
        ("fsum", [values]) => {
            let values: Option<Vec<f64>> = items(values, work)?.iter().map(Value::number).collect();
            return Ok(values.map(|values| Value::Float(exact::float_sum(values.into_iter()))));
        }
        ("dist", [a, b]) => {
            let (a, b) = (items(a, work)?, items(b, work)?);
            let differences: Option<Vec<f64>> =
                a.iter().zip(&b).map(|(a, b)| Some(a.number()? - b.number()?)).collect();
            return Ok(differences.filter(|_| a.len() == b.len()).map(|all| Value::Float(length(&all))));
        }
        ("hypot", values) => {
            let values: Option<Vec<f64>> = values.iter().map(Value::number).collect();
            return Ok(values.map(|values| Value::Float(length(&values))));
        }
        _ => {}
    }
    Ok(of_one(name, arguments).or_else(|| of_two(name, arguments)))
}

fn length(values: &[f64]) -> f64 {
    match values {
        [] => 0.0,
        [first, rest @ ..] => rest.iter().fold(first.abs(), |length, value| libm::hypot(length, *value)),
    }
}

/// Returns `None` if the result is not a number although the arguments are: Python's "math domain error" and "math
/// range error".
fn fine(value: f64, inputs: &[f64]) -> Option<Value> {
    let fine = value.is_finite() || inputs.iter().any(|input| !input.is_finite());
    let is_new_nan = value.is_nan() && !inputs.iter().any(|input| input.is_nan());
    (fine && !is_new_nan).then_some(Value::Float(value))
}

fn of_one(name: &str, arguments: &[Value]) -> Option<Value> {
    let [value] = arguments else { return None };
    if let ("log" | "log2" | "log10", Value::Int(int)) = (name, value)
        && int.bits() > 1000
    {
        return large_logarithm(name, int);
    }
    let x = value.number()?;
    let result = match name {
        "sin" => libm::sin(x),
        "cos" => libm::cos(x),
        "tan" => libm::tan(x),
        "asin" => libm::asin(x),
        "acos" => libm::acos(x),
        "atan" => libm::atan(x),
        "sinh" => libm::sinh(x),
        "cosh" => libm::cosh(x),
        "tanh" => libm::tanh(x),
        "asinh" => libm::asinh(x),
        "acosh" => libm::acosh(x),
        "atanh" => libm::atanh(x),
        "sqrt" => x.sqrt(),
        "cbrt" => libm::cbrt(x),
        "exp" => libm::exp(x),
        "exp2" => libm::exp2(x),
        "expm1" => libm::expm1(x),
        "log" => libm::log(x),
        "log1p" => libm::log1p(x),
        "log2" => libm::log2(x),
        "log10" => libm::log10(x),
        "erf" => libm::erf(x),
        "erfc" => libm::erfc(x),
        "gamma" => libm::tgamma(x),
        "lgamma" => libm::lgamma(x),
        // Python multiplies by rounded values of π/180 and 180/π.
        "radians" => x * (consts::PI / 180.0),
        "degrees" => x * (180.0 / consts::PI),
        "fabs" => x.abs(),
        "isnan" => return Some(Value::Bool(x.is_nan())),
        "isinf" => return Some(Value::Bool(x.is_infinite())),
        "isfinite" => return Some(Value::Bool(x.is_finite())),
        "frexp" => {
            let (mantissa, exponent) = if x.is_finite() { libm::frexp(x) } else { (x, 0) };
            return Some(Value::tuple(vec![Value::Float(mantissa), Value::int(exponent)]));
        }
        "modf" => {
            let fraction = if x.is_infinite() { 0.0 } else { x % 1.0 };
            let parts = [fraction.copysign(x), x.trunc()];
            return Some(Value::tuple(parts.map(Value::Float).to_vec()));
        }
        _ => return None,
    };
    fine(result, &[x])
}

/// The logarithm of an integer that may exceed the range of floats.
fn large_logarithm(name: &str, int: &BigInt) -> Option<Value> {
    if !int.is_positive() {
        return None;
    }
    let shift = int.bits() - 60;
    let mantissa = (int >> shift).to_f64()?;
    let shift = shift as f64;
    Some(Value::Float(match name {
        "log2" => libm::log2(mantissa) + shift,
        "log10" => libm::log10(mantissa) + shift * libm::log10(2.0),
        _ => libm::log(mantissa) + shift * consts::LN_2,
    }))
}

fn of_two(name: &str, arguments: &[Value]) -> Option<Value> {
    let [first, second] = arguments else { return None };
    let (x, y) = (first.number()?, second.number()?);
    let result = match name {
        "atan2" => libm::atan2(x, y),
        "pow" => libm::pow(x, y),
        "fmod" => x % y,
        "copysign" => x.copysign(y),
        "log" => libm::log(x) / libm::log(y),
        "nextafter" => libm::nextafter(x, y),
        "remainder" => libm::remainder(x, y),
        "ldexp" => {
            let exponent = second.integer()?.to_i32().unwrap_or(if y < 0.0 { i32::MIN } else { i32::MAX });
            libm::ldexp(x, exponent)
        }
        _ => return None,
    };
    fine(result, &[x, y])
}

/// Functions with integer arguments or results; `None` for other functions.
fn of_integers(name: &str, arguments: &[Value], work: &Work) -> Option<Result<Value, Fault>> {
    let round = |round: fn(f64) -> f64| match arguments {
        [Value::Float(float)] => integer_of(round(*float)).map(|int| Ok(Value::Int(int))),
        [value] => value.integer().map(|int| Ok(Value::Int(int))),
        _ => None,
    };
    match name {
        "floor" => return round(f64::floor),
        "ceil" => return round(f64::ceil),
        "trunc" => return round(f64::trunc),
        "gcd" | "lcm" | "factorial" | "isqrt" | "comb" | "perm" => {}
        _ => return None,
    }
    let ints: Vec<BigInt> = arguments.iter().map(Value::integer).collect::<Option<_>>()?;
    let is_negative = ints.iter().any(Signed::is_negative);
    let result = match (name, &ints[..]) {
        ("gcd", ints) => Ok(ints.iter().fold(BigInt::zero(), |a, b| exact::gcd(&a, b))),
        ("lcm", ints) => ints.iter().try_fold(BigInt::one(), |a, b| exact::lcm(&a, b)),
        _ if is_negative => return None,
        ("factorial" | "perm", [n]) => exact::falling_product(n, n.to_u64()?, work),
        ("isqrt", [n]) => Ok(exact::square_root(n)?),
        ("comb", [n, k]) => exact::choose(n, k, work),
        ("perm", [n, k]) if k > n => Ok(BigInt::zero()),
        ("perm", [n, k]) => exact::falling_product(n, k.to_u64()?, work),
        _ => return None,
    };
    Some(result.map(Value::Int))
}

fn is_close(arguments: &Arguments) -> Result<Option<Value>, Fault> {
    let [mut a, mut b, mut relative, mut absolute] = [None, None, Some(1e-9), Some(0.0)];
    let places = arguments.placed("isclose", ["a", "b", "rel_tol", "abs_tol"])?;
    for (place, value) in [&mut a, &mut b, &mut relative, &mut absolute].into_iter().zip(places) {
        *place = value.map_or(*place, Value::number);
    }
    let (Some(a), Some(b), Some(relative), Some(absolute)) = (a, b, relative, absolute) else {
        return Ok(None);
    };
    if relative < 0.0 || absolute < 0.0 || arguments.positional.len() > 2 {
        return Ok(None);
    }
    let difference = (a - b).abs();
    let is_near =
        difference <= (relative * b).abs() || difference <= (relative * a).abs() || difference <= absolute;
    let is_finite = a.is_finite() && b.is_finite();
    Ok(Some(Value::Bool(a == b || (is_finite && is_near))))
}

fn product(arguments: &Arguments, work: &Work) -> Result<Option<Value>, Fault> {
    let start = match &arguments.named[..] {
        [] => Value::int(1),
        [(name, start)] if name == "start" => start.clone(),
        _ => return Ok(None),
    };
    let [values] = &arguments.positional[..] else { return Ok(None) };
    let multiply = crate::expression::Arithmetic::Multiply;
    let all = items(values, work)?;
    let product = all
        .iter()
        .try_fold(start, |product, value| super::arithmetic::binary(multiply, &product, value, work));
    product.map(Some)
}

/// Calls a method of a number.
pub(super) fn method(object: &Value, name: &str, arguments: &Arguments) -> Option<Value> {
    if !arguments.positional.is_empty() || !arguments.named.is_empty() {
        return None;
    }
    Some(match (name, object) {
        ("is_integer", Value::Float(float)) => Value::Bool(float.is_finite() && float.fract() == 0.0),
        ("conjugate", Value::Float(float)) => Value::Float(*float),
        ("conjugate", _) => Value::Int(object.integer()?),
        ("bit_length", _) => Value::int(object.integer()?.bits()),
        ("bit_count", _) => Value::int(object.integer()?.magnitude().count_ones()),
        _ => return None,
    })
}
