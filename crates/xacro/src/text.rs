//! Splits a text into plain text, `${expression}`, `$(extension)`, and the escapes `$${`, `$$(`.

use super::fault::Fault;

/// A part of a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Piece<'a> {
    /// Plain text.
    Text(&'a str),
    /// The inside of `${…}`.
    Expression(&'a str),
    /// The inside of `$(…)`.
    Extension(&'a str),
}

/// Returns the parts of `text`, in order.
pub(super) fn pieces(text: &str) -> Result<Vec<Piece<'_>>, Fault> {
    let mut pieces = Vec::new();
    let mut rest = text;
    while let Some(at) = rest.find('$') {
        if at > 0 {
            pieces.push(Piece::Text(&rest[..at]));
        }
        rest = &rest[at..];
        let dollars = rest.len() - rest.trim_start_matches('$').len();
        let bracket = rest[dollars..].chars().next().filter(|c| matches!(c, '{' | '('));
        rest = match bracket {
            Some(open) if dollars == 1 => {
                let end = end_of(rest, open).ok_or_else(|| {
                    let close = if open == '{' { '}' } else { ')' };
                    Fault::new(
                        format!("'$ {open}' without '{close}' in '{text}'").replacen("$ ", "$", 1),
                        format!("add the '{close}', or write $${open} for a plain ${open}"),
                    )
                })?;
                let inside = &rest[2..end];
                pieces.push(if open == '{' { Piece::Expression(inside) } else { Piece::Extension(inside) });
                &rest[end + 1..]
            }
            // One dollar is removed, and the bracket is plain text.
            Some(_) => {
                pieces.push(Piece::Text(&rest[1..=dollars]));
                &rest[dollars + 1..]
            }
            None => {
                pieces.push(Piece::Text(&rest[..dollars]));
                &rest[dollars..]
            }
        };
    }
    if !rest.is_empty() {
        pieces.push(Piece::Text(rest));
    }
    Ok(pieces)
}

/// Returns the position at which the bracket at byte 1 is closed. Brackets nest; brackets inside quotes are ignored,
/// and so is a quote after a backslash inside quotes.
fn end_of(text: &str, open: char) -> Option<usize> {
    let close = if open == '{' { '}' } else { ')' };
    let mut depth = 0_usize;
    let mut quote = None;
    let mut is_escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        if is_escaped {
            is_escaped = false;
            continue;
        }
        match quote {
            Some(_) if c == '\\' => is_escaped = true,
            Some(q) if c == q => quote = None,
            None if open == '{' && (c == '\'' || c == '"') => quote = Some(c),
            None if c == open => depth += 1,
            None if c == close => {
                depth -= 1;
                if depth == 0 {
                    return Some(at);
                }
            }
            Some(_) | None => {}
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn splits() {
        use Piece::{Expression, Extension, Text};
        for (text, expected) in [
            (
                "a ${b} $(find c)/d",
                vec![Text("a "), Expression("b"), Text(" "), Extension("find c"), Text("/d")],
            ),
            (
                "$${x} 5$ $$ $$$(y)",
                vec![
                    Text("${"),
                    Text("x} 5"),
                    Text("$"),
                    Text(" "),
                    Text("$$"),
                    Text(" "),
                    Text("$$("),
                    Text("y)"),
                ],
            ),
            ("${'}' + \"{\"}", vec![Expression("'}' + \"{\"")]),
            ("${'$(arg n)' == 'x'}", vec![Expression("'$(arg n)' == 'x'")]),
            ("$(eval (1+2)*3)", vec![Extension("eval (1+2)*3")]),
            ("", vec![]),
        ] {
            assert_eq!(pieces(text).unwrap(), expected, "{text}");
        }
        assert!(pieces("a ${b").unwrap_err().what.contains("'${' without '}'"));
        assert!(pieces("$(").is_err() && pieces("${é").is_err());
    }
}
