//! Numbers and quoted texts at the start of a text.

use super::super::value::{Value, parse_float, parse_int};

/// Returns the number that a text begins with, and its length.
pub(super) fn number(text: &str) -> Result<(Value, usize), String> {
    let length = number_length(text);
    let written = &text[..length];
    let behind = text[length..].chars().next();
    if matches!(behind, Some('j' | 'J')) {
        return Err(format!("'{written}j' is a complex number, which is not supported"));
    }
    let is_float = !written.to_ascii_lowercase().starts_with("0x") && written.contains(['.', 'e', 'E']);
    let value =
        if is_float { parse_float(written).map(Value::Float) } else { parse_int(written, 0).map(Value::Int) };
    let begins_name = behind.is_some_and(|c| c == '_' || c.is_ascii_digit());
    match value {
        Some(value) if !begins_name => Ok((value, length)),
        _ if written.starts_with('0')
            && !is_float
            && !written.contains(|c: char| c.is_ascii_alphabetic()) =>
        {
            Err(format!("'{written}' is not a number: it has a leading zero"))
        }
        _ => Err(format!("'{written}' is not a number")),
    }
}

fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    if bytes[0] == b'0' && matches!(bytes.get(1), Some(b'x' | b'X' | b'o' | b'O' | b'b' | b'B')) {
        let is_hex = matches!(bytes[1], b'x' | b'X');
        let belongs =
            |byte: &u8| *byte == b'_' || byte.is_ascii_digit() || (is_hex && byte.is_ascii_hexdigit());
        return 2 + bytes[2..].iter().take_while(|byte| belongs(byte)).count();
    }
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

/// Returns the value of the quoted text, with its prefix, with which a text begins, and the length of both; `None` if
/// it begins with something else.
pub(super) fn string(text: &str) -> Option<Result<(String, usize), String>> {
    let at = text.bytes().take(3).position(|byte| matches!(byte, b'\'' | b'"'))?;
    let prefix = text[..at].to_ascii_lowercase();
    match prefix.as_str() {
        "" | "u" | "r" => {}
        "f" | "fr" | "rf" => {
            return Some(Err("f-strings are not supported: use '…'.format(…) or '…' % …".into()));
        }
        "b" | "br" | "rb" => return Some(Err("bytes are not supported".into())),
        _ => return None,
    }
    let quoted = &text[at..];
    let quote =
        if quoted.starts_with("'''") || quoted.starts_with("\"\"\"") { &quoted[..3] } else { &quoted[..1] };
    Some(
        inside(&quoted[quote.len()..], quote, prefix == "r")
            .map(|(value, length)| (value, at + quote.len() + length)),
    )
}

/// Returns the value of a text up to its closing quote, and the length with that quote.
fn inside(text: &str, quote: &str, is_raw: bool) -> Result<(String, usize), String> {
    let open = || "a quoted text does not end".to_owned();
    let mut value = String::new();
    let mut at = 0;
    loop {
        let rest = &text[at..];
        let c = rest.chars().next().ok_or_else(open)?;
        if rest.starts_with(quote) {
            return Ok((value, at + quote.len()));
        }
        if c == '\n' && quote.len() == 1 {
            return Err(open());
        }
        if c != '\\' {
            value.push(c);
            at += c.len_utf8();
        } else if is_raw {
            let next = rest[1..].chars().next().ok_or_else(open)?;
            value.extend([c, next]);
            at += 1 + next.len_utf8();
        } else {
            at += 1 + escape(&rest[1..], &mut value)?;
        }
    }
}

/// Adds the character for the escape sequence after a backslash, and returns the length of the sequence.
fn escape(text: &str, value: &mut String) -> Result<usize, String> {
    let c = text.chars().next().ok_or("a quoted text does not end")?;
    let simple = match c {
        '\n' => return Ok(1),
        'n' => '\n',
        't' => '\t',
        'r' => '\r',
        'a' => '\u{7}',
        'b' => '\u{8}',
        'f' => '\u{c}',
        'v' => '\u{b}',
        '\\' | '\'' | '"' => c,
        'x' => return numbered(text, 1, 2, 16, value),
        'u' => return numbered(text, 1, 4, 16, value),
        'U' => return numbered(text, 1, 8, 16, value),
        'N' => return Err("'\\N' is not supported: write the character, or '\\u' and its number".into()),
        '0'..='7' => {
            let digits = text.bytes().take(3).take_while(|byte| (b'0'..=b'7').contains(byte)).count();
            return numbered(text, 0, digits, 8, value);
        }
        other => {
            value.extend(['\\', other]);
            return Ok(other.len_utf8());
        }
    };
    value.push(simple);
    Ok(1)
}

fn numbered(
    text: &str,
    begin: usize,
    digits: usize,
    radix: u32,
    value: &mut String,
) -> Result<usize, String> {
    let written = text.get(begin..begin + digits).filter(|digits| digits.chars().all(|c| c.is_digit(radix)));
    let character = written.and_then(|digits| char::from_u32(u32::from_str_radix(digits, radix).ok()?));
    value.push(character.ok_or_else(|| {
        let shown: String = text.chars().take(begin + digits).collect();
        format!("'\\{shown}' is not a character")
    })?);
    Ok(begin + digits)
}
