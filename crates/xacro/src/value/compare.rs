//! Equality and order.

use super::{Value, View};
use num_bigint::BigInt;
use num_traits::{FromPrimitive, ToPrimitive};
use std::cmp::Ordering;
use std::rc::Rc;

/// The error for two values without an order.
#[derive(Debug)]
pub(crate) struct Unordered;

impl Value {
    /// Returns the result of `==`: numbers are compared by value, whatever their type.
    pub(crate) fn equals(&self, other: &Self) -> bool {
        if let Some(ordering) = numbers(self, other) {
            return ordering == Some(Ordering::Equal);
        }
        match (self, other) {
            (Self::None, Self::None) => true,
            (Self::Text(a), Self::Text(b)) => a == b,
            (Self::List(a), Self::List(b)) => {
                Rc::ptr_eq(a, b) || all_same(&a.items.borrow(), &b.items.borrow())
            }
            (Self::Tuple(a), Self::Tuple(b)) => all_same(&a.items, &b.items),
            (Self::Map(a), Self::Map(b)) => {
                let (a, b) = (a.entries.borrow(), b.entries.borrow());
                a.len() == b.len()
                    && a.iter().all(|(name, value)| {
                        let other = super::Key::of(name).ok().and_then(|key| b.get(&key).cloned());
                        other.is_some_and(|other| same(value, &other))
                    })
            }
            (Self::Set(a), Self::Set(b)) => {
                a.borrow().len() == b.borrow().len() && subset(self, other) == Some(true)
            }
            (Self::Range(a), Self::Range(b)) => {
                let (length, other) = (a.len(), b.len());
                length == other
                    && (length == BigInt::from(0)
                        || (a.start == b.start && (length == BigInt::from(1) || a.step == b.step)))
            }
            _ => same_object(self, other),
        }
    }

    /// Compares like Python's `<`, or returns an error if the types have no order. `None` is the order of NaN.
    pub(crate) fn order(&self, other: &Self) -> Result<Option<Ordering>, Unordered> {
        if let Some(ordering) = numbers(self, other) {
            return Ok(ordering);
        }
        match (self, other) {
            (Self::Text(a), Self::Text(b)) => Ok(Some(a.cmp(b))),
            (Self::List(a), Self::List(b)) => sequence_order(&a.items.borrow(), &b.items.borrow()),
            (Self::Tuple(a), Self::Tuple(b)) => sequence_order(&a.items, &b.items),
            (Self::Set(_), Self::Set(_)) => Ok(match (subset(self, other), subset(other, self)) {
                (Some(true), Some(true)) => Some(Ordering::Equal),
                (Some(true), _) => Some(Ordering::Less),
                (_, Some(true)) => Some(Ordering::Greater),
                _ => None,
            }),
            _ => Err(Unordered),
        }
    }
}

/// Compares two numbers exactly; `None` if one of them is not a number.
#[expect(clippy::option_option, reason = "the inner one is the order of NaN")]
fn numbers(a: &Value, b: &Value) -> Option<Option<Ordering>> {
    Some(match (a, b) {
        (Value::Float(a), Value::Float(b)) => a.partial_cmp(b),
        (Value::Float(a), b) => float_and_int(*a, &b.integer()?),
        (a, Value::Float(b)) => float_and_int(*b, &a.integer()?).map(Ordering::reverse),
        (a, b) => Some(a.integer()?.cmp(&b.integer()?)),
    })
}

fn float_and_int(float: f64, int: &BigInt) -> Option<Ordering> {
    if let Some(small) = int.to_i32() {
        return float.partial_cmp(&f64::from(small));
    }
    let Some(floor) = BigInt::from_f64(float.floor()) else {
        return float.partial_cmp(&0.0);
    };
    let fraction = if float.fract() == 0.0 { Ordering::Equal } else { Ordering::Greater };
    Some(floor.cmp(int).then(fraction))
}

/// Returns true if two members of containers are the same object, or equal.
pub(crate) fn same(a: &Value, b: &Value) -> bool {
    a.equals(b)
}

fn all_same(a: &[Value], b: &[Value]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same(a, b))
}

fn sequence_order(a: &[Value], b: &[Value]) -> Result<Option<Ordering>, Unordered> {
    match a.iter().zip(b).find(|(a, b)| !same(a, b)) {
        Some((a, b)) => a.order(b),
        None => Ok(Some(a.len().cmp(&b.len()))),
    }
}

fn subset(a: &Value, b: &Value) -> Option<bool> {
    let (Value::Set(a), Value::Set(b)) = (a, b) else { return None };
    let (a, b) = (a.borrow(), b.borrow());
    Some(a.iter().all(|(item, _)| super::Key::of(item).is_ok_and(|key| b.contains(&key))))
}

fn same_object(a: &Value, b: &Value) -> bool {
    match (a, b) {
        (Value::View(View::Keys, a), Value::View(View::Keys, b)) => {
            let (a, b) = (a.entries.borrow(), b.entries.borrow());
            a.len() == b.len()
                && a.iter().all(|(name, _)| super::Key::of(name).is_ok_and(|key| b.contains(&key)))
        }
        (Value::Iterator(a), Value::Iterator(b)) => Rc::ptr_eq(a, b),
        (Value::Function(a), Value::Function(b)) => match (a, b) {
            (super::Function::Builtin(a), super::Function::Builtin(b)) => a == b,
            (super::Function::Lambda(a), super::Function::Lambda(b)) => Rc::ptr_eq(a, b),
            _ => false,
        },
        _ => false,
    }
}
