//! Methods of lists and other sequences.

use super::items::{checked, items};
use super::{Arguments, misuse};
use crate::fault::Fault;
use crate::limits::{Work, sized};
use crate::value::{List, Value, same};
use num_traits::ToPrimitive;
use std::rc::Rc;

pub(super) const NAMES: [&str; 11] =
    ["append", "clear", "copy", "count", "extend", "index", "insert", "pop", "remove", "reverse", "sort"];

/// Calls a method of a list, which may change the list. `sort` is implemented by the evaluator, because it takes a
/// function.
pub(super) fn method(
    list: &Rc<List>,
    name: &str,
    arguments: &Arguments,
    work: &Work,
) -> Result<Option<Value>, Fault> {
    let positional = arguments.unnamed(name)?;
    let length = list.items.borrow().len();
    work.take(1)?;
    match (name, positional) {
        ("append", [item]) => {
            add(list, length, vec![item.clone()], work)?;
        }
        ("extend", [more]) => {
            let more = items(more, work)?;
            add(list, length, more, work)?;
        }
        ("insert", [at, item]) => {
            let Some(at) = at.integer() else { return Ok(None) };
            let at = at.to_i64().unwrap_or(i64::MAX);
            let at = if at < 0 { at.saturating_add(length as i64).max(0) } else { at.min(length as i64) };
            add(list, at as usize, vec![item.clone()], work)?;
        }
        ("pop", [] | [_]) => {
            let at = match positional {
                [] => -1,
                [at, ..] => match at.small_integer() {
                    Some(at) => at,
                    None => return Ok(None),
                },
            };
            let place = usize::try_from(if at < 0 { at.saturating_add(length as i64) } else { at });
            let Some(place) = place.ok().filter(|place| *place < length) else {
                return Err(Fault::new(
                    format!("pop({at}): the list has {length} items"),
                    "check its length before",
                ));
            };
            work.take((length - place) / 64)?;
            return Ok(Some(list.items.borrow_mut().remove(place)));
        }
        ("remove", [item]) => {
            let place = list.items.borrow().iter().position(|other| same(other, item));
            let Some(place) = place else { return Err(misuse("remove", positional)) };
            list.items.borrow_mut().remove(place);
        }
        ("reverse", []) => list.items.borrow_mut().reverse(),
        ("clear", []) => list.items.borrow_mut().clear(),
        ("copy", []) => return checked(Value::list(list.items.borrow().clone()), work).map(Some),
        _ => return sequence(&list.items.borrow(), name, arguments),
    }
    Ok(Some(Value::None))
}

/// Adds items to a list, unless it would contain itself or become too large.
fn add(list: &Rc<List>, place: usize, new: Vec<Value>, work: &Work) -> Result<(), Fault> {
    let count = new.len();
    for item in &new {
        accept(item)?;
        work.take(sized(item.size())? / 64)?;
    }
    sized((list.items.borrow().len() + count) * size_of::<Value>())?;
    let holds_others =
        new.iter().any(|item| matches!(item, Value::List(_) | Value::Tuple(_) | Value::Map(_)));
    list.items.borrow_mut().splice(place..place, new);
    if holds_others {
        let size = Value::List(list.clone()).size();
        if let Err(fault) = sized(size) {
            list.items.borrow_mut().drain(place..place + count);
            return Err(fault);
        }
        work.take(size / 64)?;
    }
    Ok(())
}

/// Checks that a value may be stored in an existing list or dictionary.
pub(super) fn accept(value: &Value) -> Result<(), Fault> {
    match value {
        Value::Function(_) | Value::Iterator(_) | Value::View(..) => Err(Fault::new(
            format!("{} cannot be put into an existing list or dictionary", value.kind()),
            "convert it to a list with list(…)",
        )),
        _ => Ok(()),
    }
}

/// Calls a method that all sequences have.
pub(super) fn sequence(items: &[Value], name: &str, arguments: &Arguments) -> Result<Option<Value>, Fault> {
    let positional = arguments.unnamed(name)?;
    Ok(match (name, positional) {
        ("count", [item]) => Some(Value::int(items.iter().filter(|other| same(other, item)).count())),
        ("index", [item, bounds @ ..]) if bounds.len() <= 2 => {
            let bound = |at: usize, default: usize| match bounds.get(at) {
                None => Some(default),
                Some(bound) => {
                    let bound = bound.small_integer()?;
                    let bound =
                        if bound < 0 { bound.saturating_add(items.len() as i64).max(0) } else { bound };
                    Some((bound as usize).min(items.len()))
                }
            };
            let (Some(start), Some(end)) = (bound(0, 0), bound(1, items.len())) else { return Ok(None) };
            let found = (start..end.max(start)).find(|at| same(&items[*at], item));
            Some(Value::int(found.ok_or_else(|| misuse("index", positional))?))
        }
        _ => None,
    })
}
