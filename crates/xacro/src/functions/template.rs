//! `'…'.format(values)`: fields in braces.

use super::Arguments;
use super::format::Spec;
use super::items::{key, printed};
use crate::fault::Fault;
use crate::limits::{Work, sized};
use crate::value::Value;

fn bad(template: &str, what: &str) -> Fault {
    let shown = Value::text(template).shown();
    Fault::new(
        format!("'{shown}'.format(…): {what}"),
        "write '{}', '{0:.2f}' or '{name}', and {{ for a plain brace",
    )
}

/// Whether fields without or with a number have occurred so far.
#[derive(Default)]
struct Numbering {
    next: usize,
    is_automatic: bool,
    is_manual: bool,
}

/// Fills the fields of a template with arguments.
pub(super) fn format(template: &str, arguments: &Arguments, work: &Work) -> Result<String, Fault> {
    fill(template, template, arguments, &mut Numbering::default(), 2, work)
}

fn fill(
    template: &str,
    text: &str,
    arguments: &Arguments,
    numbering: &mut Numbering,
    depth: u32,
    work: &Work,
) -> Result<String, Fault> {
    if depth == 0 && text.contains('{') {
        return Err(bad(template, "fields are nested too deeply"));
    }
    let mut out = String::new();
    let mut rest = text;
    while let Some(at) = rest.find(['{', '}']) {
        out.push_str(&rest[..at]);
        let (brace, behind) = rest[at..].split_at(1);
        if behind.starts_with(brace) {
            out.push_str(brace);
            rest = &behind[1..];
            continue;
        }
        if brace == "}" {
            return Err(bad(template, "a '}' stands alone"));
        }
        let end = end_of_field(behind).ok_or_else(|| bad(template, "a '{' is not closed"))?;
        out.push_str(&field(template, &behind[..end], arguments, numbering, depth, work)?);
        work.take(1 + sized(out.len())? / 64)?;
        rest = &behind[end + 1..];
    }
    out.push_str(rest);
    Ok(out)
}

fn end_of_field(text: &str) -> Option<usize> {
    let mut depth = 0_usize;
    for (at, c) in text.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => return Some(at),
            '}' => depth -= 1,
            _ => {}
        }
    }
    None
}

fn field(
    template: &str,
    field: &str,
    arguments: &Arguments,
    numbering: &mut Numbering,
    depth: u32,
    work: &Work,
) -> Result<String, Fault> {
    // A colon or '!' inside an index belongs to the index.
    let mut in_index = false;
    let end = field.find(|c| {
        in_index = (in_index || c == '[') && c != ']';
        !in_index && (c == ':' || c == '!')
    });
    let (name, rest) = field.split_at(end.unwrap_or(field.len()));
    let (conversion, spec) = match rest.strip_prefix('!') {
        None => (None, rest.strip_prefix(':').unwrap_or("")),
        Some(rest) => {
            let letter = rest.chars().next().ok_or_else(|| bad(template, "a letter is missing after '!'"))?;
            let behind = &rest[letter.len_utf8()..];
            let spec = if behind.is_empty() { Some("") } else { behind.strip_prefix(':') };
            (Some(letter), spec.ok_or_else(|| bad(template, "':' is missing after the conversion"))?)
        }
    };
    let value = look_up(template, name, arguments, numbering)?;
    let value = match conversion {
        None => value,
        Some('s') => Value::Text(printed(&value)?),
        Some('r') => Value::Text(if let Value::Text(_) = value { value.repr() } else { printed(&value)? }),
        Some(letter) => return Err(bad(template, &format!("'!{letter}' has no meaning"))),
    };
    let spec = fill(template, spec, arguments, numbering, depth - 1, work)?;
    if spec.is_empty() {
        return printed(&value);
    }
    parse(&spec).ok_or_else(|| bad(template, &format!("'{spec}' is not a format")))?.write(&value)
}

/// Returns the value of a field such as `0`, `name`, `0[key]`, or an empty one.
fn look_up(
    template: &str,
    name: &str,
    arguments: &Arguments,
    numbering: &mut Numbering,
) -> Result<Value, Fault> {
    let end = name.find(['.', '[']).unwrap_or(name.len());
    let (first, mut rest) = name.split_at(end);
    let missing = || bad(template, &format!("there is no value for '{{{name}}}'"));
    let mut value = if first.is_empty() || first.bytes().all(|byte| byte.is_ascii_digit()) {
        let place = if first.is_empty() {
            numbering.is_automatic = true;
            numbering.next += 1;
            numbering.next - 1
        } else {
            numbering.is_manual = true;
            first.parse().map_err(|_| missing())?
        };
        if numbering.is_automatic && numbering.is_manual {
            return Err(bad(template, "fields with and without a number are mixed"));
        }
        arguments.positional.get(place).ok_or_else(missing)?.clone()
    } else {
        let named = arguments.named.iter().find(|(known, _)| known == first);
        named.ok_or_else(missing)?.1.clone()
    };
    while !rest.is_empty() {
        if let Some(behind) = rest.strip_prefix('[') {
            let (index, behind) = behind.split_once(']').ok_or_else(missing)?;
            let number = index.parse::<usize>().ok();
            value = match (&value, number) {
                (Value::List(list), Some(at)) => list.items.borrow().get(at).cloned(),
                (Value::Tuple(tuple), Some(at)) => tuple.items.get(at).cloned(),
                (Value::Text(text), Some(at)) => text.chars().nth(at).map(Value::text),
                (Value::Map(map), _) => {
                    let name = number.map_or_else(|| Value::text(index), Value::int);
                    map.entries.borrow().get(&key(&name)?).cloned()
                }
                _ => None,
            }
            .ok_or_else(missing)?;
            rest = behind;
        } else {
            let behind = rest.strip_prefix('.').ok_or_else(missing)?;
            let end = behind.find(['.', '[']).unwrap_or(behind.len());
            let found = match &value {
                Value::Map(map) if map.dotted => {
                    map.entries.borrow().get(&key(&Value::text(&behind[..end]))?).cloned()
                }
                _ => None,
            };
            value = found.ok_or_else(missing)?.dotted();
            rest = &behind[end..];
        }
    }
    Ok(value)
}

/// Reads `[[fill]align][sign][#][0][width][grouping][.precision][type]`.
fn parse(text: &str) -> Option<Spec> {
    let mut spec = Spec::default();
    let mut rest: Vec<char> = text.chars().collect();
    let is_align = |c: &char| "<>=^".contains(*c);
    if rest.get(1).is_some_and(is_align) {
        spec.fill = Some(rest[0]);
        spec.align = Some(rest[1]);
        rest.drain(..2);
    } else if rest.first().is_some_and(is_align) {
        spec.align = Some(rest.remove(0));
    }
    let mut rest = rest.into_iter().peekable();
    spec.sign = rest.next_if(|c| "+- ".contains(*c));
    spec.is_alternate = rest.next_if_eq(&'#').is_some();
    if rest.next_if_eq(&'0').is_some() {
        spec.fill = spec.fill.or(Some('0'));
        spec.is_zero = true;
    }
    let number = |rest: &mut std::iter::Peekable<std::vec::IntoIter<char>>| {
        let mut digits = String::new();
        while let Some(digit) = rest.next_if(char::is_ascii_digit) {
            digits.push(digit);
        }
        if digits.is_empty() { None } else { Some(digits.parse().unwrap_or(usize::MAX)) }
    };
    spec.width = number(&mut rest).unwrap_or(0);
    spec.grouping = rest.next_if(|c| ",_".contains(*c));
    if rest.next_if_eq(&'.').is_some() {
        spec.precision = Some(number(&mut rest)?);
    }
    spec.kind = rest.next();
    if rest.next().is_some() { None } else { Some(spec) }
}
