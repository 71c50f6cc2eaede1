//! Values of expressions, with Python's rules for truth, equality and printing.

use std::fmt;

/// What an expression, a property or a macro parameter holds.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    None,
    Bool(bool),
    Int(i64),
    Float(f64),
    Text(String),
    /// Lists and tuples alike.
    List(Vec<Value>),
    /// A dictionary in the order of its file, its keys unlike one another.
    Map(Vec<(Value, Value)>),
}

impl Value {
    /// Reads a property's text as xacro does: a number if it is one, `true` and `false`, a text in single
    /// quotes without them, else the text itself. Underscores never belong to a number.
    pub(super) fn literal(text: &str) -> Self {
        if text.len() >= 2 && text.starts_with('\'') && text.ends_with('\'') {
            return Self::Text(text[1..text.len() - 1].to_owned());
        }
        let trimmed = text.trim();
        if let Ok(int) = trimmed.parse() {
            return Self::Int(int);
        }
        if let Ok(float) = trimmed.parse() {
            return Self::Float(float);
        }
        match text {
            "true" | "True" => Self::Bool(true),
            "false" | "False" => Self::Bool(false),
            _ => Self::Text(text.to_owned()),
        }
    }

    /// A text result is read again as a literal; anything else has its type already.
    pub(super) fn into_literal(self) -> Self {
        match self {
            Self::Text(text) => Self::literal(&text),
            other => other,
        }
    }

    /// Bytes, roughly.
    pub(super) fn size(&self) -> usize {
        let inside = match self {
            Self::Text(text) => text.len(),
            Self::List(items) => items.iter().map(Self::size).sum(),
            Self::Map(entries) => entries.iter().map(|(key, value)| key.size() + value.size()).sum(),
            _ => 0,
        };
        size_of::<Self>() + inside
    }

    /// Python's truth: zero and empty are false.
    pub(super) fn truth(&self) -> bool {
        match self {
            Self::None => false,
            Self::Bool(value) => *value,
            Self::Int(value) => *value != 0,
            Self::Float(value) => *value != 0.0,
            Self::Text(value) => !value.is_empty(),
            Self::List(value) => !value.is_empty(),
            Self::Map(value) => !value.is_empty(),
        }
    }

    /// The number, if it is one; a boolean counts as 0 or 1.
    pub(super) fn number(&self) -> Option<f64> {
        match self {
            Self::Float(value) => Some(*value),
            _ => self.integer().map(|value| value as f64),
        }
    }

    /// The integer, if it is one; a boolean counts as 0 or 1.
    pub(super) fn integer(&self) -> Option<i64> {
        match self {
            Self::Int(value) => Some(*value),
            Self::Bool(value) => Some(i64::from(*value)),
            _ => None,
        }
    }

    /// `==`: numbers compare by value whatever their type.
    pub(super) fn equals(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::List(a), Self::List(b)) => a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.equals(b)),
            _ => match (self.number(), other.number()) {
                (Some(a), Some(b)) => a == b,
                _ => self == other,
            },
        }
    }

    /// What a dictionary has under a key.
    pub(super) fn entry(&self, key: &Self) -> Option<&Self> {
        let Self::Map(entries) = self else { return None };
        entries.iter().find(|(known, _)| known.equals(key)).map(|(_, value)| value)
    }

    /// What it is, for error messages.
    pub(super) fn kind(&self) -> &'static str {
        match self {
            Self::None => "nothing",
            Self::Bool(_) => "a boolean",
            Self::Int(_) | Self::Float(_) => "a number",
            Self::Text(_) => "a text",
            Self::List(_) => "a list",
            Self::Map(_) => "a dictionary",
        }
    }
}

impl fmt::Display for Value {
    /// As Python's `str` prints it: the shortest digits that read back as the same number.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => f.write_str("None"),
            Self::Bool(true) => f.write_str("True"),
            Self::Bool(false) => f.write_str("False"),
            Self::Int(value) => write!(f, "{value}"),
            Self::Float(value) => f.write_str(&float_text(*value)),
            Self::Text(value) => f.write_str(value),
            Self::List(values) => {
                f.write_str("[")?;
                for (index, value) in values.iter().enumerate() {
                    if index > 0 {
                        f.write_str(", ")?;
                    }
                    inside(value, f)?;
                }
                f.write_str("]")
            }
            Self::Map(entries) => {
                f.write_str("{")?;
                for (index, (key, value)) in entries.iter().enumerate() {
                    if index > 0 {
                        f.write_str(", ")?;
                    }
                    inside(key, f)?;
                    f.write_str(": ")?;
                    inside(value, f)?;
                }
                f.write_str("}")
            }
        }
    }
}

/// A value within another: texts in quotes.
fn inside(value: &Value, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    match value {
        Value::Text(text) => write!(f, "'{text}'"),
        other => write!(f, "{other}"),
    }
}

/// A float as Python prints it: a point always, an exponent below 1e-4 and from 1e16 on.
fn float_text(value: f64) -> String {
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
    let scientific = format!("{value:e}");
    let (digits, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if value != 0.0 && !(-4..16).contains(&exponent) {
        let sign = if exponent < 0 { '-' } else { '+' };
        return format!("{digits}e{sign}{:02}", exponent.unsigned_abs());
    }
    format!("{value:?}")
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
        ] {
            assert_eq!(Value::Float(value).to_string(), text);
        }
        let list = Value::List(vec![Value::Int(1), Value::Text("a".into()), Value::Bool(true)]);
        assert_eq!(list.to_string(), "[1, 'a', True]");
    }

    #[test]
    fn literals_have_types() {
        assert_eq!(Value::literal("3"), Value::Int(3));
        assert_eq!(Value::literal(" 0.5 "), Value::Float(0.5));
        assert_eq!(Value::literal("'3'"), Value::Text("3".into()));
        assert_eq!(Value::literal("true"), Value::Bool(true));
        assert_eq!(Value::literal("1_000"), Value::Text("1_000".into()));
        assert_eq!(Value::literal("1 2"), Value::Text("1 2".into()));
    }
}
