//! YAML files as values, for `xacro.load_yaml`.

use super::evaluate::{Names, evaluate};
use super::expression::parse;
use super::fault::Fault;
use super::limits::sized;
use super::value::Value;
use saphyr_parser::{Event, Parser, ScalarStyle, Tag};
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::path::Path;

/// Lists and mappings within one another.
const MAX_DEPTH: usize = 60;

/// Reads a file, its first document.
pub(super) fn load(path: &Path) -> Result<Value, Fault> {
    let text = std::fs::read_to_string(path).map_err(|error| {
        Fault::new(format!("the YAML file {} cannot be read: {error}", path.display()), "correct its name")
    })?;
    document(&text)
        .map_err(|fault| Fault { what: format!("the YAML file {}: {}", path.display(), fault.what), ..fault })
}

/// A list or mapping that is not at its end.
struct Open {
    anchor: usize,
    is_mapping: bool,
    values: Vec<Value>,
}

fn document(text: &str) -> Result<Value, Fault> {
    let bad = |what: String| Fault::new(what, "correct it there");
    let mut open: Vec<Open> = Vec::new();
    let mut anchors: HashMap<usize, Value> = HashMap::new();
    let mut size = 0;
    for event in Parser::new_from_str(text) {
        let (event, _) = event.map_err(|error| bad(error.to_string()))?;
        let (value, anchor) = match event {
            Event::Scalar(text, style, anchor, tag) => {
                (scalar(&text, style == ScalarStyle::Plain, tag.as_deref())?, anchor)
            }
            Event::Alias(anchor) => {
                let value = anchors.get(&anchor).cloned();
                (value.ok_or_else(|| bad("an alias stands within its own anchor".into()))?, 0)
            }
            Event::SequenceStart(anchor, _) | Event::MappingStart(anchor, _) => {
                if open.len() >= MAX_DEPTH {
                    return Err(bad(format!("it is nested more than {MAX_DEPTH} deep")));
                }
                let is_mapping = matches!(event, Event::MappingStart(..));
                open.push(Open { anchor, is_mapping, values: Vec::new() });
                continue;
            }
            Event::SequenceEnd | Event::MappingEnd => {
                let Some(Open { anchor, is_mapping, values }) = open.pop() else { continue };
                (if is_mapping { mapping(values) } else { Value::List(values) }, anchor)
            }
            Event::DocumentEnd => break,
            _ => continue,
        };
        size = sized(size + value.size())?;
        if anchor != 0 {
            anchors.insert(anchor, value.clone());
        }
        match open.last_mut() {
            Some(parent) => parent.values.push(value),
            None => return Ok(value),
        }
    }
    Ok(Value::None)
}

/// Keys and values in turn. `<<` takes in what another mapping has.
fn mapping(values: Vec<Value>) -> Value {
    let mut entries: Vec<(Value, Value)> = Vec::with_capacity(values.len() / 2);
    // Of a key that is written twice the last value counts, as for Python's reader.
    let mut places: HashMap<String, usize> = HashMap::new();
    let mut merged = Vec::new();
    let mut values = values.into_iter();
    while let (Some(key), Some(value)) = (values.next(), values.next()) {
        match (&key, value) {
            (Value::Text(text), Value::Map(more)) if text == "<<" => merged.extend(more),
            (Value::Text(text), value) => match places.entry(text.clone()) {
                Entry::Occupied(place) => entries[*place.get()].1 = value,
                Entry::Vacant(place) => {
                    place.insert(entries.len());
                    entries.push((key, value));
                }
            },
            (_, value) => entries.push((key, value)),
        }
    }
    for (key, value) in merged {
        if !entries.iter().any(|(known, _)| known.equals(&key)) {
            entries.push((key, value));
        }
    }
    Value::Map(entries)
}

/// A plain word by YAML 1.1's rules, which Python's reader has; angles by their unit, in radians.
fn scalar(text: &str, is_plain: bool, tag: Option<&Tag>) -> Result<Value, Fault> {
    match tag.map(|tag| tag.suffix.as_str()) {
        Some("radians") => return number(text).map(Value::Float),
        Some("degrees") => return number(text).map(|degrees| Value::Float(degrees.to_radians())),
        Some("str") => return Ok(Value::Text(text.to_owned())),
        _ => {}
    }
    if !is_plain {
        return Ok(Value::Text(text.to_owned()));
    }
    Ok(match text {
        "" | "~" | "null" | "Null" | "NULL" => Value::None,
        "true" | "True" | "TRUE" | "yes" | "Yes" | "YES" | "on" | "On" | "ON" => Value::Bool(true),
        "false" | "False" | "FALSE" | "no" | "No" | "NO" | "off" | "Off" | "OFF" => Value::Bool(false),
        ".inf" | ".Inf" | "+.inf" => Value::Float(f64::INFINITY),
        "-.inf" | "-.Inf" => Value::Float(f64::NEG_INFINITY),
        ".nan" | ".NaN" => Value::Float(f64::NAN),
        _ if text.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '-' | '+' | '.')) => {
            Value::literal(text)
        }
        _ => Value::Text(text.to_owned()),
    })
}

/// The number that an expression gives.
fn number(text: &str) -> Result<f64, Fault> {
    struct Nothing;
    impl Names for Nothing {
        fn get(&mut self, _: &str) -> Result<Option<Value>, Fault> {
            Ok(None)
        }
        fn call(&mut self, _: &str, _: &[Value]) -> Option<Result<Value, Fault>> {
            None
        }
        fn undefined(&self, name: &str) -> Fault {
            Fault::new(format!("'{name}' is no number"), "write a number, or an expression of numbers")
        }
    }
    let value = evaluate(&parse(text)?, &mut Nothing)?;
    value.number().ok_or_else(|| Nothing.undefined(text))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_have_pythons_types() {
        let text = "a: 1\nb: [1.5, true, no, ~, 'x', \"2\", word]\nc: &c {d: !degrees 180.0, e: !radians pi / 2}\n\
            f: *c\ng: {<<: *c, d: 0}\n";
        let value = document(text).unwrap();
        // As Python prints it.
        let printed = "{'a': 1, 'b': [1.5, True, False, None, 'x', '2', 'word'], 'c': {'d': pi, 'e': pi/2}, \
            'f': {'d': pi, 'e': pi/2}, 'g': {'d': 0, 'e': pi/2}}";
        let printed = printed.replace("pi/2", "1.5707963267948966").replace("pi", "3.141592653589793");
        assert_eq!(value.to_string(), printed);
        assert!(document("a: [1").is_err() && document(&"[".repeat(99)).is_err());
        let laughs: Vec<_> = (1..30).map(|i| format!("a{i}: &a{i} [*a{0}, *a{0}]\n", i - 1)).collect();
        let laughs = laughs.concat();
        assert!(document(&format!("a0: &a0 ha\n{laughs}")).unwrap_err().what.contains("grows beyond"));
    }
}
