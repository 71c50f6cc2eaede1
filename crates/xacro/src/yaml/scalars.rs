//! Scalars of YAML 1.1: numbers, booleans and null by the patterns that `PyYAML` resolves.

use crate::fault::Fault;
use crate::value::{Value, parse_int};
use num_bigint::BigInt;

/// Returns the value of a scalar without quotes and tag.
pub(super) fn plain(text: &str) -> Result<Value, Fault> {
    if let Some(value) =
        nothing(text).or_else(|| boolean(text)).or_else(|| integer(text)).or_else(|| float(text))
    {
        return Ok(value);
    }
    if is_date(text) || text == "=" {
        let what = format!("'{text}' is a date or a sign, which have no value here");
        return Err(Fault::new(what, "write it in quotes to make it a text"));
    }
    Ok(Value::text(text))
}

/// Returns the value of a text with one of YAML's own tags; `None` for other tags.
pub(super) fn by_tag(text: &str, tag: &str) -> Option<Result<Value, Fault>> {
    let value = match tag {
        "str" => Some(Value::text(text)),
        "null" => Some(Value::None),
        "bool" => boolean(text),
        "int" => integer(text),
        "float" => float(text).or_else(|| match integer(text)? {
            Value::Int(_) => text.replace('_', "").parse().ok().map(Value::Float),
            _ => None,
        }),
        _ => return None,
    };
    Some(value.ok_or_else(|| {
        Fault::new(format!("'{text}' is not a value of the tag '!!{tag}'"), "correct it there")
    }))
}

fn nothing(text: &str) -> Option<Value> {
    matches!(text, "" | "~" | "null" | "Null" | "NULL").then_some(Value::None)
}

fn boolean(text: &str) -> Option<Value> {
    match text {
        "true" | "True" | "TRUE" | "yes" | "Yes" | "YES" | "on" | "On" | "ON" => Some(Value::Bool(true)),
        "false" | "False" | "FALSE" | "no" | "No" | "NO" | "off" | "Off" | "OFF" => Some(Value::Bool(false)),
        _ => None,
    }
}

/// Returns the sign and the rest.
fn signed(text: &str) -> (bool, &str) {
    match text.strip_prefix('-') {
        Some(rest) => (true, rest),
        None => (false, text.strip_prefix('+').unwrap_or(text)),
    }
}

fn all(text: &str, belongs: impl Fn(u8) -> bool) -> bool {
    !text.is_empty() && text.bytes().all(|byte| byte == b'_' || belongs(byte))
}

fn digits(text: &str) -> bool {
    all(text, |byte| byte.is_ascii_digit())
}

/// Returns the parts of `1:30`; each but the first is below 60.
fn sexagesimal(text: &str) -> Option<Vec<&str>> {
    let parts: Vec<&str> = text.split(':').collect();
    let is_below_sixty = |part: &&str| match part.as_bytes() {
        [digit] => digit.is_ascii_digit(),
        [tens, digit] => (b'0'..=b'5').contains(tens) && digit.is_ascii_digit(),
        _ => false,
    };
    (parts.len() > 1 && parts[1..].iter().all(is_below_sixty)).then_some(parts)
}

fn integer(text: &str) -> Option<Value> {
    let (is_negative, unsigned) = signed(text);
    let of = |digits: &str, radix| parse_int(&digits.replace('_', ""), radix);
    let begins_well = unsigned.starts_with(|c: char| c.is_ascii_digit());
    let int = if let Some(binary) = unsigned.strip_prefix("0b").filter(|text| all(text, |byte| byte <= b'1'))
    {
        of(binary, 2)
    } else if let Some(hex) =
        unsigned.strip_prefix("0x").filter(|text| all(text, |byte| byte.is_ascii_hexdigit()))
    {
        of(hex, 16)
    } else if let Some(octal) = unsigned.strip_prefix('0').filter(|text| !text.is_empty()) {
        if all(octal, |byte| byte <= b'7') { of(octal, 8) } else { None }
    } else if let Some(parts) = sexagesimal(unsigned).filter(|_| begins_well) {
        if !digits(parts[0]) {
            return None;
        }
        parts.into_iter().try_fold(BigInt::from(0), |sum, part| Some(sum * 60 + of(part, 10)?))
    } else if begins_well && digits(unsigned) {
        of(unsigned, 10)
    } else {
        None
    }?;
    Some(Value::Int(if is_negative { -int } else { int }))
}

fn float(text: &str) -> Option<Value> {
    let (is_negative, unsigned) = signed(text);
    let sign = if is_negative { -1.0 } else { 1.0 };
    match unsigned {
        ".inf" | ".Inf" | ".INF" => return Some(Value::Float(sign * f64::INFINITY)),
        ".nan" | ".NaN" | ".NAN" if unsigned == text => return Some(Value::Float(f64::NAN)),
        _ => {}
    }
    let (whole, behind) = unsigned.split_once('.')?;
    if let Some(parts) = sexagesimal(whole) {
        let fits = digits(parts[0]) && !parts[0].starts_with('_') && (behind.is_empty() || digits(behind));
        if !fits {
            return None;
        }
        let (last, before) = parts.split_last()?;
        let number = |text: &str| text.replace('_', "").parse::<f64>().ok();
        let mut value = number(&format!("{last}.{behind}"))?;
        let mut base = 60.0;
        for part in before.iter().rev() {
            value += number(part)? * base;
            base *= 60.0;
        }
        return Some(Value::Float(sign * value));
    }
    let (fraction, exponent) = match behind.find(['e', 'E']) {
        Some(at) => (&behind[..at], Some(&behind[at + 1..])),
        None => (behind, None),
    };
    // An exponent needs a sign: 1.0e5 is a text.
    let has_exponent = exponent.is_none_or(|exponent| {
        exponent
            .strip_prefix(['-', '+'])
            .is_some_and(|digits| !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit()))
    });
    let begins_with_digit = |text: &str| text.starts_with(|c: char| c.is_ascii_digit());
    let fits = if whole.is_empty() {
        unsigned == text && begins_with_digit(fraction) && digits(fraction)
    } else {
        begins_with_digit(whole) && digits(whole) && (fraction.is_empty() || digits(fraction))
    };
    if !fits || !has_exponent {
        return None;
    }
    unsigned.replace('_', "").parse::<f64>().ok().map(|value| Value::Float(sign * value))
}

/// Returns true if a text is a date, or a date and a time.
fn is_date(text: &str) -> bool {
    let bytes = text.as_bytes();
    let count =
        |from: usize| bytes[from.min(bytes.len())..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    if count(0) != 4 || bytes.get(4) != Some(&b'-') {
        return false;
    }
    let month = count(5);
    let day = count(6 + month);
    let is_day = (1..=2).contains(&month) && bytes.get(5 + month) == Some(&b'-') && (1..=2).contains(&day);
    let end = 6 + month + day;
    is_day
        && ((end == bytes.len() && month == 2 && day == 2)
            || matches!(bytes.get(end), Some(b'T' | b't' | b' ' | b'\t')))
}
