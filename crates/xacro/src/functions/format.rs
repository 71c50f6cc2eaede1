//! Numbers and texts with a width, a precision and a type, for both `'…' % x` and `'…'.format(x)`.

use crate::fault::Fault;
use crate::limits::sized;
use crate::value::{Value, float_text, int_text, integer_of};
use num_bigint::BigInt;
use num_traits::{Signed, ToPrimitive};

/// The greatest precision; no float has more significant digits.
const MAX_PRECISION: usize = 1100;

/// A format specification.
#[derive(Debug, Clone, Default)]
pub(super) struct Spec {
    pub(super) fill: Option<char>,
    /// `<`, `>`, `^`, or `=`, which fills between sign and digits.
    pub(super) align: Option<char>,
    /// Whether a `0` before the width fills numbers with zeros.
    pub(super) is_zero: bool,
    /// `+`, ` `, or `-`, the default.
    pub(super) sign: Option<char>,
    /// True for `#`.
    pub(super) is_alternate: bool,
    pub(super) width: usize,
    /// `,` or `_`.
    pub(super) grouping: Option<char>,
    pub(super) precision: Option<usize>,
    /// The letter of the type.
    pub(super) kind: Option<char>,
}

fn refuse(value: &Value, spec: &Spec) -> Fault {
    let kind = spec.kind.map_or_else(|| "that format".into(), |kind| format!("the format '{kind}'"));
    Fault::new(
        format!("'{}' ({}) cannot be written in {kind}", value.shown(), value.kind()),
        "use d, x, o or b for integers, f, e, g or % for numbers, s for texts",
    )
}

impl Spec {
    /// Checks width and precision, which decide how much memory is needed.
    pub(super) fn check(&self) -> Result<(), Fault> {
        sized(self.width.saturating_mul(4))?;
        if self.precision.is_some_and(|precision| precision > MAX_PRECISION) && self.kind != Some('s') {
            let what = format!("a precision of more than {MAX_PRECISION} digits");
            return Err(Fault::new(what, "use a smaller precision"));
        }
        Ok(())
    }

    /// Writes a value as `format(value, spec)` does.
    pub(super) fn write(&self, value: &Value) -> Result<String, Fault> {
        self.check()?;
        match value {
            Value::Text(text) if matches!(self.kind, None | Some('s')) => self.text(text),
            Value::Float(float) => self.float(*float, value),
            Value::Int(_) | Value::Bool(_) => {
                let int = value.integer().ok_or_else(|| refuse(value, self))?;
                match self.kind {
                    None | Some('d' | 'b' | 'o' | 'x' | 'X' | 'n' | 'c') => self.integer(&int, value),
                    Some('e' | 'E' | 'f' | 'F' | 'g' | 'G' | '%') => {
                        let float = int.to_f64().filter(|float| float.is_finite());
                        self.float(float.ok_or_else(|| refuse(value, self))?, value)
                    }
                    Some(_) => Err(refuse(value, self)),
                }
            }
            _ => Err(refuse(value, self)),
        }
    }

    /// Writes a text, cut to the precision.
    pub(super) fn text(&self, text: &str) -> Result<String, Fault> {
        if self.sign.is_some() || self.is_alternate || self.grouping.is_some() || self.align == Some('=') {
            return Err(refuse(&Value::text(text), self));
        }
        let text: String = text.chars().take(self.precision.unwrap_or(usize::MAX)).collect();
        Ok(self.padded("", "", &text, '<'))
    }

    pub(super) fn integer(&self, int: &BigInt, value: &Value) -> Result<String, Fault> {
        if self.precision.is_some() {
            return Err(refuse(value, self));
        }
        let (radix, prefix) = match self.kind {
            Some('b') => (2, "0b"),
            Some('o') => (8, "0o"),
            Some('x') => (16, "0x"),
            Some('X') => (16, "0X"),
            Some('c') => {
                let is_bare = self.sign.is_none() && !self.is_alternate && self.grouping.is_none();
                let character = int.to_u32().and_then(char::from_u32).filter(|_| is_bare);
                let text = character.ok_or_else(|| refuse(value, self))?.to_string();
                return Ok(self.padded("", "", &text, '>'));
            }
            _ => (10, ""),
        };
        if self.grouping == Some(',') && radix != 10 || self.grouping.is_some() && self.kind == Some('n') {
            return Err(refuse(value, self));
        }
        let digits = int_text(&int.abs(), radix);
        let digits = if self.kind == Some('X') { digits.to_uppercase() } else { digits };
        let prefix = if self.is_alternate { prefix } else { "" };
        let sign = self.sign_of(int.is_negative());
        Ok(self.number(sign, prefix, &digits, if radix == 10 { 3 } else { 4 }))
    }

    pub(super) fn float(&self, float: f64, value: &Value) -> Result<String, Fault> {
        let precision = self.precision.unwrap_or(6);
        let magnitude = float.abs();
        let digits = if magnitude.is_finite() {
            match self.kind {
                Some('f' | 'F') => fixed(magnitude, precision, self.is_alternate),
                Some('%') => fixed(magnitude * 100.0, precision, self.is_alternate) + "%",
                Some('e' | 'E') => exponential(magnitude, precision, self.is_alternate),
                Some('g' | 'G' | 'n') => general(magnitude, precision, self.is_alternate),
                None => match self.precision {
                    None if self.is_alternate => with_point(&float_text(magnitude)),
                    None => float_text(magnitude),
                    Some(precision) => general_with_point(magnitude, precision, self.is_alternate),
                },
                Some(_) => return Err(refuse(value, self)),
            }
        } else {
            let percent = if self.kind == Some('%') { "%" } else { "" };
            if !matches!(self.kind, None | Some('f' | 'F' | 'e' | 'E' | 'g' | 'G' | 'n' | '%')) {
                return Err(refuse(value, self));
            }
            float_text(magnitude) + percent
        };
        if self.kind == Some('n') && self.grouping.is_some() {
            return Err(refuse(value, self));
        }
        let digits = if matches!(self.kind, Some('E' | 'F' | 'G')) { digits.to_uppercase() } else { digits };
        let sign = self.sign_of(float.is_sign_negative() && !float.is_nan());
        Ok(self.number(sign, "", &digits, 3))
    }

    fn sign_of(&self, is_negative: bool) -> &'static str {
        match self.sign {
            _ if is_negative => "-",
            Some('+') => "+",
            Some(' ') => " ",
            _ => "",
        }
    }

    /// Groups digits and fills up to the width.
    fn number(&self, sign: &str, prefix: &str, digits: &str, group: usize) -> String {
        let default = if self.is_zero { '=' } else { '>' };
        let Some(separator) = self.grouping else { return self.padded(sign, prefix, digits, default) };
        let end = digits.find(|c: char| !c.is_ascii_hexdigit() || (group == 3 && !c.is_ascii_digit()));
        let (whole, rest) = digits.split_at(end.unwrap_or(digits.len()));
        let mut whole = whole.to_owned();
        // Zeros that fill are grouped too.
        if self.fill == Some('0') && self.align.unwrap_or(default) == '=' && !whole.is_empty() {
            let room = self.width.saturating_sub(sign.len() + prefix.len() + rest.len());
            while grouped_length(whole.len(), group) < room {
                whole.insert(0, '0');
            }
        }
        let mut grouped = String::new();
        for (at, digit) in whole.chars().enumerate() {
            if at > 0 && (whole.len() - at).is_multiple_of(group) {
                grouped.push(separator);
            }
            grouped.push(digit);
        }
        self.padded(sign, prefix, &(grouped + rest), default)
    }

    fn padded(&self, sign: &str, prefix: &str, text: &str, default: char) -> String {
        let length = sign.len() + prefix.len() + text.chars().count();
        let missing = self.width.saturating_sub(length);
        let fill = |count: usize| self.fill.unwrap_or(' ').to_string().repeat(count);
        match self.align.unwrap_or(default) {
            '<' => format!("{sign}{prefix}{text}{}", fill(missing)),
            '^' => format!("{}{sign}{prefix}{text}{}", fill(missing / 2), fill(missing - missing / 2)),
            '=' => format!("{sign}{prefix}{}{text}", fill(missing)),
            _ => format!("{}{sign}{prefix}{text}", fill(missing)),
        }
    }
}

fn grouped_length(digits: usize, group: usize) -> usize {
    digits + (digits - 1) / group
}

fn fixed(value: f64, precision: usize, is_alternate: bool) -> String {
    if !value.is_finite() {
        return float_text(value);
    }
    let point = if precision == 0 && is_alternate { "." } else { "" };
    format!("{value:.precision$}{point}")
}

fn exponential(value: f64, precision: usize, is_alternate: bool) -> String {
    let (mantissa, exponent) = parts(value, precision);
    let point = if precision == 0 && is_alternate { "." } else { "" };
    format!("{mantissa}{point}{}", exponent_text(exponent))
}

/// The mantissa with a point, and the exponent, rounded to `precision` digits after the point.
fn parts(value: f64, precision: usize) -> (String, i32) {
    let text = format!("{value:.precision$e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    (mantissa.to_owned(), exponent.parse().unwrap_or(0))
}

fn exponent_text(exponent: i32) -> String {
    format!("e{}{:02}", if exponent < 0 { '-' } else { '+' }, exponent.unsigned_abs())
}

fn general(value: f64, precision: usize, is_alternate: bool) -> String {
    let precision = precision.max(1);
    let (mantissa, exponent) = parts(value, precision - 1);
    let is_fixed = exponent >= -4 && i64::from(exponent) < precision as i64;
    let (digits, behind) = if is_fixed {
        let digits = usize::try_from(precision as i64 - 1 - i64::from(exponent)).unwrap_or(0);
        (format!("{value:.digits$}"), String::new())
    } else {
        (mantissa, exponent_text(exponent))
    };
    if is_alternate {
        let point = if digits.contains('.') { "" } else { "." };
        return format!("{digits}{point}{behind}");
    }
    let digits =
        if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { &digits };
    format!("{digits}{behind}")
}

/// Like `general`, with at least one digit after the point, and an exponent from one digit earlier.
fn general_with_point(value: f64, precision: usize, is_alternate: bool) -> String {
    let precision = precision.max(1);
    let (mantissa, exponent) = parts(value, precision - 1);
    if exponent >= -4 && i64::from(exponent) < precision as i64 - 1 {
        let text = general(value, precision, is_alternate);
        return if text.contains('.') { text } else { text + ".0" };
    }
    let mantissa = match (is_alternate, mantissa.contains('.')) {
        (true, true) | (false, false) => mantissa,
        (true, false) => mantissa + ".",
        (false, true) => mantissa.trim_end_matches('0').trim_end_matches('.').to_owned(),
    };
    mantissa + &exponent_text(exponent)
}

/// Adds a point after the digits before an exponent, if there is none.
fn with_point(text: &str) -> String {
    match text.split_once('e') {
        Some((digits, exponent)) if !digits.contains('.') => format!("{digits}.e{exponent}"),
        _ => text.to_owned(),
    }
}

/// Returns the number truncated to an integer.
pub(super) fn truncated(value: &Value) -> Option<BigInt> {
    match value {
        Value::Float(float) => integer_of(*float),
        other => other.integer(),
    }
}
