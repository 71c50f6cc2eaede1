//! Values printed like in Python.

use super::{Function, MAX_DEPTH, Value, View};
use std::fmt;

impl Value {
    /// Returns the result of Python's `repr`: like `str`, but with texts in quotes.
    pub(crate) fn repr(&self) -> String {
        match self {
            Self::Text(text) => quoted(text),
            other => other.to_string(),
        }
    }

    /// Returns the value for an error message: its text, shortened.
    pub(crate) fn shown(&self) -> String {
        let text =
            if self.size() < 10_000 { self.to_string() } else { format!("{} of many bytes", self.kind()) };
        if text.chars().count() <= 80 { text } else { text.chars().take(77).chain("...".chars()).collect() }
    }

    /// Returns the part of the value whose text differs in each run, if there is one.
    pub(crate) fn unprintable(&self) -> Option<&'static str> {
        match self {
            Self::Function(Function::Builtin(name)) if is_type(name) => None,
            Self::Iterator(_) | Self::Function(_) => Some(self.kind()),
            Self::Set(set) if set.borrow().len() > 1 => Some("a set of several items, which has no order"),
            Self::Set(set) => set.borrow().iter().find_map(|(item, _)| item.unprintable()),
            Self::List(list) => list.items.borrow().iter().find_map(Self::unprintable),
            Self::Tuple(tuple) => tuple.items.iter().find_map(Self::unprintable),
            Self::Map(map) | Self::View(_, map) => {
                map.entries.borrow().iter().find_map(|(key, value)| key.unprintable().or(value.unprintable()))
            }
            _ => None,
        }
    }
}

/// Returns true if a function is one of Python's types, which are printed as such.
pub(crate) fn is_type(name: &str) -> bool {
    ["bool", "dict", "float", "int", "list", "range", "set", "str", "tuple"].contains(&name)
}

impl fmt::Display for Value {
    /// Prints like Python's `str`: with the shortest digits that give the same number.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Text(text) => f.write_str(text),
            other => print(other, MAX_DEPTH, f),
        }
    }
}

fn print(value: &Value, depth: usize, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let Some(below) = depth.checked_sub(1) else { return f.write_str("...") };
    match value {
        Value::None => f.write_str("None"),
        Value::Bool(true) => f.write_str("True"),
        Value::Bool(false) => f.write_str("False"),
        Value::Int(int) => write!(f, "{int}"),
        Value::Float(float) => f.write_str(&float_text(*float)),
        Value::Text(text) => f.write_str(&quoted(text)),
        Value::List(list) => enclosed("[", list.items.borrow().iter(), "]", below, f),
        Value::Tuple(tuple) => {
            let end = if tuple.items.len() == 1 { ",)" } else { ")" };
            enclosed("(", tuple.items.iter(), end, below, f)
        }
        Value::Set(set) if set.borrow().len() == 0 => f.write_str("set()"),
        Value::Set(set) => enclosed("{", set.borrow().iter().map(|(item, _)| item), "}", below, f),
        Value::Map(map) => {
            f.write_str("{")?;
            for (index, (key, value)) in map.entries.borrow().iter().enumerate() {
                f.write_str(if index > 0 { ", " } else { "" })?;
                print(key, below, f)?;
                f.write_str(": ")?;
                print(value, below, f)?;
            }
            f.write_str("}")
        }
        Value::View(view, map) => {
            let entries = map.entries.borrow();
            match view {
                View::Keys => enclosed("dict_keys([", entries.iter().map(|(key, _)| key), "])", below, f),
                View::Values => {
                    enclosed("dict_values([", entries.iter().map(|(_, value)| value), "])", below, f)
                }
                View::Items => {
                    let pairs: Vec<Value> = entries
                        .iter()
                        .map(|(key, value)| Value::tuple(vec![key.clone(), value.clone()]))
                        .collect();
                    enclosed("dict_items([", pairs.iter(), "])", below, f)
                }
            }
        }
        Value::Range(range) if range.step == 1.into() => write!(f, "range({}, {})", range.start, range.end),
        Value::Range(range) => write!(f, "range({}, {}, {})", range.start, range.end, range.step),
        Value::Iterator(stream) => write!(f, "<{} object>", stream.kind),
        Value::Function(Function::Builtin(name)) if is_type(name) => write!(f, "<class '{name}'>"),
        Value::Function(_) => f.write_str("<function>"),
    }
}

fn enclosed<'a>(
    begin: &str,
    items: impl Iterator<Item = &'a Value>,
    end: &str,
    depth: usize,
    f: &mut fmt::Formatter<'_>,
) -> fmt::Result {
    f.write_str(begin)?;
    for (index, item) in items.enumerate() {
        f.write_str(if index > 0 { ", " } else { "" })?;
        print(item, depth, f)?;
    }
    f.write_str(end)
}

/// Returns a text in quotes, with escapes where Python writes them.
pub(crate) fn quoted(text: &str) -> String {
    use fmt::Write;
    let quote = if text.contains('\'') && !text.contains('"') { '"' } else { '\'' };
    let mut out = String::with_capacity(text.len() + 2);
    out.push(quote);
    for c in text.chars() {
        match c {
            '\\' => out.push_str("\\\\"),
            '\n' => out.push_str("\\n"),
            '\r' => out.push_str("\\r"),
            '\t' => out.push_str("\\t"),
            c if c == quote => out.extend(['\\', c]),
            c if u32::from(c) < 0x20 || (0x7f..0xa1).contains(&u32::from(c)) || c == '\u{ad}' => {
                // Writing to a String cannot fail.
                let _ = write!(out, "\\x{:02x}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out.push(quote);
    out
}

/// Returns a float as printed by Python: always with a point, with an exponent below 1e-4 and from 1e16 on.
pub(crate) fn float_text(value: f64) -> String {
    if !value.is_finite() {
        return if value.is_nan() {
            "nan".into()
        } else if value > 0.0 {
            "inf".into()
        } else {
            "-inf".into()
        };
    }
    // Rust and Python both print the shortest digits; only the layout differs.
    let mut scientific = format!("{value:e}");
    // Of two equally near shortest texts, Python uses the even one, like rounding to that number of digits.
    let places = scientific.find('e').unwrap_or(0).saturating_sub(if value < 0.0 { 3 } else { 2 });
    let rounded = format!("{value:.places$e}");
    if rounded.parse() == Ok(value) {
        scientific = rounded;
    }
    let (digits, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if value != 0.0 && !(-4..16).contains(&exponent) {
        let sign = if exponent < 0 { '-' } else { '+' };
        return format!("{digits}e{sign}{:02}", exponent.unsigned_abs());
    }
    plain(digits, exponent)
}

/// Writes digits such as `-1.25` times a power of ten without an exponent, with a point.
fn plain(digits: &str, exponent: i32) -> String {
    let (sign, digits) = match digits.strip_prefix('-') {
        Some(digits) => ("-", digits),
        None => ("", digits),
    };
    let digits = digits.replace('.', "");
    let Ok(exponent) = usize::try_from(exponent) else {
        return format!("{sign}0.{}{digits}", "0".repeat(exponent.unsigned_abs() as usize - 1));
    };
    let whole: String = digits.chars().chain(std::iter::repeat('0')).take(exponent + 1).collect();
    let rest = digits.get(exponent + 1..).filter(|rest| !rest.is_empty()).unwrap_or("0");
    format!("{sign}{whole}.{rest}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prints_like_python() {
        for (value, text) in [
            (1.0, "1.0"),
            (0.1 + 0.2, "0.30000000000000004"),
            (1e-4, "0.0001"),
            (1e-5, "1e-05"),
            (1.5e-7, "1.5e-07"),
            (1e15, "1000000000000000.0"),
            (1e16, "1e+16"),
            (-0.0, "-0.0"),
            (f64::INFINITY, "inf"),
            (123_456_789.125, "123456789.125"),
            (-(1_999_999_999_987_654.0 + 0.25), "-1999999999987654.2"),
            (0.001_25, "0.00125"),
            (100.0, "100.0"),
            (0.0, "0.0"),
        ] {
            assert_eq!(Value::Float(value).to_string(), text);
        }
        let list = Value::list(vec![Value::int(1), Value::text("a"), Value::Bool(true)]);
        assert_eq!(list.to_string(), "[1, 'a', True]");
        assert_eq!(Value::tuple(vec![Value::text("it's")]).to_string(), "(\"it's\",)");
    }
}
