//! Methods of texts that search for parts, positions and kinds of characters.

use super::{is_space, misuse};
use crate::fault::Fault;
use crate::value::Value;

/// Calls a method; `None` for another method or if it does not accept its arguments.
pub(super) fn method(text: &str, name: &str, arguments: &[Value]) -> Result<Option<Value>, Fault> {
    match (name, arguments) {
        ("find" | "rfind" | "index" | "rindex" | "count", [Value::Text(part), bounds @ ..])
            if bounds.len() <= 2 =>
        {
            return find(text, name, part, bounds, arguments);
        }
        ("startswith" | "endswith", [parts, bounds @ ..]) if bounds.len() <= 2 => {
            return Ok(ends(text, name, parts, bounds).map(Value::Bool));
        }
        _ => {}
    }
    if !arguments.is_empty() {
        return Ok(None);
    }
    let all = |belongs: &dyn Fn(char) -> bool| !text.is_empty() && text.chars().all(belongs);
    let is_cased = |c: char| c.is_lowercase() || c.is_uppercase();
    Ok(Some(Value::Bool(match name {
        "isdigit" | "isdecimal" | "isnumeric" => {
            if let Some(c) = text.chars().find(|c| !c.is_ascii() && c.is_numeric()) {
                return Err(Fault::new(
                    format!("{name}: whether '{c}' is a digit is not known"),
                    "use the digits 0 to 9",
                ));
            }
            all(&|c| c.is_ascii_digit())
        }
        "isalpha" => all(&char::is_alphabetic),
        "isalnum" => all(&char::is_alphanumeric),
        "isspace" => all(&is_space),
        "isascii" => text.is_ascii(),
        "isupper" => text.chars().any(is_cased) && !text.chars().any(char::is_lowercase),
        "islower" => text.chars().any(is_cased) && !text.chars().any(char::is_uppercase),
        "isidentifier" => {
            text.starts_with(|c: char| c.is_alphabetic() || c == '_')
                && all(&|c| c.is_alphanumeric() || c == '_')
        }
        "istitle" => {
            let mut before_is_cased = false;
            let mut found = false;
            for c in text.chars() {
                if (c.is_uppercase() && before_is_cased) || (c.is_lowercase() && !before_is_cased) {
                    return Ok(Some(Value::Bool(false)));
                }
                before_is_cased = is_cased(c);
                found |= before_is_cased;
            }
            found
        }
        _ => return Ok(None),
    })))
}

/// Returns the part of a text between two positions, counted in characters, and the position at which it begins. `None`
/// if the begin is after the end.
#[expect(clippy::option_option, reason = "the outer one is for bounds that are no integers")]
fn part<'t>(text: &'t str, bounds: &[Value]) -> Option<Option<(&'t str, usize)>> {
    let length = text.chars().count();
    let bound = |at: usize, default: usize| match bounds.get(at) {
        None | Some(Value::None) => Some(default as i64),
        Some(bound) => {
            let bound = bound.small_integer()?;
            Some(if bound < 0 { bound.saturating_add(length as i64).max(0) } else { bound })
        }
    };
    let (start, end) = (bound(0, 0)?, bound(1, length)?.min(length as i64));
    if start > end {
        return Some(None);
    }
    let byte = |at: i64| text.char_indices().nth(at as usize).map_or(text.len(), |(byte, _)| byte);
    Some(Some((&text[byte(start)..byte(end)], start as usize)))
}

fn find(text: &str, name: &str, what: &str, bounds: &[Value], all: &[Value]) -> Result<Option<Value>, Fault> {
    let Some(within) = part(text, bounds) else { return Ok(None) };
    if name == "count" {
        return Ok(Some(Value::int(within.map_or(0, |(within, _)| within.matches(what).count()))));
    }
    let found = within.and_then(|(within, start)| {
        let byte = if name.starts_with('r') { within.rfind(what) } else { within.find(what) };
        byte.map(|byte| start + within[..byte].chars().count())
    });
    match found {
        Some(place) => Ok(Some(Value::int(place))),
        None if name.ends_with("find") => Ok(Some(Value::int(-1))),
        None => Err(misuse(name, all)),
    }
}

fn ends(text: &str, name: &str, parts: &Value, bounds: &[Value]) -> Option<bool> {
    let within = part(text, bounds)?;
    let fits = |part: &str| match within {
        Some((within, _)) if name == "startswith" => within.starts_with(part),
        Some((within, _)) => within.ends_with(part),
        None => false,
    };
    match parts {
        Value::Text(part) => Some(fits(part)),
        Value::Tuple(tuple) => {
            let parts: Option<Vec<&str>> = tuple.items.iter().map(Value::as_text).collect();
            Some(parts?.into_iter().any(fits))
        }
        _ => None,
    }
}
