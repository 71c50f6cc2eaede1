//! The tokens of an expression: numbers, texts, names and symbols.

use super::super::fault::Fault;
use super::super::value::Value;
use super::literals::{number, string};

/// A limit because evaluating a chain of operators nests as deeply as the chain is long.
const MAX_TOKENS: usize = 1000;

#[derive(Debug, Clone)]
pub(super) enum Token {
    Literal(Value),
    Name(String),
    Symbol(&'static str),
}

impl Token {
    pub(super) fn describe(&self) -> String {
        match self {
            Self::Literal(value) => format!("'{}'", value.shown()),
            Self::Name(name) => format!("'{name}'"),
            Self::Symbol(symbol) => format!("'{symbol}'"),
        }
    }
}

/// The longest come first, so that `**` is not read as two `*`.
const SYMBOLS: [&str; 30] = [
    "**", "//", "==", "!=", "<=", ">=", "<<", ">>", ":=", "<", ">", "+", "-", "*", "/", "%", "(", ")", "[",
    "]", "{", "}", ",", ".", ":", "&", "|", "^", "~", "=",
];

/// Returns the fault of an expression that cannot be parsed.
pub(super) fn syntax(text: &str, what: &str) -> Fault {
    let text = text.trim();
    let shown: String = text.chars().take(100).collect();
    let dots = if shown.len() < text.len() { "..." } else { "" };
    Fault::new(
        format!("invalid expression '{shown}{dots}': {what}"),
        "write a Python expression: numbers, properties, + - * / % **, comparisons, 'a if c else b'",
    )
}

pub(super) fn tokens(text: &str) -> Result<Vec<Token>, Fault> {
    let mut tokens = Vec::new();
    let mut rest = text.trim_start();
    while let Some(first) = rest.chars().next() {
        let next_is_digit = rest.chars().nth(1).is_some_and(|c| c.is_ascii_digit());
        let length = if first.is_ascii_digit() || (first == '.' && next_is_digit) {
            let (value, length) = number(rest).map_err(|what| syntax(text, &what))?;
            tokens.push(Token::Literal(value));
            length
        } else if let Some(found) = string(rest) {
            let (value, length) = found.map_err(|what| syntax(text, &what))?;
            tokens.push(Token::Literal(Value::Text(value)));
            length
        } else if first.is_alphabetic() || first == '_' {
            let length = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
            let name = &rest[..length];
            tokens.push(match name {
                "True" | "true" => Token::Literal(Value::Bool(true)),
                "False" | "false" => Token::Literal(Value::Bool(false)),
                "None" => Token::Literal(Value::None),
                _ if name.starts_with("__") => {
                    return Err(syntax(text, &format!("the name '{name}' begins with two underscores")));
                }
                _ => Token::Name(name.to_owned()),
            });
            length
        } else {
            let symbol = SYMBOLS.into_iter().find(|symbol| rest.starts_with(symbol));
            let symbol = symbol.ok_or_else(|| syntax(text, &format!("'{first}' has no meaning here")))?;
            tokens.push(Token::Symbol(symbol));
            symbol.len()
        };
        if tokens.len() > MAX_TOKENS {
            return Err(syntax(text, "it is too long"));
        }
        rest = rest[length..].trim_start();
    }
    Ok(tokens)
}
