//! The words of an expression: numbers, texts, names and symbols.

use super::super::fault::Fault;
use super::super::value::Value;

/// Evaluation goes as deep as a chain of operators is long.
const MAX_TOKENS: usize = 1000;

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Token {
    Literal(Value),
    Name(String),
    Symbol(&'static str),
}

impl Token {
    pub(super) fn describe(&self) -> String {
        match self {
            Self::Literal(value) => format!("'{value}'"),
            Self::Name(name) => format!("'{name}'"),
            Self::Symbol(symbol) => format!("'{symbol}'"),
        }
    }
}

/// Longest first, so that `**` is not read as two `*`.
const SYMBOLS: [&str; 20] = [
    "**", "//", "==", "!=", "<=", ">=", "<", ">", "+", "-", "*", "/", "%", "(", ")", "[", "]", ",", ".", ":",
];

pub(super) fn syntax(text: &str, what: &str) -> Fault {
    Fault::new(
        format!("invalid expression '{}': {what}", text.trim()),
        "write a Python-like expression: numbers, properties, + - * / % **, comparisons, 'a if c else b'",
    )
}

pub(super) fn tokens(text: &str) -> Result<Vec<Token>, Fault> {
    let mut tokens = Vec::new();
    let mut rest = text.trim_start();
    while let Some(first) = rest.chars().next() {
        let next_is_digit = rest.chars().nth(1).is_some_and(|c| c.is_ascii_digit());
        let length = if first.is_ascii_digit() || (first == '.' && next_is_digit && !ends_operand(&tokens)) {
            let length = number_length(rest);
            let digits = rest[..length].replace('_', "");
            let value = digits.parse().map(Value::Int).or_else(|_| digits.parse().map(Value::Float));
            tokens.push(Token::Literal(
                value.map_err(|_| syntax(text, &format!("'{}' is not a number", &rest[..length])))?,
            ));
            length
        } else if first.is_alphabetic() || first == '_' {
            let length = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
            tokens.push(match &rest[..length] {
                "True" | "true" => Token::Literal(Value::Bool(true)),
                "False" | "false" => Token::Literal(Value::Bool(false)),
                "None" => Token::Literal(Value::None),
                name => Token::Name(name.to_owned()),
            });
            length
        } else if first == '\'' || first == '"' {
            let (value, length) =
                quoted(rest, first).ok_or_else(|| syntax(text, "a quoted text does not end"))?;
            tokens.push(Token::Literal(Value::Text(value)));
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

/// Whether a dot after these tokens is an attribute's, not a number's.
fn ends_operand(tokens: &[Token]) -> bool {
    matches!(tokens.last(), Some(Token::Name(_) | Token::Symbol(")" | "]")))
}

fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |mut at: usize| {
        while bytes.get(at).is_some_and(|b| b.is_ascii_digit() || *b == b'_') {
            at += 1;
        }
        at
    };
    let mut end = digits(0);
    if bytes.get(end) == Some(&b'.') {
        end = digits(end + 1);
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let exponent_end = digits(end + 1 + sign);
        if exponent_end > end + 1 + sign {
            end = exponent_end;
        }
    }
    end
}

/// The value of a quoted text at the start of `text`, and its length with the quotes.
fn quoted(text: &str, quote: char) -> Option<(String, usize)> {
    let mut value = String::new();
    let mut chars = text.char_indices().skip(1);
    while let Some((at, c)) = chars.next() {
        match c {
            '\\' => match chars.next()?.1 {
                'n' => value.push('\n'),
                't' => value.push('\t'),
                other if other == '\\' || other == '\'' || other == '"' => value.push(other),
                other => value.extend(['\\', other]),
            },
            _ if c == quote => return Some((value, at + 1)),
            _ => value.push(c),
        }
    }
    None
}
