//! Methods of texts that return another text or a list.

use super::items::{checked, items};
use super::{Arguments, is_space, misuse, template, text_search};
use crate::fault::Fault;
use crate::limits::{Work, sized};
use crate::value::Value;

pub(super) const NAMES: [&str; 42] = [
    "capitalize",
    "center",
    "count",
    "endswith",
    "expandtabs",
    "find",
    "format",
    "index",
    "isalnum",
    "isalpha",
    "isascii",
    "isdecimal",
    "isdigit",
    "isidentifier",
    "islower",
    "isnumeric",
    "isspace",
    "istitle",
    "isupper",
    "join",
    "ljust",
    "lower",
    "lstrip",
    "partition",
    "removeprefix",
    "removesuffix",
    "replace",
    "rfind",
    "rindex",
    "rjust",
    "rpartition",
    "rsplit",
    "rstrip",
    "split",
    "splitlines",
    "startswith",
    "strip",
    "swapcase",
    "title",
    "upper",
    "zfill",
    "casefold",
];

pub(super) fn method(
    text: &str,
    name: &str,
    arguments: &Arguments,
    work: &Work,
) -> Result<Option<Value>, Fault> {
    work.take(1 + text.len() / 64)?;
    match name {
        "format" => return checked(Value::Text(template::format(text, arguments, work)?), work).map(Some),
        "split" | "rsplit" => return split(text, name, arguments, work),
        "splitlines" => {
            let [keep] = arguments.placed(name, ["keepends"])?;
            let lines = lines(text, keep.is_some_and(Value::truth));
            return checked(Value::list(lines.into_iter().map(Value::text).collect()), work).map(Some);
        }
        "expandtabs" => {
            let [width] = arguments.placed(name, ["tabsize"])?;
            let width = width.map_or(Some(8), Value::small_integer);
            let Some(width) = width else { return Ok(None) };
            return expand_tabs(text, usize::try_from(width).unwrap_or(0), work)
                .map(|text| Some(Value::Text(text)));
        }
        _ => {}
    }
    let positional = arguments.unnamed(name)?;
    if let Some(value) = text_search::method(text, name, positional)? {
        return Ok(Some(value));
    }
    Ok(match (name, positional) {
        ("upper", []) => Some(Value::Text(text.to_uppercase())),
        ("lower", []) => Some(Value::Text(text.to_lowercase())),
        ("casefold", []) if text.is_ascii() => Some(Value::Text(text.to_ascii_lowercase())),
        ("capitalize", []) => {
            let mut characters = text.chars();
            let first = characters.next().map(String::from).unwrap_or_default();
            Some(Value::Text(titlecase(&first) + &characters.as_str().to_lowercase()))
        }
        ("title", []) => Some(Value::Text(title(text))),
        ("swapcase", []) => {
            let swap = |c: char| -> String {
                if c.is_uppercase() { c.to_lowercase().collect() } else { c.to_uppercase().collect() }
            };
            Some(Value::Text(text.chars().map(swap).collect()))
        }
        ("strip" | "lstrip" | "rstrip", [] | [Value::None]) => Some(strip(text, name, &is_space)),
        ("strip" | "lstrip" | "rstrip", [Value::Text(set)]) => Some(strip(text, name, &|c| set.contains(c))),
        ("removeprefix", [Value::Text(part)]) => {
            Some(Value::text(text.strip_prefix(part.as_str()).unwrap_or(text)))
        }
        ("removesuffix", [Value::Text(part)]) => {
            Some(Value::text(text.strip_suffix(part.as_str()).unwrap_or(text)))
        }
        ("replace", [Value::Text(old), Value::Text(new), count @ ..]) if count.len() <= 1 => {
            let count = match count {
                [] => Some(-1),
                [count, ..] => count.small_integer(),
            };
            let Some(count) = count else { return Ok(None) };
            let count = usize::try_from(count).unwrap_or(usize::MAX);
            let replaced = text.matches(old.as_str()).count().min(count);
            work.take(sized(text.len() + replaced * new.len())? / 64)?;
            Some(Value::Text(text.replacen(old.as_str(), new, replaced)))
        }
        ("join", [parts]) => Some(join(text, parts, work)?),
        ("zfill", [width]) => {
            let Some(width) = width.small_integer() else { return Ok(None) };
            let missing = sized(usize::try_from(width).unwrap_or(0))?.saturating_sub(text.chars().count());
            let sign = usize::from(text.starts_with(['+', '-']));
            Some(Value::Text(format!("{}{}{}", &text[..sign], "0".repeat(missing), &text[sign..])))
        }
        ("ljust" | "rjust" | "center", [width, fill @ ..]) if fill.len() <= 1 => {
            justify(text, name, width, fill)?
        }
        ("partition" | "rpartition", [Value::Text(by)]) if !by.is_empty() => {
            let parts = if name == "partition" {
                text.split_once(by.as_str())
            } else {
                text.rsplit_once(by.as_str())
            };
            let parts = match parts {
                Some((before, behind)) => [before, by, behind],
                None if name == "partition" => [text, "", ""],
                None => ["", "", text],
            };
            Some(Value::tuple(parts.map(Value::text).to_vec()))
        }
        _ => None,
    })
}

fn join(between: &str, parts: &Value, work: &Work) -> Result<Value, Fault> {
    let mut joined = String::new();
    for (at, part) in items(parts, work)?.iter().enumerate() {
        let Value::Text(part) = part else {
            return Err(Fault::new(
                format!("join: '{}' is {}, not a text", part.shown(), part.kind()),
                "write str(…) around the items, as in ' '.join(map(str, items))",
            ));
        };
        joined.push_str(if at > 0 { between } else { "" });
        joined.push_str(part);
        sized(joined.len())?;
    }
    checked(Value::Text(joined), work)
}

fn titlecase(first: &str) -> String {
    // Only the first letter of the upper-case form stays in upper case: 'ß' becomes 'Ss'.
    let upper = first.to_uppercase();
    let mut characters = upper.chars();
    let begin = characters.next().map(String::from).unwrap_or_default();
    begin + &characters.as_str().to_lowercase()
}

fn title(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut is_inside = false;
    for c in text.chars() {
        if is_inside {
            out.extend(c.to_lowercase());
        } else {
            out.push_str(&titlecase(&c.to_string()));
        }
        is_inside = c.is_lowercase() || c.is_uppercase();
    }
    out
}

fn strip(text: &str, name: &str, belongs: &dyn Fn(char) -> bool) -> Value {
    Value::text(match name {
        "lstrip" => text.trim_start_matches(belongs),
        "rstrip" => text.trim_end_matches(belongs),
        _ => text.trim_matches(belongs),
    })
}

fn justify(text: &str, name: &str, width: &Value, fill: &[Value]) -> Result<Option<Value>, Fault> {
    let Some(width) = width.small_integer() else { return Ok(None) };
    let fill = match fill {
        [] => ' ',
        [Value::Text(fill)] if fill.chars().count() == 1 => fill.chars().next().unwrap_or(' '),
        _ => return Ok(None),
    };
    let width = usize::try_from(width).unwrap_or(0);
    sized(width.saturating_mul(fill.len_utf8()))?;
    let missing = width.saturating_sub(text.chars().count());
    let left = match name {
        "ljust" => 0,
        "rjust" => missing,
        // Python's rule for an odd number.
        _ => missing / 2 + (missing & width & 1),
    };
    let fill = |count: usize| fill.to_string().repeat(count);
    Ok(Some(Value::Text(format!("{}{text}{}", fill(left), fill(missing - left)))))
}

fn split(text: &str, name: &str, arguments: &Arguments, work: &Work) -> Result<Option<Value>, Fault> {
    let [by, most] = arguments.placed(name, ["sep", "maxsplit"])?;
    let most = match most {
        None => usize::MAX,
        Some(most) => match most.small_integer() {
            Some(most) => usize::try_from(most).unwrap_or(usize::MAX),
            None => return Ok(None),
        },
    };
    let parts: Vec<&str> = match by {
        None | Some(Value::None) if name == "split" => words(text, most),
        None | Some(Value::None) => last_words(text, most),
        Some(Value::Text(by)) if by.is_empty() => return Err(misuse(name, &arguments.positional)),
        Some(Value::Text(by)) if name == "split" => {
            text.splitn(most.saturating_add(1), by.as_str()).collect()
        }
        Some(Value::Text(by)) => {
            let mut parts: Vec<_> = text.rsplitn(most.saturating_add(1), by.as_str()).collect();
            parts.reverse();
            parts
        }
        _ => return Ok(None),
    };
    sized(parts.len() * size_of::<Value>())?;
    checked(Value::list(parts.into_iter().map(Value::text).collect()), work).map(Some)
}

fn words(text: &str, most: usize) -> Vec<&str> {
    let mut parts = Vec::new();
    let mut rest = text.trim_start_matches(is_space);
    while !rest.is_empty() {
        let end = if parts.len() < most { rest.find(is_space).unwrap_or(rest.len()) } else { rest.len() };
        parts.push(&rest[..end]);
        rest = rest[end..].trim_start_matches(is_space);
    }
    parts
}

fn last_words(text: &str, most: usize) -> Vec<&str> {
    let mut parts = Vec::new();
    let mut rest = text.trim_end_matches(is_space);
    while !rest.is_empty() {
        let found = rest.char_indices().rev().find(|(_, c)| is_space(*c));
        let begin = match found {
            Some((at, c)) if parts.len() < most => at + c.len_utf8(),
            _ => 0,
        };
        parts.push(&rest[begin..]);
        rest = rest[..begin].trim_end_matches(is_space);
    }
    parts.reverse();
    parts
}

fn lines(text: &str, keep: bool) -> Vec<&str> {
    let ends = |c: char| "\n\r\u{b}\u{c}\u{1c}\u{1d}\u{1e}\u{85}\u{2028}\u{2029}".contains(c);
    let mut lines = Vec::new();
    let mut rest = text;
    while let Some(at) = rest.find(ends) {
        let width = if rest[at..].starts_with("\r\n") {
            2
        } else {
            rest[at..].chars().next().map_or(1, char::len_utf8)
        };
        lines.push(&rest[..if keep { at + width } else { at }]);
        rest = &rest[at + width..];
    }
    if !rest.is_empty() {
        lines.push(rest);
    }
    lines
}

fn expand_tabs(text: &str, width: usize, work: &Work) -> Result<String, Fault> {
    let tabs = text.matches('\t').count();
    work.take(sized(text.len().saturating_add(tabs.saturating_mul(width)))? / 64)?;
    let mut out = String::new();
    let mut column = 0;
    for c in text.chars() {
        match c {
            '\t' => {
                let missing = if width > 0 { width - column % width } else { 0 };
                out.push_str(&" ".repeat(missing));
                column += missing;
            }
            c => {
                column = if matches!(c, '\n' | '\r') { 0 } else { column + 1 };
                out.push(c);
            }
        }
    }
    Ok(out)
}
