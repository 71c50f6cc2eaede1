//! `x[i]` and `x[i:j:k]`.

use super::Evaluator;
use crate::expression::Expression;
use crate::fault::Fault;
use crate::functions::{checked, key};
use crate::limits::Work;
use crate::suggestion::did_you_mean;
use crate::value::{List, Range, Value};
use num_bigint::BigInt;
use num_traits::{Signed, ToPrimitive};
use std::rc::Rc;

impl Evaluator<'_> {
    pub(super) fn slice(
        &mut self,
        operand: &Expression,
        bounds: &[Option<Expression>; 3],
    ) -> Result<Value, Fault> {
        let operand = self.value(operand)?;
        let mut values = [None, None, None];
        for (value, bound) in values.iter_mut().zip(bounds) {
            let Some(bound) = bound else { continue };
            *value = match self.value(bound)? {
                Value::None => None,
                bound => Some(bound.integer().ok_or_else(|| no_index(&bound))?),
            };
        }
        slice(&operand, &values, self.work)
    }
}

fn no_index(value: &Value) -> Fault {
    Fault::new(
        format!("'[ ]' cannot be applied with {} ('{}')", value.kind(), value.shown()),
        "use an integer there",
    )
}

pub(super) fn item(operand: &Value, index: &Value, work: &Work) -> Result<Value, Fault> {
    if let Value::Map(map) = operand {
        let entries = map.entries.borrow();
        let found = entries.get(&key(index)?).cloned();
        let found = found.ok_or_else(|| {
            let known: Vec<String> = entries.iter().take(20).map(|(key, _)| key.shown()).collect();
            let meant = did_you_mean(&index.shown(), known.iter().map(String::as_str));
            let remedy = meant.unwrap_or_else(|| format!("it has {}", known.join(", ")));
            Fault::new(format!("the dictionary has no '{}'", index.shown()), remedy)
        })?;
        return part(found, map.dotted, work);
    }
    let at = index.integer().ok_or_else(|| no_index(index))?;
    let place = |length: usize| {
        let at = if at.is_negative() { &at + length } else { at.clone() };
        at.to_usize().filter(|at| *at < length)
    };
    let found = match operand {
        Value::List(list) => {
            let items = list.items.borrow();
            let found = place(items.len()).map(|at| items[at].clone());
            found.map(|item| part(item, list.dotted, work)).transpose()?
        }
        Value::Tuple(tuple) => place(tuple.items.len()).map(|at| tuple.items[at].clone()),
        Value::Text(text) => {
            work.take(text.len() / 64)?;
            place(text.chars().count()).and_then(|at| text.chars().nth(at)).map(Value::text)
        }
        Value::Range(range) => {
            let length = range.len();
            let at = if at.is_negative() { &at + &length } else { at.clone() };
            (!at.is_negative() && at < length).then(|| Value::Int(range.at(&at)))
        }
        other => {
            return Err(Fault::new(
                format!("'[ ]' cannot be applied to {} ('{}')", other.kind(), other.shown()),
                "use a list, a text or a dictionary there",
            ));
        }
    };
    found.ok_or_else(|| {
        Fault::new(format!("index {at} is outside of '{}'", operand.shown()), "correct the index")
    })
}

/// Returns a part of a YAML file as a copy.
fn part(value: Value, is_dotted: bool, work: &Work) -> Result<Value, Fault> {
    if !is_dotted || !matches!(value, Value::List(_) | Value::Map(_)) {
        return Ok(value);
    }
    work.take(value.size() / 64)?;
    Ok(value.dotted())
}

fn slice(operand: &Value, bounds: &[Option<BigInt>; 3], work: &Work) -> Result<Value, Fault> {
    let step = bounds[2].clone().unwrap_or_else(|| 1.into());
    if step == 0.into() {
        return Err(Fault::new("a slice has the step 0", "correct the step"));
    }
    // Characters and items are counted in the same way.
    let characters: Vec<char>;
    let length: BigInt = match operand {
        Value::List(list) => list.items.borrow().len().into(),
        Value::Tuple(tuple) => tuple.items.len().into(),
        Value::Text(text) => {
            work.take(text.len() / 16)?;
            characters = text.chars().collect();
            let [start, end, _] = range(bounds, &step, &characters.len().into());
            let text = places(&start, &end, &step).map(|at| characters[at]).collect();
            return Ok(Value::Text(text));
        }
        Value::Range(range) => range.len(),
        other => {
            return Err(Fault::new(
                format!("'[:]' cannot be applied to {} ('{}')", other.kind(), other.shown()),
                "use a list or a text there",
            ));
        }
    };
    let [start, end, _] = range(bounds, &step, &length);
    match operand {
        Value::Range(range) => {
            let sliced = Range { start: range.at(&start), end: range.at(&end), step: &range.step * step };
            Ok(Value::Range(Rc::new(sliced)))
        }
        Value::List(list) => {
            let all = list.items.borrow();
            let items = places(&start, &end, &step).map(|at| all[at].clone()).collect();
            checked(Value::List(Rc::new(List::new(items, list.dotted))), work)
        }
        Value::Tuple(tuple) => {
            let items = places(&start, &end, &step).map(|at| tuple.items[at].clone()).collect();
            checked(Value::tuple(items), work)
        }
        _ => Ok(Value::None),
    }
}

/// The bounds of a slice of a sequence with this length, by Python's rules.
fn range(bounds: &[Option<BigInt>; 3], step: &BigInt, length: &BigInt) -> [BigInt; 3] {
    let is_down = step.is_negative();
    let (least, most): (BigInt, BigInt) =
        if is_down { ((-1).into(), length - 1) } else { (0.into(), length.clone()) };
    let bound = |value: &Option<BigInt>, default: &BigInt| match value {
        None => default.clone(),
        Some(at) => {
            let at = if at.is_negative() { at + length } else { at.clone() };
            at.clamp(least.clone(), most.clone().max(least.clone()))
        }
    };
    let (first, last) = if is_down { (&most, &least) } else { (&least, &most) };
    [bound(&bounds[0], first), bound(&bounds[1], last), step.clone()]
}

/// The positions from `start` to before `end`, which are inside the sequence.
fn places(start: &BigInt, end: &BigInt, step: &BigInt) -> impl Iterator<Item = usize> {
    let big = |int: &BigInt| int.to_i64().unwrap_or(if int.is_negative() { i64::MIN } else { i64::MAX });
    let (start, end, step) = (big(start), big(end), big(step));
    std::iter::successors(Some(start), move |at| at.checked_add(step))
        .take_while(move |at| if step > 0 { *at < end } else { *at > end })
        .filter_map(|at| usize::try_from(at).ok())
}
