//! The functions, methods and constants that expressions may use: Python's `math` and the built-ins that xacro exposes.
//!
//! Transcendental functions are libm's, so that a robot has the same bits on every machine.

pub(super) mod arithmetic;
mod builtin;
mod conversions;
mod exact;
mod format;
mod items;
mod list;
mod map;
mod mathematics;
mod percent;
mod rounding;
mod set;
mod template;
mod text;
mod text_search;

pub(super) use conversions::set as set_of;
pub(super) use items::{checked, items, items_in_any_order, key, printed};

use super::fault::Fault;
use super::limits::Work;
use super::value::{Function, Value};
use crate::suggestion::did_you_mean;
use std::f64::consts;

/// The arguments of a call.
#[derive(Debug, Default)]
pub(super) struct Arguments {
    pub(super) positional: Vec<Value>,
    pub(super) named: Vec<(String, Value)>,
}

impl Arguments {
    /// Returns the arguments of a function that accepts none by name.
    pub(super) fn unnamed(&self, function: &str) -> Result<&[Value], Fault> {
        match self.named.first() {
            None => Ok(&self.positional),
            Some((name, _)) => Err(Fault::new(
                format!("{function} has no argument named '{name}'"),
                "give it without a name",
            )),
        }
    }

    /// Assigns arguments to a list of parameters; some arguments may be given by name.
    pub(super) fn placed<const N: usize>(
        &self,
        function: &str,
        parameters: [&str; N],
    ) -> Result<[Option<&Value>; N], Fault> {
        let mut places = [None; N];
        if self.positional.len() > N {
            return Err(misuse(function, &self.positional));
        }
        for (place, value) in places.iter_mut().zip(&self.positional) {
            *place = Some(value);
        }
        for (name, value) in &self.named {
            let place = parameters.iter().position(|parameter| parameter == name);
            match place.map(|place| &mut places[place]) {
                Some(place @ None) => *place = Some(value),
                Some(Some(_)) => {
                    return Err(Fault::new(
                        format!("the argument '{name}' of {function} is given twice"),
                        "leave one of them out",
                    ));
                }
                None => {
                    let meant = did_you_mean(name, parameters).unwrap_or_else(|| "leave it out".into());
                    return Err(Fault::new(format!("{function} has no argument named '{name}'"), meant));
                }
            }
        }
        Ok(places)
    }
}

/// Returns the value of `pi`, `M_PI`, `tau`, `e`, `inf` or `nan`, with or without `math.` before it.
pub(super) fn constant(name: &str) -> Option<Value> {
    Some(Value::Float(match name.strip_prefix("math.").unwrap_or(name) {
        "pi" | "M_PI" => consts::PI,
        "tau" => consts::TAU,
        "e" => consts::E,
        "inf" => f64::INFINITY,
        "nan" => f64::NAN,
        _ => return None,
    }))
}

/// The built-in functions, which xacro has with, and some also without, the prefix `python.`.
const BUILTIN: [&str; 31] = [
    "abs",
    "all",
    "any",
    "bool",
    "chr",
    "dict",
    "divmod",
    "enumerate",
    "filter",
    "float",
    "int",
    "isinstance",
    "len",
    "list",
    "map",
    "max",
    "min",
    "ord",
    "range",
    "repr",
    "reversed",
    "round",
    "set",
    "sorted",
    "str",
    "sum",
    "tuple",
    "zip",
    "hex",
    "oct",
    "bin",
];

/// Returns the function with this name, if there is one.
pub(super) fn find(name: &str) -> Option<Function> {
    let known = |names: &[&'static str], name: &str| {
        names.iter().find(|known| **known == name).map(|known| Function::Builtin(known))
    };
    if let Some(name) = name.strip_prefix("math.") {
        known(&mathematics::NAMES, name)
    } else if let Some(name) = name.strip_prefix("python.") {
        known(&BUILTIN, name)
    } else {
        known(&mathematics::NAMES, name).or_else(|| known(&BUILTIN, name))
    }
}

/// Returns the fault for a function that does not exist.
pub(super) fn unknown(name: &str) -> Fault {
    let known = BUILTIN.into_iter().chain(mathematics::NAMES);
    let meant = did_you_mean(name, known.chain(["xacro.load_yaml", "xacro.arg", "xacro.abs_filename"]));
    let remedy = meant
        .unwrap_or_else(|| "use one of Python's functions that xacro has, such as abs, round or len".into());
    Fault::new(format!("unknown function '{name}'"), remedy)
}

/// Calls a built-in function that does not take a function as an argument.
pub(super) fn call(name: &str, arguments: &Arguments, work: &Work) -> Result<Value, Fault> {
    let result = match mathematics::call(name, arguments, work)? {
        Some(value) => Some(value),
        None => match conversions::call(name, arguments, work)? {
            Some(value) => Some(value),
            None => builtin::call(name, arguments, work)?,
        },
    };
    result.ok_or_else(|| misuse(name, &arguments.positional))
}

/// Returns true if a value has a method with this name.
pub(super) fn has_method(object: &Value, name: &str) -> bool {
    let names: &[&str] = match object {
        Value::Text(_) => &text::NAMES,
        Value::List(_) => &list::NAMES,
        Value::Tuple(_) | Value::Range(_) => &["count", "index"],
        Value::Map(_) => &map::NAMES,
        Value::Set(_) => &set::NAMES,
        Value::Int(_) | Value::Bool(_) => &["bit_length", "conjugate", "bit_count"],
        Value::Float(_) => &["is_integer", "conjugate"],
        _ => &[],
    };
    names.contains(&name)
}

/// Calls a method of a value, which changes the value if the method does.
pub(super) fn method(object: &Value, name: &str, arguments: &Arguments, work: &Work) -> Result<Value, Fault> {
    if !has_method(object, name) {
        return Err(no_method(object, name));
    }
    let result = match object {
        Value::Text(text) => text::method(text, name, arguments, work)?,
        Value::List(list) => list::method(list, name, arguments, work)?,
        Value::Tuple(_) | Value::Range(_) => list::sequence(&items(object, work)?, name, arguments)?,
        Value::Map(map) => map::method(map, name, arguments, work)?,
        Value::Set(set) => set::method(set, name, arguments, work)?,
        _ => mathematics::method(object, name, arguments),
    };
    result.ok_or_else(|| misuse(name, &arguments.positional))
}

fn no_method(object: &Value, name: &str) -> Fault {
    let known: &[&str] = match object {
        Value::Text(_) => &text::NAMES,
        Value::List(_) => &list::NAMES,
        Value::Map(_) => &map::NAMES,
        Value::Set(_) => &set::NAMES,
        _ => &[],
    };
    let remedy = did_you_mean(name, known.iter().copied()).unwrap_or_else(|| match known {
        [] => "use a function instead".into(),
        known => format!("it has {}", known.join(", ")),
    });
    Fault::new(format!("{} has no method '{name}'", object.kind()), remedy)
}

/// Returns true if Python treats a character as white space.
fn is_space(c: char) -> bool {
    c.is_whitespace() || ('\u{1c}'..='\u{1f}').contains(&c)
}

/// Returns the fault of a function that is not defined for its arguments.
pub(crate) fn misuse(name: &str, arguments: &[Value]) -> Fault {
    let given: Vec<_> = arguments.iter().map(Value::shown).collect();
    Fault::new(
        format!("{name}({}) has no value", given.join(", ")),
        "check the number and the kind of the arguments",
    )
}
