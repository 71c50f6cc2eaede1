//! Evaluates a parsed expression with Python's rules.

use super::expression::{Arithmetic, Comparison, Expression};
use super::fault::Fault;
use super::functions;
use super::limits::{sized, too_large};
use super::value::Value;
use crate::suggestion::did_you_mean;

/// Where an expression finds its names.
pub(super) trait Names {
    /// The property of that name, if there is one.
    fn get(&mut self, name: &str) -> Result<Option<Value>, Fault>;
    /// A function that is not one of Python's, if there is one of that name.
    fn call(&mut self, function: &str, arguments: &[Value]) -> Option<Result<Value, Fault>>;
    /// The fault to report for a name that is not defined.
    fn undefined(&self, name: &str) -> Fault;
}

/// Evaluates `expression`; names are looked up in `names`, then among the constants.
pub(super) fn evaluate(expression: &Expression, names: &mut dyn Names) -> Result<Value, Fault> {
    Ok(match expression {
        Expression::Literal(value) => value.clone(),
        Expression::Name(name) => match names.get(name)? {
            Some(value) => value,
            None => match functions::constant(name) {
                Some(constant) => constant,
                None => attribute(name, names)?,
            },
        },
        Expression::List(items) => Value::List(all(items, names)?),
        Expression::Negate(operand) => match evaluate(operand, names)? {
            Value::Float(value) => Value::Float(-value),
            value => match value.integer() {
                Some(int) => Value::Int(int.checked_neg().ok_or_else(too_large)?),
                None => return Err(operand_fault("-", &value)),
            },
        },
        Expression::Plus(operand) => match evaluate(operand, names)? {
            value @ Value::Float(_) => value,
            value => Value::Int(value.integer().ok_or_else(|| operand_fault("+", &value))?),
        },
        Expression::Not(operand) => Value::Bool(!evaluate(operand, names)?.truth()),
        Expression::And(left, right) => {
            let left = evaluate(left, names)?;
            if left.truth() { evaluate(right, names)? } else { left }
        }
        Expression::Or(left, right) => {
            let left = evaluate(left, names)?;
            if left.truth() { left } else { evaluate(right, names)? }
        }
        Expression::Arithmetic(operator, left, right) => {
            arithmetic(*operator, &evaluate(left, names)?, &evaluate(right, names)?)?
        }
        Expression::Compare(first, others) => {
            let mut left = evaluate(first, names)?;
            for (comparison, right) in others {
                let right = evaluate(right, names)?;
                if !compare(*comparison, &left, &right)? {
                    return Ok(Value::Bool(false));
                }
                left = right;
            }
            Value::Bool(true)
        }
        Expression::Ternary { condition, yes, no } => {
            evaluate(if evaluate(condition, names)?.truth() { yes } else { no }, names)?
        }
        Expression::Index(operand, index) => {
            let (operand, index) = (evaluate(operand, names)?, evaluate(index, names)?);
            item(&operand, &index)?
        }
        Expression::Slice(operand, start, end) => {
            let operand = evaluate(operand, names)?;
            let mut bound = |bound: &Option<Box<Expression>>| match bound {
                Some(bound) => evaluate(bound, names).map(Some),
                None => Ok(None),
            };
            let (start, end) = (bound(start)?, bound(end)?);
            slice(&operand, start.as_ref(), end.as_ref())?
        }
        Expression::Call(name, arguments) => {
            let arguments = all(arguments, names)?;
            if let Some(result) = names.call(name, &arguments) {
                return result;
            }
            if let Some(result) = functions::call(name, &arguments) {
                return result;
            }
            // `words.split()`: the name ends in a method of what stands before it.
            match name.rsplit_once('.') {
                Some((object, method)) => {
                    let object = match names.get(object)? {
                        Some(object) => object,
                        None => attribute(object, names)?,
                    };
                    functions::method(&object, method, &arguments)?
                }
                None => return Err(functions::unknown(name)),
            }
        }
        Expression::Method(object, method, arguments) => {
            let object = evaluate(object, names)?;
            functions::method(&object, method, &all(arguments, names)?)?
        }
    })
}

fn all(expressions: &[Expression], names: &mut dyn Names) -> Result<Vec<Value>, Fault> {
    let mut size = 0;
    let value = |expression| {
        let value = evaluate(expression, names)?;
        size = sized(size + value.size())?;
        Ok(value)
    };
    expressions.iter().map(value).collect()
}

/// `config.joint.lower`: an entry of a dictionary, its key written behind a dot.
fn attribute(name: &str, names: &mut dyn Names) -> Result<Value, Fault> {
    let Some((object, key)) = name.rsplit_once('.') else { return Err(names.undefined(name)) };
    let object = match names.get(object)? {
        Some(object) => object,
        None => attribute(object, names).map_err(|_| names.undefined(name))?,
    };
    match &object {
        Value::Map(_) => item(&object, &Value::Text(key.to_owned())),
        _ => Err(names.undefined(name)),
    }
}

fn operand_fault(operator: &str, value: &Value) -> Fault {
    Fault::new(
        format!("'{operator}' cannot be applied to {} ('{value}')", value.kind()),
        "use a number there",
    )
}

fn arithmetic(operator: Arithmetic, left: &Value, right: &Value) -> Result<Value, Fault> {
    // Texts and lists know + and *.
    match (operator, left, right) {
        (Arithmetic::Add, Value::Text(a), Value::Text(b)) => {
            sized(a.len() + b.len())?;
            return Ok(Value::Text(format!("{a}{b}")));
        }
        (Arithmetic::Add, Value::List(a), Value::List(b)) => {
            sized(left.size() + right.size())?;
            return Ok(Value::List(a.iter().chain(b).cloned().collect()));
        }
        (Arithmetic::Multiply, Value::Text(text), count)
        | (Arithmetic::Multiply, count, Value::Text(text))
            if count.integer().is_some() =>
        {
            let count = repetitions(count, text.len())?;
            return Ok(Value::Text(text.repeat(count)));
        }
        (Arithmetic::Multiply, Value::List(list), count)
        | (Arithmetic::Multiply, count, Value::List(list))
            if count.integer().is_some() =>
        {
            let count = repetitions(count, list.iter().map(Value::size).sum())?;
            return Ok(Value::List(std::iter::repeat_n(list, count).flatten().cloned().collect()));
        }
        _ => {}
    }
    if let (Some(a), Some(b)) = (left.integer(), right.integer())
        && let Some(result) = integer_arithmetic(operator, a, b)?
    {
        return Ok(result);
    }
    let symbol = match operator {
        Arithmetic::Add => "+",
        Arithmetic::Subtract => "-",
        Arithmetic::Multiply => "*",
        Arithmetic::Divide => "/",
        Arithmetic::FloorDivide => "//",
        Arithmetic::Remainder => "%",
        Arithmetic::Power => "**",
    };
    let (Some(a), Some(b)) = (left.number(), right.number()) else {
        return Err(Fault::new(
            format!("'{left}' {symbol} '{right}': {} and {} do not go together", left.kind(), right.kind()),
            "use numbers on both sides, or str(…) to join texts",
        ));
    };
    let divides = matches!(operator, Arithmetic::Divide | Arithmetic::FloorDivide | Arithmetic::Remainder);
    if divides && b == 0.0 {
        return Err(Fault::new(format!("{left} {symbol} {right}: division by zero"), "correct the divisor"));
    }
    Ok(Value::Float(match operator {
        Arithmetic::Add => a + b,
        Arithmetic::Subtract => a - b,
        Arithmetic::Multiply => a * b,
        Arithmetic::Divide => a / b,
        Arithmetic::FloorDivide => (a / b).floor(),
        Arithmetic::Remainder => {
            // The sign is the divisor's.
            let remainder = a % b;
            if remainder != 0.0 && (remainder < 0.0) != (b < 0.0) { remainder + b } else { remainder }
        }
        Arithmetic::Power => {
            let power = libm::pow(a, b);
            if power.is_nan() && !a.is_nan() && !b.is_nan() {
                return Err(Fault::new(
                    format!("{left} ** {right} is not a real number"),
                    "correct the base",
                ));
            }
            power
        }
    }))
}

fn repetitions(count: &Value, length: usize) -> Result<usize, Fault> {
    let count = usize::try_from(count.integer().unwrap_or(0).max(0)).unwrap_or(usize::MAX);
    sized(count.saturating_mul(length)).map(|_| count)
}

/// None where integers give a float: `/`, and negative powers.
fn integer_arithmetic(operator: Arithmetic, a: i64, b: i64) -> Result<Option<Value>, Fault> {
    let result = match operator {
        Arithmetic::Add => a.checked_add(b),
        Arithmetic::Subtract => a.checked_sub(b),
        Arithmetic::Multiply => a.checked_mul(b),
        Arithmetic::FloorDivide if b != 0 => a.checked_div_euclid(b).map(|quotient| {
            // Euclidean division rounds towards the positive remainder, Python's down.
            if b < 0 && a.wrapping_rem_euclid(b) != 0 { quotient - 1 } else { quotient }
        }),
        Arithmetic::Remainder if b != 0 => {
            let remainder = a.wrapping_rem_euclid(b);
            Some(if b < 0 && remainder != 0 { remainder + b } else { remainder })
        }
        Arithmetic::Power if b >= 0 => u32::try_from(b).ok().and_then(|b| a.checked_pow(b)),
        _ => return Ok(None),
    };
    result.map(|int| Some(Value::Int(int))).ok_or_else(too_large)
}

fn compare(comparison: Comparison, left: &Value, right: &Value) -> Result<bool, Fault> {
    use std::cmp::Ordering;
    let ordering = || match (left, right) {
        (Value::Text(a), Value::Text(b)) => Ok(Some(a.cmp(b))),
        _ => match (left.number(), right.number()) {
            (Some(a), Some(b)) => Ok(a.partial_cmp(&b)),
            _ => Err(Fault::new(
                format!("'{left}' and '{right}' have no order: {} and {}", left.kind(), right.kind()),
                "compare numbers with numbers and texts with texts",
            )),
        },
    };
    Ok(match comparison {
        Comparison::Equal => left.equals(right),
        Comparison::NotEqual => !left.equals(right),
        Comparison::Less => ordering()? == Some(Ordering::Less),
        Comparison::Greater => ordering()? == Some(Ordering::Greater),
        Comparison::LessOrEqual => matches!(ordering()?, Some(Ordering::Less | Ordering::Equal)),
        Comparison::GreaterOrEqual => matches!(ordering()?, Some(Ordering::Greater | Ordering::Equal)),
        Comparison::In => contains(right, left)?,
        Comparison::NotIn => !contains(right, left)?,
    })
}

fn contains(container: &Value, value: &Value) -> Result<bool, Fault> {
    match (container, value) {
        (Value::List(items), _) => Ok(items.iter().any(|item| item.equals(value))),
        (Value::Map(_), _) => Ok(container.entry(value).is_some()),
        (Value::Text(text), Value::Text(part)) => Ok(text.contains(part.as_str())),
        _ => Err(Fault::new(
            format!("'{value}' in '{container}': {} has no members of that kind", container.kind()),
            "write a list or a text behind 'in'",
        )),
    }
}

/// The position that a possibly negative index means.
fn position(index: i64, length: usize) -> i64 {
    if index < 0 { index.saturating_add(length as i64) } else { index }
}

fn item(operand: &Value, index: &Value) -> Result<Value, Fault> {
    if let Value::Map(entries) = operand {
        return operand.entry(index).cloned().ok_or_else(|| {
            let known: Vec<String> = entries.iter().map(|(key, _)| key.to_string()).collect();
            let meant = did_you_mean(&index.to_string(), known.iter().map(String::as_str));
            let remedy = meant.unwrap_or_else(|| format!("it has {}", known.join(", ")));
            Fault::new(format!("the dictionary has no '{index}'"), remedy)
        });
    }
    let at = index.integer().ok_or_else(|| operand_fault("[ ]", index))?;
    let found = match operand {
        Value::List(items) => {
            usize::try_from(position(at, items.len())).ok().and_then(|at| items.get(at)).cloned()
        }
        Value::Text(text) => usize::try_from(position(at, text.chars().count()))
            .ok()
            .and_then(|at| text.chars().nth(at))
            .map(|c| Value::Text(c.to_string())),
        other => return Err(operand_fault("[ ]", other)),
    };
    found.ok_or_else(|| Fault::new(format!("index {at} is outside of '{operand}'"), "correct the index"))
}

fn slice(operand: &Value, start: Option<&Value>, end: Option<&Value>) -> Result<Value, Fault> {
    let range = |length: usize| -> Result<(usize, usize), Fault> {
        let bound = |value: Option<&Value>, default: usize| -> Result<usize, Fault> {
            match value {
                None => Ok(default),
                Some(value) => {
                    let at = value.integer().ok_or_else(|| operand_fault("[:]", value))?;
                    Ok(position(at, length).clamp(0, length as i64) as usize)
                }
            }
        };
        let start = bound(start, 0)?;
        Ok((start, bound(end, length)?.max(start)))
    };
    match operand {
        Value::List(items) => {
            let (start, end) = range(items.len())?;
            Ok(Value::List(items[start..end].to_vec()))
        }
        Value::Text(text) => {
            let (start, end) = range(text.chars().count())?;
            Ok(Value::Text(text.chars().skip(start).take(end - start).collect()))
        }
        other => Err(operand_fault("[:]", other)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expression::parse;

    struct Table;

    impl Names for Table {
        fn get(&mut self, name: &str) -> Result<Option<Value>, Fault> {
            Ok(match name {
                "x" => Some(Value::Int(7)),
                "words" => Some(Value::Text("a b c".into())),
                _ => None,
            })
        }
        fn call(&mut self, _: &str, _: &[Value]) -> Option<Result<Value, Fault>> {
            None
        }
        fn undefined(&self, name: &str) -> Fault {
            Fault::new(format!("undefined property '{name}'"), "")
        }
    }

    fn eval(text: &str) -> String {
        match parse(text).and_then(|expression| evaluate(&expression, &mut Table)) {
            Ok(value) => value.to_string(),
            Err(fault) => format!("error: {}", fault.what),
        }
    }

    #[test]
    fn agrees_with_python() {
        // The right-hand sides were printed by CPython 3.11.
        for (text, printed) in [
            ("60.0*M_PI/180.0", "1.0471975511965976"),
            ("-M_PI/2", "-1.5707963267948966"),
            ("0.23/2", "0.115"),
            ("7/2", "3.5"),
            ("7//2", "3"),
            ("-7//2", "-4"),
            ("7//-2", "-4"),
            ("-7//-2", "3"),
            ("-7 % 3", "2"),
            ("7 % -3", "-2"),
            ("-7.5 % 2", "0.5"),
            ("2**10", "1024"),
            ("2**-1", "0.5"),
            ("-2**2", "-4"),
            ("2**3**2", "512"),
            ("1 < 2 < 3", "True"),
            ("1 < 2 > 5", "False"),
            ("'a' in 'cat' and not 'x' in 'cat'", "True"),
            ("2 not in [1, 2]", "False"),
            ("'yes' if x > 5 else 'no'", "yes"),
            ("x and 0 or 'fallback'", "fallback"),
            ("1 == 1.0 == True", "True"),
            ("'1' == 1", "False"),
            ("[1, 2.0, 'a'][1:]", "[2.0, 'a']"),
            ("words.split()[-1]", "c"),
            ("'a' + str(x) + \"b\"", "a7b"),
            ("3 * 'ab'", "ababab"),
            ("round(2.5)", "2"),
            ("round(2.675, 2)", "2.67"),
            ("max(1, 2.5, 2)", "2.5"),
            ("min([3, 1, 2])", "1"),
            ("abs(-3)", "3"),
            ("int(-2.7)", "-2"),
            ("len('abc') * 1e-7", "3e-07"),
            ("radians(180) == pi", "True"),
            ("math.sqrt(2)", "1.4142135623730951"),
            ("atan2(1, 1)*4", "3.141592653589793"),
            ("sum(range(5))", "10"),
            ("(1, 2)", "[1, 2]"),
            ("not not 0", "False"),
            (".5 + 1.", "1.5"),
        ] {
            assert_eq!(eval(text), printed, "{text}");
        }
    }

    #[test]
    fn faults_are_told() {
        for (text, error) in [
            ("y", "undefined property 'y'"),
            ("1/0", "division by zero"),
            ("1 +", "ends too early"),
            ("(1", "')' is missing"),
            ("é §", "has no meaning"),
            ("'a' + 1", "do not go together"),
            ("foo(1)", "unknown function 'foo'"),
            ("9223372036854775807 + 1", "64 bits"),
            ("[1][4]", "outside"),
            ("'a' < 1", "no order"),
            ("", "ends too early"),
            ("1 2", "not expected"),
            ("sqrt(-1)", "sqrt(-1)"),
        ] {
            let result = eval(text);
            assert!(result.starts_with("error:") && result.contains(error), "{text}: {result}");
        }
        let deep = "(".repeat(100_000);
        assert!(eval(&deep).contains("error"));
        assert!(eval(&"1+".repeat(100_000)).contains("error"));
        assert!(eval(&"-".repeat(900)).contains("error"));
    }
}
