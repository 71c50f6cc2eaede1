//! Values of expressions: their types, and Python's rules for truth and literals.

mod compare;
mod containers;
mod numbers;
mod print;

pub(super) use compare::same;
pub(super) use containers::{Entries, Key, List, Map, Tuple};
pub(super) use numbers::{float_of, int_text, integer_of, parse_float, parse_int};
pub(super) use print::{float_text, is_type};

use super::fault::Fault;
use num_bigint::BigInt;
use num_traits::{ToPrimitive, Zero};
use std::any::Any;
use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

/// The value of an expression, a property or a macro parameter.
///
/// Lists and dictionaries are shared, as in Python: if a method changes a list, every property that holds this list
/// changes.
#[derive(Debug, Clone)]
pub(super) enum Value {
    None,
    Bool(bool),
    Int(BigInt),
    Float(f64),
    Text(String),
    List(Rc<List>),
    Tuple(Rc<Tuple>),
    Map(Rc<Map>),
    Set(Rc<RefCell<Entries>>),
    Range(Rc<Range>),
    /// The result of `keys()`, `values()` and `items()` of a dictionary.
    View(View, Rc<Map>),
    Iterator(Rc<Stream>),
    Function(Function),
}

/// The numbers of a `range(…)`.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Range {
    pub(super) start: BigInt,
    pub(super) end: BigInt,
    pub(super) step: BigInt,
}

/// A view of a dictionary.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum View {
    Keys,
    Values,
    Items,
}

/// An iterator, which returns its items once. The items are computed when the iterator is created; the fault of the
/// first item without a value is reported when that item is requested.
#[derive(Debug)]
pub(super) struct Stream {
    /// The name of its Python type, such as `map` or `generator`.
    pub(super) kind: &'static str,
    pub(super) items: RefCell<VecDeque<Value>>,
    pub(super) fault: Option<Fault>,
}

/// Something that can be called.
#[derive(Debug, Clone)]
pub(super) enum Function {
    /// A function of Python, by its short name.
    Builtin(&'static str),
    /// A method and its object.
    Method(Box<Value>, String),
    /// A lambda, whose content only the evaluator knows.
    Lambda(Rc<dyn Any>),
}

/// The depth of nested lists from which a value is refused, so that no traversal exhausts the stack.
const MAX_DEPTH: usize = 100;
/// The size in bytes at which [`Value::size`] stops counting.
const COUNTED: usize = 16 << 20;

impl Range {
    /// Returns the number of items.
    pub(super) fn len(&self) -> BigInt {
        let one = BigInt::from(1);
        let (low, high, step) = if self.step > BigInt::zero() {
            (&self.start, &self.end, self.step.clone())
        } else {
            (&self.end, &self.start, -&self.step)
        };
        if low < high { (high - low - &one) / step + one } else { BigInt::zero() }
    }

    /// Returns the item at a position, which must be inside.
    pub(super) fn at(&self, place: &BigInt) -> BigInt {
        &self.start + place * &self.step
    }
}

impl Value {
    /// Creates a text.
    pub(super) fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }

    /// Creates an integer.
    pub(super) fn int(value: impl Into<BigInt>) -> Self {
        Self::Int(value.into())
    }

    /// Creates a list.
    pub(super) fn list(items: Vec<Self>) -> Self {
        Self::List(Rc::new(List::new(items, false)))
    }

    /// Creates a tuple.
    pub(super) fn tuple(items: Vec<Self>) -> Self {
        Self::Tuple(Rc::new(Tuple { items }))
    }

    /// Creates a dictionary.
    pub(super) fn map(entries: Entries) -> Self {
        Self::Map(Rc::new(Map::new(entries, false)))
    }

    /// Creates an iterator over items, followed by a fault, if any.
    pub(super) fn iterator(kind: &'static str, items: Vec<Self>, fault: Option<Fault>) -> Self {
        Self::Iterator(Rc::new(Stream { kind, items: RefCell::new(items.into()), fault }))
    }

    /// Returns the same list or dictionary in the form in which xacro returns parts of YAML files: a copy whose keys
    /// can be used as attributes.
    pub(super) fn dotted(self) -> Self {
        match self {
            Self::List(list) => Self::List(Rc::new(List::new(list.items.borrow().clone(), true))),
            Self::Map(map) => Self::Map(Rc::new(Map::new(map.entries.borrow().clone(), true))),
            other => other,
        }
    }

    /// Parses a property's text like xacro: a number, `true` or `false`, a text in single quotes without these, or
    /// otherwise the text itself. Underscores are never part of a number.
    pub(super) fn literal(text: &str) -> Self {
        if text.len() >= 2 && text.starts_with('\'') && text.ends_with('\'') {
            return Self::text(&text[1..text.len() - 1]);
        }
        if !text.contains('_') {
            if let Some(int) = parse_int(text, 10) {
                return Self::Int(int);
            }
            if let Some(float) = parse_float(text) {
                return Self::Float(float);
            }
        }
        match text {
            "true" | "True" => Self::Bool(true),
            "false" | "False" => Self::Bool(false),
            _ => Self::text(text),
        }
    }

    /// Parses a text again as a literal; other values are returned unchanged.
    pub(super) fn into_literal(self) -> Self {
        match self {
            Self::Text(text) => Self::literal(&text),
            other => other,
        }
    }

    /// Returns the approximate size in bytes. A value that is nested too deeply is larger than any limit.
    pub(super) fn size(&self) -> usize {
        let mut size = 0;
        if self.measure(MAX_DEPTH, &mut size) { size } else { usize::MAX }
    }

    /// Adds the size, and returns true if the value is neither nested too deeply nor too large.
    fn measure(&self, depth: usize, size: &mut usize) -> bool {
        *size += size_of::<Self>();
        if depth == 0 || *size > COUNTED {
            return false;
        }
        let below = depth - 1;
        match self {
            Self::Text(text) => *size += text.len(),
            Self::Int(int) => *size += int.bits() as usize / 8,
            Self::List(list) => {
                return list.items.borrow().iter().all(|item| item.measure(below, size));
            }
            Self::Tuple(tuple) => return tuple.items.iter().all(|item| item.measure(below, size)),
            Self::Map(map) | Self::View(_, map) => {
                let entries = map.entries.borrow();
                return entries
                    .iter()
                    .all(|(key, value)| key.measure(below, size) && value.measure(below, size));
            }
            Self::Set(set) => return set.borrow().iter().all(|(item, _)| item.measure(below, size)),
            Self::Iterator(stream) => {
                return stream.items.borrow().iter().all(|item| item.measure(below, size));
            }
            Self::Function(Function::Method(object, _)) => return object.measure(below, size),
            _ => {}
        }
        true
    }

    /// Returns the truth value in Python: zero and empty values are false.
    pub(super) fn truth(&self) -> bool {
        match self {
            Self::None => false,
            Self::Bool(value) => *value,
            Self::Int(value) => !value.is_zero(),
            Self::Float(value) => *value != 0.0,
            Self::Text(value) => !value.is_empty(),
            Self::List(list) => !list.items.borrow().is_empty(),
            Self::Tuple(tuple) => !tuple.items.is_empty(),
            Self::Map(map) | Self::View(_, map) => map.entries.borrow().len() > 0,
            Self::Set(set) => set.borrow().len() > 0,
            Self::Range(range) => !range.len().is_zero(),
            Self::Iterator(_) | Self::Function(_) => true,
        }
    }

    /// Returns the value as a number, if it is one; a boolean counts as 0 or 1. An integer beyond the range of floats
    /// is infinite.
    pub(super) fn number(&self) -> Option<f64> {
        match self {
            Self::Float(value) => Some(*value),
            _ => self.integer().map(|value| float_of(&value)),
        }
    }

    /// Returns the value as an integer, if it is one; a boolean counts as 0 or 1.
    pub(super) fn integer(&self) -> Option<BigInt> {
        match self {
            Self::Int(value) => Some(value.clone()),
            Self::Bool(value) => Some(BigInt::from(u8::from(*value))),
            _ => None,
        }
    }

    /// Returns the value as an integer of 64 bits, if it is one.
    pub(super) fn small_integer(&self) -> Option<i64> {
        match self {
            Self::Int(value) => value.to_i64(),
            Self::Bool(value) => Some(i64::from(*value)),
            _ => None,
        }
    }

    /// Returns the text, if the value is one.
    pub(super) fn as_text(&self) -> Option<&str> {
        match self {
            Self::Text(text) => Some(text),
            _ => None,
        }
    }

    /// Returns a description of the type for error messages.
    pub(super) fn kind(&self) -> &'static str {
        match self {
            Self::None => "nothing",
            Self::Bool(_) => "a boolean",
            Self::Int(_) | Self::Float(_) => "a number",
            Self::Text(_) => "a text",
            Self::List(_) => "a list",
            Self::Tuple(_) => "a tuple",
            Self::Map(_) => "a dictionary",
            Self::Set(_) => "a set",
            Self::Range(_) => "a range",
            Self::View(..) => "a view of a dictionary",
            Self::Iterator(_) => "an iterator",
            Self::Function(_) => "a function",
        }
    }

    /// Returns the name of its Python type.
    pub(super) fn type_name(&self) -> &'static str {
        match self {
            Self::None => "NoneType",
            Self::Bool(_) => "bool",
            Self::Int(_) => "int",
            Self::Float(_) => "float",
            Self::Text(_) => "str",
            Self::List(_) => "list",
            Self::Tuple(_) => "tuple",
            Self::Map(_) => "dict",
            Self::Set(_) => "set",
            Self::Range(_) => "range",
            Self::View(..) => "view",
            Self::Iterator(stream) => stream.kind,
            Self::Function(_) => "function",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn literals_have_types() {
        for (text, kind, printed) in [
            ("3", "int", "3"),
            (" 0.5 ", "float", "0.5"),
            ("'3'", "str", "3"),
            ("true", "bool", "True"),
            ("1_000", "str", "1_000"),
            ("1 2", "str", "1 2"),
            ("-inf", "float", "-inf"),
            ("123456789012345678901234567890", "int", "123456789012345678901234567890"),
        ] {
            let value = Value::literal(text);
            assert_eq!((value.type_name(), value.to_string().as_str()), (kind, printed), "{text}");
        }
    }

    #[test]
    fn depth_and_size_are_bounded() {
        let mut value = Value::Int(1.into());
        for _ in 0..90 {
            value = Value::list(vec![value]);
        }
        assert!(value.size() < 1 << 20);
        for _ in 0..100_000 {
            value = Value::tuple(vec![Value::list(vec![value])]);
        }
        // Neither this nor the destructor exhausts the stack.
        assert_eq!(value.size(), usize::MAX);
    }
}
