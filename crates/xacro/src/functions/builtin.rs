//! Built-in functions of containers and numbers that do not take a function as an argument.

use super::items::{checked, items, items_in_any_order, items_until_fault};
use super::{Arguments, arithmetic, exact};
use crate::expression::Arithmetic;
use crate::fault::Fault;
use crate::limits::Work;
use crate::value::{Function, Value, is_type};
use num_bigint::BigInt;
use num_traits::{Signed, Zero};

/// Calls a function; `None` if it does not accept its arguments.
pub(super) fn call(name: &str, arguments: &Arguments, work: &Work) -> Result<Option<Value>, Fault> {
    match name {
        "sum" => return sum(arguments, work),
        "enumerate" => return enumerate(arguments, work),
        "zip" => return zip(arguments, work).map(Some),
        _ => {}
    }
    let arguments = arguments.unnamed(name)?;
    Ok(match (name, arguments) {
        ("abs", [Value::Float(float)]) => Some(Value::Float(float.abs())),
        ("abs", [value]) => value.integer().map(|int| Value::Int(int.abs())),
        ("len", [value]) => length(value).map(Value::Int),
        ("all" | "any", [values]) => {
            let (values, fault) = match values {
                Value::Set(_) => (items_in_any_order(values, work)?, None),
                _ => items_until_fault(values, work)?,
            };
            let decides = name == "any";
            if values.iter().any(|value| value.truth() == decides) {
                return Ok(Some(Value::Bool(decides)));
            }
            match fault {
                Some(fault) => return Err(fault),
                None => Some(Value::Bool(!decides)),
            }
        }
        (
            "reversed",
            [
                value @ (Value::List(_)
                | Value::Tuple(_)
                | Value::Text(_)
                | Value::Range(_)
                | Value::Map(_)
                | Value::View(..)),
            ],
        ) => {
            let mut items = items(value, work)?;
            items.reverse();
            Some(Value::iterator("reversed", items, None))
        }
        ("divmod", [a, b]) => divmod(a, b, work)?,
        ("isinstance", [value, kinds]) => {
            let kinds = match kinds {
                Value::Tuple(tuple) => tuple.items.clone(),
                one => vec![one.clone()],
            };
            let mut found = false;
            for kind in kinds {
                let Value::Function(Function::Builtin(kind)) = kind else { return Ok(None) };
                if !is_type(kind) {
                    return Ok(None);
                }
                found |= value.type_name() == kind || (kind == "int" && matches!(value, Value::Bool(_)));
            }
            Some(Value::Bool(found))
        }
        _ => None,
    })
}

fn length(value: &Value) -> Option<BigInt> {
    Some(match value {
        Value::Text(text) => text.chars().count().into(),
        Value::List(list) => list.items.borrow().len().into(),
        Value::Tuple(tuple) => tuple.items.len().into(),
        Value::Map(map) | Value::View(_, map) => map.entries.borrow().len().into(),
        Value::Set(set) => set.borrow().len().into(),
        Value::Range(range) => range.len(),
        _ => return None,
    })
}

fn divmod(a: &Value, b: &Value, work: &Work) -> Result<Option<Value>, Fault> {
    // The faults of the remainder are also those of the quotient.
    let remainder = arithmetic::binary(Arithmetic::Remainder, a, b, work)?;
    let quotient = match (a.integer(), b.integer(), a.number(), b.number()) {
        (Some(a), Some(b), ..) => Value::Int(exact::floor_division(&a, &b).0),
        (_, _, Some(a), Some(b)) => Value::Float(arithmetic::floor_division(a, b).0),
        _ => return Ok(None),
    };
    Ok(Some(Value::tuple(vec![quotient, remainder])))
}

/// Adds from the left without compensation, as Python does up to 3.11.
fn sum(arguments: &Arguments, work: &Work) -> Result<Option<Value>, Fault> {
    let [values, start] = arguments.placed("sum", ["iterable", "start"])?;
    let Some(values) = values else { return Ok(None) };
    let start = start.cloned().unwrap_or(Value::Int(BigInt::zero()));
    if let Value::Text(_) = start {
        return Ok(None);
    }
    let values = match values {
        Value::Set(set) if set.borrow().iter().all(|(item, _)| item.integer().is_some()) => {
            items_in_any_order(values, work)?
        }
        other => items(other, work)?,
    };
    let add = |sum: Value, value: &Value| arithmetic::binary(Arithmetic::Add, &sum, value, work);
    values.iter().try_fold(start, add).map(Some)
}

fn enumerate(arguments: &Arguments, work: &Work) -> Result<Option<Value>, Fault> {
    let [values, start] = arguments.placed("enumerate", ["iterable", "start"])?;
    let start = start.map_or(Some(BigInt::zero()), Value::integer);
    let (Some(values), Some(start)) = (values, start) else { return Ok(None) };
    let (values, fault) = items_until_fault(values, work)?;
    let pair = |(at, value)| Value::tuple(vec![Value::Int(&start + BigInt::from(at)), value]);
    let pairs = values.into_iter().enumerate().map(pair).collect();
    Ok(Some(checked(Value::iterator("enumerate", pairs, fault), work)?))
}

fn zip(arguments: &Arguments, work: &Work) -> Result<Value, Fault> {
    let strict = match &arguments.named[..] {
        [] => false,
        [(name, value)] if name == "strict" => value.truth(),
        _ => return Err(super::misuse("zip", &arguments.positional)),
    };
    let mut columns = Vec::new();
    let mut shortest: Option<(usize, Option<Fault>)> = None;
    for values in &arguments.positional {
        let (column, fault) = items_until_fault(values, work)?;
        if strict && shortest.as_ref().is_some_and(|(length, _)| *length != column.len()) {
            return Err(Fault::new(
                "the lists given to zip() have different lengths",
                "make them equally long, or leave strict out",
            ));
        }
        if shortest.as_ref().is_none_or(|(length, _)| column.len() < *length) {
            shortest = Some((column.len(), fault));
        }
        columns.push(column.into_iter());
    }
    let (length, fault) = shortest.unwrap_or((0, None));
    let row = |_| Value::tuple(columns.iter_mut().filter_map(Iterator::next).collect());
    let rows = (0..length).map(row).collect();
    checked(Value::iterator("zip", rows, fault), work)
}
