//! Iteration over values: their items, keys and texts.

use crate::fault::Fault;
use crate::limits::{Work, sized};
use crate::value::{Key, Value, View};
use num_bigint::BigInt;
use num_traits::ToPrimitive;

/// Returns the items of an iterable value. The items of an iterator are removed from it.
pub(crate) fn items(value: &Value, work: &Work) -> Result<Vec<Value>, Fault> {
    let (items, fault) = items_until_fault(value, work)?;
    match fault {
        Some(fault) => Err(fault),
        None => Ok(items),
    }
}

/// Returns the items, and the fault at which an iterator ends.
pub(super) fn items_until_fault(value: &Value, work: &Work) -> Result<(Vec<Value>, Option<Fault>), Fault> {
    let dotted =
        |value: &Value, is_dotted: bool| if is_dotted { value.clone().dotted() } else { value.clone() };
    let items: Vec<Value> = match value {
        Value::List(list) => list.items.borrow().iter().map(|item| dotted(item, list.dotted)).collect(),
        Value::Tuple(tuple) => tuple.items.clone(),
        Value::Map(map) => map.entries.borrow().iter().map(|(key, _)| key.clone()).collect(),
        Value::View(view, map) => {
            let entries = map.entries.borrow();
            let item = |(key, value): &(Value, Value)| match view {
                View::Keys => key.clone(),
                View::Values => value.clone(),
                View::Items => Value::tuple(vec![key.clone(), value.clone()]),
            };
            entries.iter().map(item).collect()
        }
        Value::Set(set) if set.borrow().len() < 2 => {
            set.borrow().iter().map(|(item, _)| item.clone()).collect()
        }
        Value::Set(_) => {
            return Err(Fault::new(
                "a set of several items has no order, so the order of its items would differ in each run",
                "write sorted(…) around it, or use a list",
            ));
        }
        Value::Text(text) => text.chars().map(Value::text).collect(),
        Value::Range(range) => {
            let count = range.len().to_usize().unwrap_or(usize::MAX);
            sized(count.saturating_mul(size_of::<Value>()))?;
            (0..count).map(|place| Value::Int(range.at(&BigInt::from(place)))).collect()
        }
        Value::Iterator(stream) => {
            let items = stream.items.take().into();
            work.take(1)?;
            return Ok((items, stream.fault.clone()));
        }
        other => {
            return Err(Fault::new(
                format!("'{}' is {}, which has no items", other.shown(), other.kind()),
                "use a list, or another value with items",
            ));
        }
    };
    work.take(items.len())?;
    Ok((items, None))
}

/// Returns the items in any order, for functions whose result does not depend on the order.
pub(crate) fn items_in_any_order(value: &Value, work: &Work) -> Result<Vec<Value>, Fault> {
    match value {
        Value::Set(set) => {
            let items: Vec<_> = set.borrow().iter().map(|(item, _)| item.clone()).collect();
            work.take(items.len())?;
            Ok(items)
        }
        other => items(other, work),
    }
}

/// Checks that a new value is not too large, and counts the work of creating it.
pub(crate) fn checked(value: Value, work: &Work) -> Result<Value, Fault> {
    let size = sized(value.size())?;
    work.take(size / 64)?;
    Ok(value)
}

/// Returns the key of a dictionary or set for a value.
pub(crate) fn key(value: &Value) -> Result<Key, Fault> {
    Key::of(value).map_err(|part| {
        Fault::new(
            format!("{} ('{}') cannot be a key, or an item of a set", part.kind(), part.shown()),
            "use a number, a text or a tuple of these",
        )
    })
}

/// Returns the text of a value as printed by Python's `str`.
///
/// # Errors
/// If the text differs in each run, as that of a function does.
pub(crate) fn printed(value: &Value) -> Result<String, Fault> {
    if let Value::Text(text) = value {
        return Ok(text.clone());
    }
    sized(value.size())?;
    match value.unprintable() {
        None => Ok(value.to_string()),
        Some(what) => Err(Fault::new(
            format!("the result is or contains {what}, whose text differs in each run"),
            "call it, or convert it to a list with list(…) or sorted(…)",
        )),
    }
}
