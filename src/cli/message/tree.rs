//! A tree of named values, printed as YAML or JSON.

use serde_json::Value;
use std::fmt;

/// A value of a message.
#[derive(Clone, Debug, PartialEq)]
pub enum Tree {
    /// A whole number.
    Whole(u64),
    /// A number; may be NaN or infinite.
    Number(f64),
    /// True or false.
    Flag(bool),
    /// Text.
    Text(String),
    /// The first elements of an array and how many more it has.
    List(Vec<Tree>, usize),
    /// Named values in order.
    Map(Vec<(&'static str, Tree)>),
}

use Tree::{Flag, List, Map, Number, Text, Whole};

impl Tree {
    /// Converts the tree to JSON. NaN becomes null and infinities become text, because JSON has neither. A shortened
    /// array ends with a text that says so.
    #[must_use]
    pub fn to_json(&self) -> Value {
        match self {
            Whole(value) => (*value).into(),
            Number(value) if value.is_infinite() => if *value > 0.0 { "inf" } else { "-inf" }.into(),
            // Turns NaN into null.
            Number(value) => (*value).into(),
            Flag(value) => (*value).into(),
            Text(text) => text.as_str().into(),
            List(values, more) => {
                let mut values: Vec<Value> = values.iter().map(Self::to_json).collect();
                if *more > 0 {
                    values.push(format!("... {more} more").into());
                }
                values.into()
            }
            Map(entries) => {
                entries.iter().map(|(name, value)| ((*name).to_owned(), value.to_json())).collect()
            }
        }
    }

    fn write_yaml(&self, f: &mut fmt::Formatter<'_>, indent: usize) -> fmt::Result {
        match self {
            Map(entries) => {
                for (index, (name, value)) in entries.iter().enumerate() {
                    // The first name after "- " is on the same line.
                    let pad = if index == 0 { 0 } else { indent };
                    write!(f, "{:pad$}{name}:", "")?;
                    match value {
                        Map(_) => {
                            write!(f, "\n{:width$}", "", width = indent + 2)?;
                            value.write_yaml(f, indent + 2)?;
                        }
                        List(values, more) if matches!(values.first(), Some(Map(_))) => {
                            writeln!(f)?;
                            for value in values {
                                write!(f, "{:indent$}- ", "")?;
                                value.write_yaml(f, indent + 2)?;
                            }
                            if *more > 0 {
                                writeln!(f, "{:indent$}# ... {more} more", "")?;
                            }
                        }
                        scalar => {
                            write!(f, " ")?;
                            scalar.write_yaml(f, indent)?;
                            writeln!(f)?;
                        }
                    }
                }
                Ok(())
            }
            List(values, more) => {
                write!(f, "[")?;
                for (index, value) in values.iter().enumerate() {
                    write!(f, "{}", if index > 0 { ", " } else { "" })?;
                    value.write_yaml(f, indent)?;
                }
                if *more > 0 {
                    write!(f, ", ... {more} more")?;
                }
                write!(f, "]")
            }
            Whole(value) => write!(f, "{value}"),
            Number(value) if value.is_nan() => write!(f, ".nan"),
            Number(value) if value.is_infinite() => {
                write!(f, "{}", if *value > 0.0 { ".inf" } else { "-.inf" })
            }
            Number(value) => write!(f, "{value:?}"),
            Flag(value) => write!(f, "{value}"),
            Text(text) => write!(f, "{text:?}"),
        }
    }
}

impl fmt::Display for Tree {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.write_yaml(f, 0)
    }
}
