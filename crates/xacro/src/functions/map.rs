//! Methods of dictionaries.

use super::conversions::extend;
use super::items::{checked, key};
use super::list::accept;
use super::{Arguments, misuse};
use crate::fault::Fault;
use crate::limits::{Work, sized};
use crate::value::{Entries, Map, Value, View};
use std::rc::Rc;

pub(super) const NAMES: [&str; 10] =
    ["clear", "copy", "get", "items", "keys", "pop", "popitem", "setdefault", "update", "values"];

/// Calls a method of a dictionary, which may change it.
pub(super) fn method(
    map: &Rc<Map>,
    name: &str,
    arguments: &Arguments,
    work: &Work,
) -> Result<Option<Value>, Fault> {
    work.take(1)?;
    if name == "update" {
        let mut entries = Entries::default();
        match &arguments.positional[..] {
            [] => {}
            [source] => extend(&mut entries, source, work)?,
            more => return Err(misuse(name, more)),
        }
        for (name, value) in &arguments.named {
            let name = Value::text(name.as_str());
            entries.insert(key(&name)?, name, value.clone());
        }
        for (name, value) in entries.iter() {
            set(map, name, value, work)?;
        }
        return Ok(Some(Value::None));
    }
    let positional = arguments.unnamed(name)?;
    Ok(Some(match (name, positional) {
        ("keys", []) => Value::View(View::Keys, map.clone()),
        ("values", []) => Value::View(View::Values, map.clone()),
        ("items", []) => Value::View(View::Items, map.clone()),
        ("get", [name]) => map.entries.borrow().get(&key(name)?).cloned().unwrap_or(Value::None),
        ("get", [name, default]) => {
            map.entries.borrow().get(&key(name)?).cloned().unwrap_or_else(|| default.clone())
        }
        ("setdefault", [name]) => return default(map, name, &Value::None, work).map(Some),
        ("setdefault", [name, value]) => return default(map, name, value, work).map(Some),
        ("pop", [name, rest @ ..]) if rest.len() <= 1 => {
            work.take(map.entries.borrow().len())?;
            let removed = map.entries.borrow_mut().remove(&key(name)?);
            match (removed, rest) {
                (Some((_, value)), _) => value,
                (None, [default, ..]) => default.clone(),
                (None, []) => return Err(misuse("pop", positional)),
            }
        }
        ("popitem", []) => {
            let last = map.entries.borrow().iter().next_back().map(|(name, _)| key(name)).transpose()?;
            let removed = last.and_then(|last| map.entries.borrow_mut().remove(&last));
            let Some((name, value)) = removed else { return Err(misuse("popitem", positional)) };
            Value::tuple(vec![name, value])
        }
        ("copy", []) => checked(Value::map(map.entries.borrow().clone()), work)?,
        ("clear", []) => {
            map.entries.borrow_mut().clear();
            Value::None
        }
        _ => return Ok(None),
    }))
}

fn default(map: &Rc<Map>, name: &Value, value: &Value, work: &Work) -> Result<Value, Fault> {
    let found = map.entries.borrow().get(&key(name)?).cloned();
    match found {
        Some(found) => Ok(found),
        None => set(map, name, value, work).map(|()| value.clone()),
    }
}

/// Sets an entry of an existing dictionary, unless it would contain itself or become too large.
fn set(map: &Rc<Map>, name: &Value, value: &Value, work: &Work) -> Result<(), Fault> {
    accept(value)?;
    let place = key(name)?;
    let before = map.entries.borrow().get(&place).cloned();
    map.entries.borrow_mut().insert(place.clone(), name.clone(), value.clone());
    let size = Value::Map(map.clone()).size();
    if let Err(fault) = sized(size) {
        let mut entries = map.entries.borrow_mut();
        match before {
            Some(before) => entries.insert(place, name.clone(), before),
            None => {
                entries.remove(&place);
            }
        }
        return Err(fault);
    }
    work.take(size / 64)
}
