//! Chains of comparisons, and `in`.

use super::Evaluator;
use crate::expression::{Comparison, Expression};
use crate::fault::Fault;
use crate::functions::{arithmetic, items, key};
use crate::limits::Work;
use crate::value::{Value, same};
use num_traits::{Signed, Zero};
use std::cmp::Ordering;

impl Evaluator<'_> {
    pub(super) fn compare(
        &mut self,
        first: &Expression,
        others: &[(Comparison, Expression)],
    ) -> Result<Value, Fault> {
        let mut left = self.value(first)?;
        for (comparison, right) in others {
            let right = self.value(right)?;
            self.work.take(1)?;
            if !compare(*comparison, &left, &right, self.work)? {
                return Ok(Value::Bool(false));
            }
            left = right;
        }
        Ok(Value::Bool(true))
    }
}

fn compare(comparison: Comparison, left: &Value, right: &Value, work: &Work) -> Result<bool, Fault> {
    let walks =
        |value: &Value| matches!(value, Value::List(_) | Value::Tuple(_) | Value::Map(_) | Value::Text(_));
    if walks(left) && walks(right) {
        // Values that are nested too deeply cannot be compared.
        let size = crate::limits::sized(left.size())?.min(crate::limits::sized(right.size())?);
        work.take(size / 64)?;
    }
    let ordering = || order(left, right);
    Ok(match comparison {
        Comparison::Equal => left.equals(right),
        Comparison::NotEqual => !left.equals(right),
        Comparison::Less => ordering()? == Some(Ordering::Less),
        Comparison::Greater => ordering()? == Some(Ordering::Greater),
        Comparison::LessOrEqual => matches!(ordering()?, Some(Ordering::Less | Ordering::Equal)),
        Comparison::GreaterOrEqual => matches!(ordering()?, Some(Ordering::Greater | Ordering::Equal)),
        Comparison::In => contains(right, left, work)?,
        Comparison::NotIn => !contains(right, left, work)?,
        Comparison::Is => arithmetic::is_same(left, right)?,
        Comparison::IsNot => !arithmetic::is_same(left, right)?,
    })
}

/// Compares values that have an order.
pub(super) fn order(left: &Value, right: &Value) -> Result<Option<Ordering>, Fault> {
    left.order(right).map_err(|_| {
        Fault::new(
            format!(
                "'{}' and '{}' have no order: {} and {}",
                left.shown(),
                right.shown(),
                left.kind(),
                right.kind()
            ),
            "compare numbers with numbers and texts with texts",
        )
    })
}

fn contains(container: &Value, value: &Value, work: &Work) -> Result<bool, Fault> {
    match (container, value) {
        (Value::Map(map), _) => Ok(map.entries.borrow().contains(&key(value)?)),
        (Value::Set(set), _) => Ok(set.borrow().contains(&key(value)?)),
        (Value::Text(text), Value::Text(part)) => Ok(text.contains(part.as_str())),
        (Value::Range(range), _) if value.integer().is_some() => {
            let distance = value.integer().unwrap_or_default() - &range.start;
            let place = &distance / &range.step;
            Ok((&distance % &range.step).is_zero() && !place.is_negative() && place < range.len())
        }
        (Value::List(list), _) => {
            work.take(list.items.borrow().len())?;
            Ok(list.items.borrow().iter().any(|item| same(item, value)))
        }
        (Value::Tuple(_) | Value::Range(_) | Value::View(..) | Value::Iterator(_), _) => {
            Ok(items(container, work)?.iter().any(|item| same(item, value)))
        }
        _ => Err(Fault::new(
            format!(
                "'{}' in '{}': {} has no members of that kind",
                value.shown(),
                container.shown(),
                container.kind()
            ),
            "write a list or a text after 'in'",
        )),
    }
}
