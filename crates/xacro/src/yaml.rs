//! YAML files as values, for `xacro.load_yaml`: YAML 1.1 as read by the `SafeLoader` of `PyYAML`, with xacro's units.

mod scalars;

use super::encoding::{NotRead, utf_8};
use super::evaluate::{Names, evaluate};
use super::expression::parse;
use super::fault::Fault;
use super::file;
use super::functions::{Arguments, key};
use super::limits::{Work, sized};
use super::value::{Entries, Value, parse_float};
use saphyr_parser::{Event, Parser, ScalarStyle, Tag};
use scalars::{by_tag, plain};
use std::collections::HashMap;
use std::path::Path;

/// The greatest nesting of lists and mappings.
const MAX_DEPTH: usize = 60;

/// The tags of xacro's units, with their values in metres or radians.
const UNITS: [(&str, f64); 7] = [
    ("radians", 1.0),
    ("degrees", std::f64::consts::PI / 180.0),
    ("meters", 1.0),
    ("millimeters", 0.001),
    ("foot", 0.3048),
    ("feet", 0.3048),
    ("inches", 0.0254),
];

/// Reads a file.
pub(super) fn load(path: &Path) -> Result<Value, Fault> {
    let fail = |what: String, remedy: String| {
        Fault::new(format!("the YAML file {} cannot be read: {what}", path.display()), remedy)
    };
    let bytes = file::read(path).map_err(|error| fail(error.to_string(), "correct its name".into()))?;
    let text = utf_8(bytes, path).map_err(|NotRead { what, remedy }| fail(what, remedy))?;
    document(&text)
        .map(Value::dotted)
        .map_err(|fault| Fault { what: format!("the YAML file {}: {}", path.display(), fault.what), ..fault })
}

fn bad(what: impl Into<String>) -> Fault {
    Fault::new(what, "correct it there")
}

/// A list or mapping that has not ended.
struct Open {
    anchor: usize,
    is_mapping: bool,
    values: Vec<Value>,
    /// The indices of the values that are the key `<<`.
    merges: Vec<usize>,
}

fn document(text: &str) -> Result<Value, Fault> {
    let mut open: Vec<Open> = Vec::new();
    let mut anchors: HashMap<usize, Value> = HashMap::new();
    let mut size = 0;
    let mut root = None;
    for event in Parser::new_from_str(text) {
        let (event, span) = event.map_err(|error| bad(error.to_string()))?;
        let at_line =
            |fault: Fault| Fault { what: format!("line {}: {}", span.start.line(), fault.what), ..fault };
        let mut is_merge = false;
        let (value, anchor) = match event {
            Event::DocumentStart(_) if root.is_some() => return Err(bad("it has more than one document")),
            Event::Scalar(text, style, anchor, tag) => {
                let is_plain = style == ScalarStyle::Plain;
                is_merge = is_plain && text == "<<" && tag.is_none();
                (scalar(&text, is_plain, tag.as_deref()).map_err(at_line)?, anchor)
            }
            Event::Alias(anchor) => {
                let value = anchors.get(&anchor).cloned();
                (value.ok_or_else(|| bad("an alias stands within its own anchor"))?, 0)
            }
            Event::SequenceStart(anchor, ref tag) | Event::MappingStart(anchor, ref tag) => {
                if open.len() >= MAX_DEPTH {
                    return Err(bad(format!("it is nested more than {MAX_DEPTH} deep")));
                }
                let is_mapping = matches!(event, Event::MappingStart(..));
                let own = if is_mapping { "map" } else { "seq" };
                if let Some(tag) =
                    tag.as_deref().filter(|tag| !(tag.is_yaml_core_schema() && tag.suffix == own))
                {
                    return Err(at_line(unknown_tag(tag)));
                }
                open.push(Open { anchor, is_mapping, values: Vec::new(), merges: Vec::new() });
                continue;
            }
            Event::SequenceEnd | Event::MappingEnd => {
                let Some(ended) = open.pop() else { continue };
                let anchor = ended.anchor;
                let value = if ended.is_mapping {
                    mapping(&ended).map_err(at_line)?
                } else {
                    Value::list(ended.values)
                };
                (value, anchor)
            }
            _ => continue,
        };
        size = sized(value.size().saturating_add(size))?;
        if anchor != 0 {
            anchors.insert(anchor, value.clone());
        }
        match open.last_mut() {
            Some(parent) => {
                if is_merge && parent.is_mapping && parent.values.len().is_multiple_of(2) {
                    parent.merges.push(parent.values.len());
                }
                parent.values.push(value);
            }
            None => root = Some(value),
        }
    }
    Ok(root.unwrap_or(Value::None))
}

fn unknown_tag(tag: &Tag) -> Fault {
    let known = UNITS.map(|(unit, _)| format!("!{unit}")).join(", ");
    let name = if tag.is_yaml_core_schema() {
        format!("!!{}", tag.suffix)
    } else {
        format!("{}{}", tag.handle, tag.suffix)
    };
    Fault::new(format!("the tag '{name}' is not known"), format!("use one of {known}, or none"))
}

/// Creates a dictionary from alternating keys and values. `<<` inserts other mappings, before the keys written here.
fn mapping(open: &Open) -> Result<Value, Fault> {
    let mut entries = Entries::default();
    let pairs = || open.values.chunks_exact(2).enumerate();
    let is_merge = |at: usize| open.merges.contains(&(2 * at));
    for (_, pair) in pairs().filter(|(at, _)| is_merge(*at)) {
        let others = match &pair[1] {
            Value::List(list) => list.items.borrow().clone(),
            other => vec![other.clone()],
        };
        for other in others {
            let Value::Map(map) = &other else {
                return Err(bad("'<<' needs a mapping, or a list of mappings"));
            };
            for (name, value) in map.entries.borrow().iter() {
                // Of several merged mappings, the first value of a key counts, as YAML specifies.
                let key = key(name)?;
                if !entries.contains(&key) {
                    entries.insert(key, name.clone(), value.clone());
                }
            }
        }
    }
    for (_, pair) in pairs().filter(|(at, _)| !is_merge(*at)) {
        // If a key is written twice, the last value counts.
        entries.insert(key(&pair[0])?, pair[0].clone(), pair[1].clone());
    }
    Ok(Value::map(entries))
}

fn scalar(text: &str, is_plain: bool, tag: Option<&Tag>) -> Result<Value, Fault> {
    let Some(tag) = tag else {
        return if is_plain { plain(text) } else { Ok(Value::text(text)) };
    };
    if tag.is_yaml_core_schema() {
        return by_tag(text, &tag.suffix).unwrap_or_else(|| Err(unknown_tag(tag)));
    }
    let unit = UNITS.iter().find(|(unit, _)| tag.handle == "!" && tag.suffix == *unit);
    match unit {
        Some((_, factor)) => number(text).map(|number| Value::Float(number * factor)),
        // A single `!` makes it a text.
        None if tag.handle.is_empty() && tag.suffix == "!" => Ok(Value::text(text)),
        None => Err(unknown_tag(tag)),
    }
}

/// Returns the number that an expression gives.
fn number(text: &str) -> Result<f64, Fault> {
    struct Nothing(usize);
    impl Names for Nothing {
        fn get(&mut self, _: &str) -> Result<Option<Value>, Fault> {
            Ok(None)
        }
        fn call(&mut self, _: &str, _: &Arguments) -> Option<Result<Value, Fault>> {
            None
        }
        fn undefined(&self, name: &str) -> Fault {
            Fault::new(format!("'{name}' is not a number"), "write a number, or an expression of numbers")
        }
        fn enter(&mut self, levels: usize) -> Result<(), Fault> {
            self.0 += levels;
            if self.0 > 500 { Err(bad("the expression is nested too deeply")) } else { Ok(()) }
        }
        fn leave(&mut self, levels: usize) {
            self.0 -= levels;
        }
    }
    let value = evaluate(&parse(text)?, &mut Nothing(0), &Work::default())?;
    let number = match &value {
        Value::Text(text) => parse_float(text),
        other => other.number(),
    };
    number.ok_or_else(|| Nothing(0).undefined(text))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_have_pythons_types() {
        let text = "a: 1\nb: [1.5, true, no, ~, 'x', \"2\", word]\nc: &c {d: !degrees 180.0, e: !radians pi / 2}\n\
            f: *c\ng: {<<: *c, d: 0}\n";
        let value = document(text).unwrap();
        // As printed by Python.
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
