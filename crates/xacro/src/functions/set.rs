//! Methods and operators of sets.

use super::Arguments;
use super::items::{items_in_any_order, key};
use crate::expression::Arithmetic;
use crate::fault::Fault;
use crate::limits::{Work, sized};
use crate::value::{Entries, Value};
use std::cell::RefCell;
use std::cmp::Ordering;
use std::rc::Rc;

pub(super) const NAMES: [&str; 11] = [
    "add",
    "copy",
    "difference",
    "discard",
    "intersection",
    "isdisjoint",
    "issubset",
    "issuperset",
    "symmetric_difference",
    "union",
    "update",
];

/// Applies `& | ^ -`; `None` for other operators.
pub(super) fn operator(
    operator: Arithmetic,
    a: &Entries,
    b: &Entries,
    work: &Work,
) -> Result<Option<Value>, Fault> {
    let mut result = Entries::default();
    work.take(a.len() + b.len())?;
    let (in_both, in_a, in_b) = match operator {
        Arithmetic::BitAnd => (true, false, false),
        Arithmetic::BitOr => (true, true, true),
        Arithmetic::BitXor => (false, true, true),
        Arithmetic::Subtract => (false, true, false),
        _ => return Ok(None),
    };
    for (from, other, alone) in [(a, b, in_a), (b, a, in_b)] {
        for (item, _) in from.iter() {
            let key = key(item)?;
            let is_kept = if other.contains(&key) { in_both } else { alone };
            if is_kept && !result.contains(&key) {
                result.insert(key, item.clone(), Value::None);
            }
        }
    }
    Ok(Some(Value::Set(Rc::new(RefCell::new(result)))))
}

pub(super) fn method(
    set: &Rc<RefCell<Entries>>,
    name: &str,
    arguments: &Arguments,
    work: &Work,
) -> Result<Option<Value>, Fault> {
    let positional = arguments.unnamed(name)?;
    work.take(1)?;
    match (name, positional) {
        ("add", [item]) => {
            let key = key(item)?;
            sized((set.borrow().len() + 1) * (size_of::<Value>() + item.size()))?;
            if !set.borrow().contains(&key) {
                set.borrow_mut().insert(key, item.clone(), Value::None);
            }
            return Ok(Some(Value::None));
        }
        ("discard", [item]) => {
            work.take(set.borrow().len())?;
            set.borrow_mut().remove(&key(item)?);
            return Ok(Some(Value::None));
        }
        ("copy", []) => return Ok(Some(Value::Set(Rc::new(RefCell::new(set.borrow().clone()))))),
        _ => {}
    }
    let own = Value::Set(set.clone());
    let other = |items: &Value| super::conversions::set(items_in_any_order(items, work)?);
    if let "issubset" | "issuperset" | "isdisjoint" = name {
        let [items] = positional else { return Ok(None) };
        let other = other(items)?;
        let order = own.order(&other).ok().flatten();
        return Ok(Some(Value::Bool(match (name, &other) {
            ("issubset", _) => matches!(order, Some(Ordering::Less | Ordering::Equal)),
            ("issuperset", _) => matches!(order, Some(Ordering::Greater | Ordering::Equal)),
            (_, Value::Set(other)) => {
                let common = operator(Arithmetic::BitAnd, &set.borrow(), &other.borrow(), work)?;
                !common.is_some_and(|common| common.truth())
            }
            _ => return Ok(None),
        })));
    }
    let operation = match name {
        "union" | "update" => Arithmetic::BitOr,
        "intersection" => Arithmetic::BitAnd,
        "difference" => Arithmetic::Subtract,
        _ => Arithmetic::BitXor,
    };
    let mut result = Value::Set(Rc::new(RefCell::new(set.borrow().clone())));
    for items in positional {
        let other = other(items)?;
        let (Value::Set(a), Value::Set(b)) = (&result, &other) else { return Ok(None) };
        let combined = operator(operation, &a.borrow(), &b.borrow(), work)?;
        let Some(combined) = combined else { return Ok(None) };
        sized(combined.size())?;
        result = combined;
    }
    if let ("update", Value::Set(result)) = (name, &result) {
        *set.borrow_mut() = result.borrow().clone();
        return Ok(Some(Value::None));
    }
    Ok(Some(result))
}
