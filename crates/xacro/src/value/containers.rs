//! Lists, tuples, dictionaries and sets.

use super::Value;
use num_bigint::BigInt;
use num_traits::FromPrimitive;
use std::cell::RefCell;
use std::collections::HashMap;
use std::mem::take;
use std::rc::Rc;

/// A list.
#[derive(Debug)]
pub(crate) struct List {
    pub(crate) items: RefCell<Vec<Value>>,
    /// True if it is from a YAML file: its parts are returned as copies whose keys can be used as attributes.
    pub(crate) dotted: bool,
}

/// A tuple.
#[derive(Debug)]
pub(crate) struct Tuple {
    pub(crate) items: Vec<Value>,
}

/// A dictionary.
#[derive(Debug)]
pub(crate) struct Map {
    pub(crate) entries: RefCell<Entries>,
    /// True if keys can be used as attributes, as in dictionaries of YAML files.
    pub(crate) dotted: bool,
}

/// The entries of a dictionary, or the items of a set as keys, in the order of insertion.
#[derive(Debug, Clone, Default)]
pub(crate) struct Entries {
    places: HashMap<Key, usize>,
    entries: Vec<(Value, Value)>,
}

/// The identity of a key. Numbers are the same key if their values are equal, such as 1, 1.0 and True.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) enum Key {
    None,
    Int(BigInt),
    Float(u64),
    Text(String),
    Tuple(Vec<Key>),
    Range(BigInt, BigInt, BigInt),
}

impl Key {
    /// Returns the key of a value, or the mutable part of it that prevents its use as a key.
    pub(crate) fn of(value: &Value) -> Result<Self, &Value> {
        Ok(match value {
            Value::None => Self::None,
            Value::Text(text) => Self::Text(text.clone()),
            Value::Float(float) => match BigInt::from_f64(*float).filter(|_| float.fract() == 0.0) {
                Some(int) => Self::Int(int),
                None => Self::Float(float.to_bits()),
            },
            Value::Tuple(tuple) => Self::Tuple(tuple.items.iter().map(Self::of).collect::<Result<_, _>>()?),
            Value::Range(range) => Self::Range(range.start.clone(), range.end.clone(), range.step.clone()),
            other => Self::Int(other.integer().ok_or(other)?),
        })
    }
}

impl List {
    pub(crate) fn new(items: Vec<Value>, dotted: bool) -> Self {
        Self { items: RefCell::new(items), dotted }
    }
}

impl Map {
    pub(crate) fn new(entries: Entries, dotted: bool) -> Self {
        Self { entries: RefCell::new(entries), dotted }
    }
}

impl Entries {
    pub(crate) fn len(&self) -> usize {
        self.entries.len()
    }

    pub(crate) fn iter(&self) -> impl DoubleEndedIterator<Item = &(Value, Value)> {
        self.entries.iter()
    }

    pub(crate) fn get(&self, key: &Key) -> Option<&Value> {
        self.places.get(key).map(|place| &self.entries[*place].1)
    }

    pub(crate) fn contains(&self, key: &Key) -> bool {
        self.places.contains_key(key)
    }

    /// Sets an entry; an existing key keeps its position.
    pub(crate) fn insert(&mut self, key: Key, name: Value, value: Value) {
        if let Some(place) = self.places.get(&key) {
            self.entries[*place].1 = value;
        } else {
            self.places.insert(key, self.entries.len());
            self.entries.push((name, value));
        }
    }

    /// Removes an entry. The work is proportional to the number of entries.
    pub(crate) fn remove(&mut self, key: &Key) -> Option<(Value, Value)> {
        let place = self.places.remove(key)?;
        for other in self.places.values_mut().filter(|other| **other > place) {
            *other -= 1;
        }
        Some(self.entries.remove(place))
    }

    pub(crate) fn clear(&mut self) {
        *self = Self::default();
    }
}

/// Destroys values one after the other, so that deeply nested lists do not exhaust the stack.
fn dismantle(mut open: Vec<Value>) {
    while let Some(value) = open.pop() {
        match value {
            Value::List(mut list) => {
                if let Some(list) = Rc::get_mut(&mut list) {
                    open.append(list.items.get_mut());
                }
            }
            Value::Tuple(mut tuple) => {
                if let Some(tuple) = Rc::get_mut(&mut tuple) {
                    open.append(&mut tuple.items);
                }
            }
            Value::Map(mut map) => {
                if let Some(map) = Rc::get_mut(&mut map) {
                    let entries = take(&mut map.entries.get_mut().entries);
                    open.extend(entries.into_iter().flat_map(|(key, value)| [key, value]));
                }
            }
            _ => {}
        }
    }
}

impl Drop for List {
    fn drop(&mut self) {
        dismantle(take(self.items.get_mut()));
    }
}

impl Drop for Tuple {
    fn drop(&mut self) {
        dismantle(take(&mut self.items));
    }
}

impl Drop for Map {
    fn drop(&mut self) {
        let entries = take(&mut self.entries.get_mut().entries);
        dismantle(entries.into_iter().flat_map(|(key, value)| [key, value]).collect());
    }
}
