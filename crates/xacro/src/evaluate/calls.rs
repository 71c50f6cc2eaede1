//! Calls of functions, methods and lambdas, and the functions that call others: `map`, `filter`, `sorted`, `min`, `max`.

use super::comparison::order;
use super::{Evaluator, Locals};
use crate::expression::{Argument, Expression, Lambda};
use crate::fault::Fault;
use crate::functions::{self, Arguments, checked, items, misuse};
use crate::limits::sized;
use crate::value::{Function, Value};
use std::any::Any;
use std::cell::RefCell;
use std::cmp::Ordering;
use std::rc::Rc;

/// A lambda with the variables around it.
#[derive(Debug)]
struct Closure {
    lambda: Rc<Lambda>,
    /// The parameters that have defaults, which are evaluated when the lambda is created.
    defaults: Vec<(String, Value)>,
    locals: Option<Rc<Locals>>,
}

impl Evaluator<'_> {
    pub(super) fn call(&mut self, function: &Expression, arguments: &[Argument]) -> Result<Value, Fault> {
        let defined = match function {
            Expression::Attribute(object, name) if object.dotted_name().is_some() => {
                // A method is called on the object itself, without a copy.
                let object = self.defined(object)?;
                match object {
                    Some(object) => Some(self.attribute(&object, name)?),
                    None => self.defined(function)?,
                }
            }
            Expression::Name(_) => self.defined(function)?,
            other => Some(self.value(other)?),
        };
        let arguments = self.arguments(arguments)?;
        if let Some(function) = defined {
            return self.apply(&function, arguments);
        }
        let name = function.dotted_name().unwrap_or_default();
        if let Some(result) = self.names.call(&name, &arguments) {
            return result;
        }
        match functions::find(&name) {
            Some(function) => self.apply(&Value::Function(function), arguments),
            None => match functions::constant(&name) {
                Some(constant) => self.apply(&constant, arguments),
                None if name.contains('.') => Err(self.unknown_method(function, &name)),
                None => Err(functions::unknown(&name)),
            },
        }
    }

    /// Returns the fault for an unknown method, or that of the object if the object is not defined.
    fn unknown_method(&mut self, function: &Expression, name: &str) -> Fault {
        let is_space = ["math.", "python.", "xacro."].iter().any(|space| name.starts_with(space));
        match function {
            Expression::Attribute(object, _) if !is_space => {
                self.names.undefined(&object.dotted_name().unwrap_or_default())
            }
            _ => functions::unknown(name),
        }
    }

    fn arguments(&mut self, expressions: &[Argument]) -> Result<Arguments, Fault> {
        let mut arguments = Arguments::default();
        for argument in expressions {
            match argument {
                Argument::Positional(value) => arguments.positional.push(self.value(value)?),
                Argument::Keyword(name, value) => arguments.named.push((name.clone(), self.value(value)?)),
                Argument::Items(values) => {
                    let values = self.value(values)?;
                    arguments.positional.extend(items(&values, self.work)?);
                }
                Argument::Keywords(values) => {
                    let Value::Map(map) = self.value(values)? else {
                        return Err(Fault::new("'**' needs a dictionary", "write a dictionary behind it"));
                    };
                    for (name, value) in map.entries.borrow().iter() {
                        let Value::Text(name) = name else {
                            return Err(Fault::new(
                                "'**' needs a dictionary whose keys are texts",
                                "correct its keys",
                            ));
                        };
                        arguments.named.push((name.clone(), value.clone()));
                    }
                }
            }
        }
        Ok(arguments)
    }

    fn apply(&mut self, function: &Value, arguments: Arguments) -> Result<Value, Fault> {
        self.work.take(1)?;
        let Value::Function(function) = function else {
            return Err(Fault::new(
                format!("'{}' is {}, which cannot be called", function.shown(), function.kind()),
                "leave the brackets out, or name a function before them",
            ));
        };
        match function {
            Function::Builtin("map") => self.map_items(&arguments),
            Function::Builtin("filter") => self.filter_items(&arguments),
            Function::Builtin("sorted") => self.sorted(&arguments),
            Function::Builtin(name @ ("min" | "max")) => self.extreme(name, &arguments),
            Function::Builtin(name) => functions::call(name, &arguments, self.work),
            Function::Method(object, name) => match (&**object, name.as_str()) {
                (Value::List(list), "sort") => {
                    let mut sorted =
                        Arguments { named: arguments.named, positional: vec![(**object).clone()] };
                    if !arguments.positional.is_empty() {
                        sorted.positional.extend(arguments.positional);
                    }
                    let sorted = self.sorted(&sorted)?;
                    *list.items.borrow_mut() = items(&sorted, self.work)?;
                    Ok(Value::None)
                }
                (object, name) => functions::method(object, name, &arguments, self.work),
            },
            Function::Lambda(closure) => match closure.downcast_ref::<Closure>() {
                Some(closure) => self.apply_lambda(closure, arguments),
                None => Err(misuse("lambda", &[])),
            },
        }
    }

    pub(super) fn lambda(&mut self, lambda: &Rc<Lambda>) -> Result<Value, Fault> {
        let mut defaults = Vec::new();
        for (name, default) in &lambda.parameters {
            if let Some(default) = default {
                defaults.push((name.clone(), self.value(default)?));
            }
        }
        let closure = Closure { lambda: lambda.clone(), defaults, locals: self.locals.clone() };
        Ok(Value::Function(Function::Lambda(Rc::new(closure) as Rc<dyn Any>)))
    }

    fn apply_lambda(&mut self, closure: &Closure, arguments: Arguments) -> Result<Value, Fault> {
        let lambda = &closure.lambda;
        let count = lambda.parameters.len();
        let mut positional = arguments.positional;
        let rest = positional.split_off(count.min(positional.len()));
        let mut variables: Vec<(String, Value)> =
            lambda.parameters.iter().map(|(name, _)| name.clone()).zip(positional).collect();
        let fault = |what: String| Fault::new(what, "call it with one value for each of its parameters");
        match &lambda.rest {
            Some(name) => variables.push((name.clone(), Value::tuple(rest))),
            None if rest.is_empty() => {}
            None => return Err(fault(format!("a lambda of {count} parameters gets {} more", rest.len()))),
        }
        for (name, value) in arguments.named {
            let is_known = lambda.parameters.iter().any(|(known, _)| *known == name);
            if !is_known || variables.iter().any(|(known, _)| *known == name) {
                return Err(fault(format!("a lambda has no parameter '{name}'")));
            }
            variables.push((name, value));
        }
        for (name, _) in &lambda.parameters {
            if !variables.iter().any(|(known, _)| known == name) {
                let default = closure.defaults.iter().find(|(known, _)| known == name);
                let default = default.ok_or_else(|| fault(format!("a lambda gets no value for '{name}'")))?;
                variables.push(default.clone());
            }
        }
        self.names.enter(lambda.levels)?;
        let locals = Locals { variables: RefCell::new(variables), around: closure.locals.clone() };
        let around = self.locals.replace(Rc::new(locals));
        let result = self.value(&lambda.body);
        self.locals = around;
        self.names.leave(lambda.levels);
        result
    }

    fn apply_to(&mut self, function: &Value, values: Vec<Value>) -> Result<Value, Fault> {
        self.apply(function, Arguments { positional: values, named: Vec::new() })
    }

    fn map_items(&mut self, arguments: &Arguments) -> Result<Value, Fault> {
        let [function, sequences @ ..] = arguments.unnamed("map")? else { return Err(misuse("map", &[])) };
        let mut columns = Vec::new();
        for sequence in sequences {
            columns.push(items(sequence, self.work)?.into_iter());
        }
        let rows = columns.iter().map(ExactSizeIterator::len).min();
        let rows = rows.ok_or_else(|| misuse("map", &arguments.positional))?;
        let (mut made, mut size) = (Vec::new(), 0);
        for _ in 0..rows {
            let row = columns.iter_mut().filter_map(Iterator::next).collect();
            match self.apply_to(function, row) {
                Ok(value) => {
                    size = sized(value.size().saturating_add(size))?;
                    made.push(value);
                }
                Err(fault) => return Ok(Value::iterator("map", made, Some(fault))),
            }
        }
        Ok(Value::iterator("map", made, None))
    }

    fn filter_items(&mut self, arguments: &Arguments) -> Result<Value, Fault> {
        let [function, sequence] = arguments.unnamed("filter")? else {
            return Err(misuse("filter", &arguments.positional));
        };
        let mut kept = Vec::new();
        for item in items(sequence, self.work)? {
            let passes = match function {
                Value::None => Ok(item.truth()),
                function => self.apply_to(function, vec![item.clone()]).map(|value| value.truth()),
            };
            match passes {
                Ok(true) => kept.push(item),
                Ok(false) => {}
                Err(fault) => return Ok(Value::iterator("filter", kept, Some(fault))),
            }
        }
        checked(Value::iterator("filter", kept, None), self.work)
    }

    /// Takes `key` and one other argument from the named arguments.
    fn named<'a>(
        arguments: &'a Arguments,
        function: &str,
        other: &str,
    ) -> Result<(Option<&'a Value>, Option<&'a Value>), Fault> {
        let (mut key, mut found) = (None, None);
        for (name, value) in &arguments.named {
            match name.as_str() {
                "key" => key = Some(value).filter(|value| !matches!(value, Value::None)),
                name if name == other => found = Some(value),
                _ => return Err(misuse(function, &arguments.positional)),
            }
        }
        Ok((key, found))
    }

    /// Returns the items with the values by which they are compared.
    fn keyed(&mut self, items: Vec<Value>, key: Option<&Value>) -> Result<Vec<(Value, Value)>, Fault> {
        let mut keyed = Vec::with_capacity(items.len());
        for item in items {
            let by = match key {
                Some(key) => self.apply_to(key, vec![item.clone()])?,
                None => item.clone(),
            };
            keyed.push((by, item));
        }
        Ok(keyed)
    }

    fn sorted(&mut self, arguments: &Arguments) -> Result<Value, Fault> {
        let [sequence] = &arguments.positional[..] else {
            return Err(misuse("sorted", &arguments.positional));
        };
        let (key, reverse) = Self::named(arguments, "sorted", "reverse")?;
        let is_reverse = reverse.is_some_and(Value::truth);
        let all = functions::items_in_any_order(sequence, self.work)?;
        let mut keyed = self.keyed(all, key)?;
        self.work.take(keyed.len() * 4)?;
        keyed = merge_sorted(keyed, &|a, b| {
            let (a, b) = if is_reverse { (b, a) } else { (a, b) };
            Ok(order(&a.0, &b.0)?.ok_or_else(not_sorted)? == Ordering::Less)
        })?;
        checked(Value::list(keyed.into_iter().map(|(_, item)| item).collect()), self.work)
    }

    fn extreme(&mut self, name: &str, arguments: &Arguments) -> Result<Value, Fault> {
        let (key, default) = Self::named(arguments, name, "default")?;
        let all = match &arguments.positional[..] {
            [sequence] => functions::items_in_any_order(sequence, self.work)?,
            several if default.is_none() => several.to_vec(),
            _ => return Err(misuse(name, &arguments.positional)),
        };
        let wanted = if name == "max" { Ordering::Greater } else { Ordering::Less };
        let mut best: Option<(Value, Value)> = None;
        for (by, item) in self.keyed(all, key)? {
            let is_better = match &best {
                None => true,
                Some((best, _)) => order(&by, best)? == Some(wanted),
            };
            if is_better {
                best = Some((by, item));
            }
        }
        let best = best.map(|(_, item)| item).or_else(|| default.cloned());
        best.ok_or_else(|| misuse(name, &arguments.positional))
    }
}

fn not_sorted() -> Fault {
    Fault::new("nan and sets have no order to sort by", "leave them out")
}

/// Sorts items, keeping the order of equal ones. The standard library's sort may panic if the order is inconsistent.
fn merge_sorted<T>(
    mut items: Vec<T>,
    is_less: &dyn Fn(&T, &T) -> Result<bool, Fault>,
) -> Result<Vec<T>, Fault> {
    if items.len() < 2 {
        return Ok(items);
    }
    let right = items.split_off(items.len() / 2);
    let mut left = merge_sorted(items, is_less)?.into_iter().peekable();
    let mut right = merge_sorted(right, is_less)?.into_iter().peekable();
    let mut merged = Vec::with_capacity(left.len() + right.len());
    while let (Some(a), Some(b)) = (left.peek(), right.peek()) {
        merged.extend(if is_less(b, a)? { right.next() } else { left.next() });
    }
    merged.extend(left);
    merged.extend(right);
    Ok(merged)
}
