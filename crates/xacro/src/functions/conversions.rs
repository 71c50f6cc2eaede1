//! Functions that convert a value to another type.

use super::items::{checked, items, items_in_any_order, key, printed};
use super::{Arguments, rounding};
use crate::fault::Fault;
use crate::limits::{Work, bits, sized};
use crate::value::{Entries, Range, Value, int_text, integer_of, parse_float, parse_int};
use num_bigint::BigInt;
use num_traits::{Signed, Zero};
use std::cell::RefCell;
use std::rc::Rc;

/// Calls a function; `None` for another function or if it does not accept its arguments.
pub(super) fn call(name: &str, arguments: &Arguments, work: &Work) -> Result<Option<Value>, Fault> {
    match name {
        "dict" => return dictionary(arguments, work).map(Some),
        "int" => return integer(arguments),
        "round" => {
            let [number, digits] = arguments.placed(name, ["number", "ndigits"])?;
            let rounded = match (number, digits) {
                (Some(number), None | Some(Value::None)) => rounding::to_integer(number),
                (Some(number), Some(digits)) => {
                    digits.small_integer().and_then(|digits| rounding::to_digits(number, digits))
                }
                _ => None,
            };
            return rounded.transpose();
        }
        _ => {}
    }
    let positional = arguments.positional.as_slice();
    let unnamed = || arguments.unnamed(name);
    Ok(Some(match (name, positional) {
        ("float", []) => Value::Float(0.0),
        ("float", [value]) => {
            unnamed()?;
            let number = match value {
                Value::Text(text) => parse_float(text),
                other => other.number().filter(|float| float.is_finite() || matches!(other, Value::Float(_))),
            };
            let Some(number) = number else { return Ok(None) };
            Value::Float(number)
        }
        ("str", []) if arguments.named.is_empty() => Value::text(""),
        ("str", [value]) => {
            unnamed()?;
            Value::Text(printed(value)?)
        }
        ("repr", [value]) => {
            unnamed()?;
            Value::Text(if let Value::Text(_) = value { value.repr() } else { printed(value)? })
        }
        ("bool", []) => Value::Bool(false),
        ("bool", [value]) => {
            unnamed()?;
            Value::Bool(value.truth())
        }
        ("list", []) => Value::list(Vec::new()),
        ("list", [value]) => {
            unnamed()?;
            checked(Value::list(items(value, work)?), work)?
        }
        ("tuple", []) => Value::tuple(Vec::new()),
        ("tuple", [value]) => {
            unnamed()?;
            checked(Value::tuple(items(value, work)?), work)?
        }
        ("set", []) => set(Vec::new())?,
        ("set", [value]) => {
            unnamed()?;
            checked(set(items_in_any_order(value, work)?)?, work)?
        }
        ("range", bounds) => {
            unnamed()?;
            let Some(bounds) = bounds.iter().map(Value::integer).collect::<Option<Vec<_>>>() else {
                return Ok(None);
            };
            let (start, end, step) = match &bounds[..] {
                [end] => (BigInt::zero(), end.clone(), 1.into()),
                [start, end] => (start.clone(), end.clone(), 1.into()),
                [start, end, step] if !step.is_zero() => (start.clone(), end.clone(), step.clone()),
                _ => return Ok(None),
            };
            Value::Range(Rc::new(Range { start, end, step }))
        }
        ("hex" | "oct" | "bin", [value]) => {
            unnamed()?;
            let Some(int) = value.integer() else { return Ok(None) };
            let (radix, prefix) = match name {
                "hex" => (16, "0x"),
                "oct" => (8, "0o"),
                _ => (2, "0b"),
            };
            let sign = if int.is_negative() { "-" } else { "" };
            Value::Text(format!("{sign}{prefix}{}", int_text(&int.abs(), radix)))
        }
        ("chr", [value]) => {
            unnamed()?;
            let character = value.small_integer().and_then(|int| char::from_u32(u32::try_from(int).ok()?));
            let Some(character) = character else { return Ok(None) };
            Value::text(character)
        }
        ("ord", [Value::Text(text)]) => {
            unnamed()?;
            let mut characters = text.chars();
            let (Some(character), None) = (characters.next(), characters.next()) else { return Ok(None) };
            Value::int(u32::from(character))
        }
        _ => return Ok(None),
    }))
}

/// Creates a set.
pub(crate) fn set(items: Vec<Value>) -> Result<Value, Fault> {
    let mut entries = Entries::default();
    for item in items {
        let key = key(&item)?;
        // Of equal items, the first is kept.
        if !entries.contains(&key) {
            entries.insert(key, item, Value::None);
        }
    }
    Ok(Value::Set(Rc::new(RefCell::new(entries))))
}

fn integer(arguments: &Arguments) -> Result<Option<Value>, Fault> {
    let [value, base] = arguments.placed("int", ["x", "base"])?;
    let int = match (value, base) {
        (None, None) => Some(BigInt::zero()),
        (Some(Value::Text(text)), None) => parse_int(text, 10),
        (Some(Value::Text(text)), Some(base)) => match base.small_integer() {
            Some(base @ (0 | 2..=36)) => parse_int(text, base as u32),
            _ => None,
        },
        (Some(Value::Float(float)), None) => integer_of(*float),
        (Some(value), None) => value.integer(),
        _ => None,
    };
    if let Some(int) = &int {
        bits(int.bits())?;
    }
    Ok(int.map(Value::Int))
}

fn dictionary(arguments: &Arguments, work: &Work) -> Result<Value, Fault> {
    let mut entries = Entries::default();
    match &arguments.positional[..] {
        [] => {}
        [source] => extend(&mut entries, source, work)?,
        more => return Err(super::misuse("dict", more)),
    }
    for (name, value) in &arguments.named {
        let name = Value::text(name.as_str());
        entries.insert(key(&name)?, name, value.clone());
    }
    checked(Value::map(entries), work)
}

/// Adds the entries of a dictionary, or of pairs, to another dictionary.
pub(super) fn extend(entries: &mut Entries, source: &Value, work: &Work) -> Result<(), Fault> {
    if let Value::Map(map) = source {
        let map = map.entries.borrow();
        work.take(map.len())?;
        for (name, value) in map.iter() {
            entries.insert(key(name)?, name.clone(), value.clone());
        }
        return Ok(());
    }
    for pair in items(source, work)? {
        match &items(&pair, work)?[..] {
            [name, value] => entries.insert(key(name)?, name.clone(), value.clone()),
            _ => {
                return Err(Fault::new(
                    format!("'{}' is not a pair of a key and a value", pair.shown()),
                    "write dict(name=value), or a list of pairs",
                ));
            }
        }
    }
    sized(entries.len() * size_of::<Value>()).map(|_| ())
}
