//! The functions and constants that expressions may use: Python's `math` and the built-ins that xacro exposes.
//!
//! Transcendental functions are libm's, so that a robot has the same bits on every machine.

use super::fault::Fault;
use super::limits::{sized, too_large};
use super::value::Value;
use crate::suggestion::did_you_mean;
use std::f64::consts;

/// `pi`, `M_PI`, `tau`, `e`, `inf`, `nan`, with or without `math.` before them.
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

const FUNCTIONS: [&str; 47] = [
    "abs",
    "acos",
    "all",
    "any",
    "asin",
    "atan",
    "atan2",
    "bool",
    "ceil",
    "copysign",
    "cos",
    "cosh",
    "degrees",
    "exp",
    "fabs",
    "float",
    "floor",
    "fmod",
    "hypot",
    "int",
    "isinf",
    "isnan",
    "len",
    "list",
    "log",
    "log10",
    "log2",
    "max",
    "min",
    "pow",
    "radians",
    "range",
    "reversed",
    "round",
    "sin",
    "sinh",
    "sorted",
    "sqrt",
    "str",
    "sum",
    "tan",
    "tanh",
    "trunc",
    "tuple",
    "xacro.arg",
    "fsum",
    "repr",
];

/// The fault for a function that does not exist.
pub(super) fn unknown(name: &str) -> Fault {
    let meant = did_you_mean(name, FUNCTIONS);
    let remedy = meant.unwrap_or_else(|| "use one of Python's that xacro has, as abs, round or len".into());
    Fault::new(format!("unknown function '{name}'"), remedy)
}

/// Calls a function; none if there is none of that name.
pub(super) fn call(name: &str, arguments: &[Value]) -> Option<Result<Value, Fault>> {
    let short = name.strip_prefix("math.").or_else(|| name.strip_prefix("python.")).unwrap_or(name);
    FUNCTIONS.contains(&short).then(|| {
        mathematics(short, arguments)
            .or_else(|| builtin(short, arguments))
            .unwrap_or_else(|| Err(misuse(short, arguments)))
    })
}

fn misuse(name: &str, arguments: &[Value]) -> Fault {
    let given: Vec<_> = arguments.iter().map(ToString::to_string).collect();
    Fault::new(
        format!("{name}({}) has no value", given.join(", ")),
        "check the number and the kind of what it is given",
    )
}

/// Functions of one or two numbers with a number as result. None where they do not fit or have no real value.
fn mathematics(name: &str, arguments: &[Value]) -> Option<Result<Value, Fault>> {
    let float = |value: f64, inputs: &[f64]| {
        // NaN and infinity out of ordinary numbers is Python's "math domain error".
        let fine = value.is_finite() || inputs.iter().any(|input| !input.is_finite());
        fine.then_some(Ok(Value::Float(value)))
    };
    if let [value] = arguments {
        let x = value.number()?;
        let result = match name {
            "sin" => libm::sin(x),
            "cos" => libm::cos(x),
            "tan" => libm::tan(x),
            "asin" => libm::asin(x),
            "acos" => libm::acos(x),
            "atan" => libm::atan(x),
            "sinh" => libm::sinh(x),
            "cosh" => libm::cosh(x),
            "tanh" => libm::tanh(x),
            "sqrt" => x.sqrt(),
            "exp" => libm::exp(x),
            "log" => libm::log(x),
            "log2" => libm::log2(x),
            "log10" => libm::log10(x),
            // Python multiplies by a rounded π/180 and 180/π.
            "radians" => x * (consts::PI / 180.0),
            "degrees" => x * (180.0 / consts::PI),
            "fabs" => x.abs(),
            "isnan" => return Some(Ok(Value::Bool(x.is_nan()))),
            "isinf" => return Some(Ok(Value::Bool(x.is_infinite()))),
            "floor" => return Some(integer(x.floor())),
            "ceil" => return Some(integer(x.ceil())),
            "trunc" => return Some(integer(x.trunc())),
            _ => return None,
        };
        return float(result, &[x]);
    }
    let [first, second] = arguments else { return None };
    let (x, y) = (first.number()?, second.number()?);
    let result = match name {
        "atan2" => libm::atan2(x, y),
        "pow" => libm::pow(x, y),
        "hypot" => libm::hypot(x, y),
        "fmod" => x % y,
        "copysign" => x.copysign(y),
        "log" => libm::log(x) / libm::log(y),
        _ => return None,
    };
    float(result, &[x, y])
}

fn integer(value: f64) -> Result<Value, Fault> {
    // 2^63 is the first float that does not fit.
    if value.abs() < 9_223_372_036_854_775_808.0 { Ok(Value::Int(value as i64)) } else { Err(too_large()) }
}

fn builtin(name: &str, arguments: &[Value]) -> Option<Result<Value, Fault>> {
    Some(Ok(match (name, arguments) {
        ("abs", [Value::Float(x)]) => Value::Float(x.abs()),
        ("abs", [x]) => return Some(x.integer()?.checked_abs().map(Value::Int).ok_or_else(too_large)),
        ("int", []) => Value::Int(0),
        ("int", [Value::Float(x)]) => return Some(integer(x.trunc())),
        ("int", [Value::Text(text)]) => Value::Int(text.trim().parse().ok()?),
        ("round", [Value::Float(x)]) => return Some(integer(x.round_ties_even())),
        ("int" | "round", [x]) => Value::Int(x.integer()?),
        ("float", [Value::Text(text)]) => Value::Float(text.trim().parse().ok()?),
        ("float", [x]) => Value::Float(x.number()?),
        ("str", []) => Value::Text(String::new()),
        ("repr", [Value::Text(text)]) => Value::Text(format!("'{text}'")),
        ("str" | "repr", [x]) => Value::Text(x.to_string()),
        ("bool", []) => Value::Bool(false),
        ("bool", [x]) => Value::Bool(x.truth()),
        ("len", [Value::Text(text)]) => Value::Int(text.chars().count() as i64),
        ("len", [Value::List(items)]) => Value::Int(items.len() as i64),
        ("len", [Value::Map(entries)]) => Value::Int(entries.len() as i64),
        ("round", [x, digits]) => {
            let digits = usize::try_from(digits.integer()?).ok().filter(|digits| *digits <= 300)?;
            match x {
                // Decimal printing rounds the exact binary value, as Python's round does.
                Value::Float(x) => Value::Float(format!("{x:.digits$}").parse().ok()?),
                x => Value::Int(x.integer()?),
            }
        }
        ("min" | "max", [Value::List(items)]) if !items.is_empty() => extreme(name == "max", items)?,
        ("min" | "max", items) if items.len() > 1 => extreme(name == "max", items)?,
        ("sum" | "fsum", [Value::List(items)]) => sum(items)?,
        ("all", [Value::List(items)]) => Value::Bool(items.iter().all(Value::truth)),
        ("any", [Value::List(items)]) => Value::Bool(items.iter().any(Value::truth)),
        ("list" | "tuple", []) => Value::List(Vec::new()),
        ("list" | "tuple", [x]) => Value::List(members(x)?),
        ("reversed", [x]) => Value::List(members(x)?.into_iter().rev().collect()),
        ("sorted", [x]) => {
            let mut items = members(x)?;
            if items.iter().all(|item| matches!(item, Value::Text(_))) {
                items.sort_by_key(ToString::to_string);
            } else {
                items.iter().all(|item| item.number().is_some()).then_some(())?;
                items.sort_by(|a, b| a.number().unwrap_or(0.0).total_cmp(&b.number().unwrap_or(0.0)));
            }
            Value::List(items)
        }
        ("range", bounds) => range(bounds)?,
        _ => return None,
    }))
}

fn members(value: &Value) -> Option<Vec<Value>> {
    match value {
        Value::List(items) => Some(items.clone()),
        Value::Map(entries) => Some(entries.iter().map(|(key, _)| key.clone()).collect()),
        Value::Text(text) => Some(text.chars().map(|c| Value::Text(c.to_string())).collect()),
        _ => None,
    }
}

fn extreme(greatest: bool, items: &[Value]) -> Option<Value> {
    let mut best = items.first()?;
    best.number()?;
    for item in &items[1..] {
        let (new, old) = (item.number()?, best.number()?);
        if (greatest && new > old) || (!greatest && new < old) {
            best = item;
        }
    }
    Some(best.clone())
}

fn sum(items: &[Value]) -> Option<Value> {
    if let Some(integers) = items.iter().map(Value::integer).collect::<Option<Vec<_>>>() {
        return integers.into_iter().try_fold(0_i64, i64::checked_add).map(Value::Int);
    }
    items.iter().map(Value::number).sum::<Option<f64>>().map(Value::Float)
}

fn range(bounds: &[Value]) -> Option<Value> {
    let bounds: Vec<_> = bounds.iter().map(Value::integer).collect::<Option<_>>()?;
    let (start, end, step) = match bounds[..] {
        [end] => (0, end, 1),
        [start, end] => (start, end, 1),
        [start, end, step] if step != 0 => (start, end, step),
        _ => return None,
    };
    let mut items = Vec::new();
    let mut at = start;
    while (step > 0 && at < end) || (step < 0 && at > end) {
        items.push(Value::Int(at));
        // As many as fit into a description; nobody writes more beams or wheels one by one.
        if items.len() > 100_000 {
            return None;
        }
        at = at.checked_add(step)?;
    }
    Some(Value::List(items))
}

/// A method of a text or a list.
pub(super) fn method(object: &Value, name: &str, arguments: &[Value]) -> Result<Value, Fault> {
    let text_list =
        |parts: Vec<&str>| Value::List(parts.into_iter().map(|s| Value::Text(s.into())).collect());
    Ok(match (object, name, arguments) {
        (Value::Text(text), "split", []) => text_list(text.split_whitespace().collect()),
        (Value::Text(text), "split", [Value::Text(by)]) if !by.is_empty() => {
            text_list(text.split(by.as_str()).collect())
        }
        (Value::Text(text), "join", [Value::List(items)]) => {
            let items: Vec<_> = items.iter().map(ToString::to_string).collect();
            sized(items.iter().map(|item| item.len() + text.len()).sum())?;
            Value::Text(items.join(text))
        }
        (Value::Text(text), "upper", []) => Value::Text(text.to_uppercase()),
        (Value::Text(text), "lower", []) => Value::Text(text.to_lowercase()),
        (Value::Text(text), "strip", []) => Value::Text(text.trim().to_owned()),
        (Value::Text(text), "startswith", [Value::Text(part)]) => {
            Value::Bool(text.starts_with(part.as_str()))
        }
        (Value::Text(text), "endswith", [Value::Text(part)]) => Value::Bool(text.ends_with(part.as_str())),
        (Value::Text(text), "replace", [Value::Text(old), Value::Text(new)]) => {
            sized(text.len() + (text.matches(old.as_str()).count() * new.len()))?;
            Value::Text(text.replace(old.as_str(), new))
        }
        (Value::Map(entries), "keys", []) => {
            Value::List(entries.iter().map(|(key, _)| key.clone()).collect())
        }
        (Value::Map(entries), "values", []) => {
            Value::List(entries.iter().map(|(_, value)| value.clone()).collect())
        }
        (Value::Map(entries), "items", []) => {
            let pair = |(key, value): &(Value, Value)| Value::List(vec![key.clone(), value.clone()]);
            Value::List(entries.iter().map(pair).collect())
        }
        (Value::Map(_), "get", [key]) => object.entry(key).cloned().unwrap_or(Value::None),
        (Value::Map(_), "get", [key, default]) => object.entry(key).unwrap_or(default).clone(),
        (Value::List(items), "index", [item]) => {
            let at = items.iter().position(|other| other.equals(item));
            Value::Int(at.ok_or_else(|| misuse("index", arguments))? as i64)
        }
        _ => {
            return Err(Fault::new(
                format!("{} has no method '{name}' for that", object.kind()),
                "texts have split, join, upper, lower, strip, startswith, endswith and replace; lists have index; dictionaries have keys, values, items and get",
            ));
        }
    })
}
