//! Evaluates a parsed expression with Python's rules.

mod calls;
mod comparison;
mod comprehension;
mod subscript;

use super::expression::{Expression, Unary};
use super::fault::Fault;
use super::functions::{self, Arguments, arithmetic, checked, items, key};
use super::limits::{Work, sized};
use super::value::{Entries, Function, Value};
use std::cell::RefCell;
use std::rc::Rc;

/// Resolves the names of an expression.
pub(super) trait Names {
    /// Returns the property with this name, if there is one.
    fn get(&mut self, name: &str) -> Result<Option<Value>, Fault>;
    /// Calls a function that is not one of Python's, if there is one with this name.
    fn call(&mut self, function: &str, arguments: &Arguments) -> Option<Result<Value, Fault>>;
    /// Returns the fault to report for a name that is not defined.
    fn undefined(&self, name: &str) -> Fault;
    /// Enters a number of levels of expressions that are evaluated within each other.
    fn enter(&mut self, levels: usize) -> Result<(), Fault>;
    /// Leaves levels that were entered.
    fn leave(&mut self, levels: usize);
}

/// Evaluates `expression`; names are looked up in `names`, then among the constants and functions.
pub(super) fn evaluate(expression: &Expression, names: &mut dyn Names, work: &Work) -> Result<Value, Fault> {
    let levels = expression.levels();
    names.enter(levels)?;
    let result = Evaluator { names, work, locals: None }.value(expression);
    names.leave(levels);
    result
}

/// The variables of a comprehension or of the call of a lambda, and those around it.
#[derive(Debug)]
struct Locals {
    variables: RefCell<Vec<(String, Value)>>,
    around: Option<Rc<Locals>>,
}

impl Locals {
    fn get(&self, name: &str) -> Option<Value> {
        let found =
            self.variables.borrow().iter().find(|(known, _)| known == name).map(|(_, value)| value.clone());
        found.or_else(|| self.around.as_ref()?.get(name))
    }

    fn set(&self, name: &str, value: Value) {
        let mut variables = self.variables.borrow_mut();
        match variables.iter_mut().find(|(known, _)| known == name) {
            Some((_, old)) => *old = value,
            None => variables.push((name.to_owned(), value)),
        }
    }
}

/// Evaluates expressions. Each kind has its own method, so that the frames on the stack stay small.
struct Evaluator<'a> {
    names: &'a mut dyn Names,
    work: &'a Work,
    locals: Option<Rc<Locals>>,
}

impl Evaluator<'_> {
    fn value(&mut self, expression: &Expression) -> Result<Value, Fault> {
        self.work.take(1)?;
        match expression {
            Expression::Literal(value) => Ok(value.clone()),
            Expression::Name(_) | Expression::Attribute(..) => self.name(expression),
            Expression::List(items) => {
                self.display(items).and_then(|items| checked(Value::list(items), self.work))
            }
            Expression::Tuple(items) => {
                self.display(items).and_then(|items| checked(Value::tuple(items), self.work))
            }
            Expression::Set(items) => self.display(items).and_then(set),
            Expression::Map(entries) => self.map(entries),
            Expression::Star(_) => Err(Fault::new("'*' stands alone", "use it inside a list or a call")),
            Expression::Unary(operator, operand) => self.unary(*operator, operand),
            Expression::And(left, right) => self.either(left, right, false),
            Expression::Or(left, right) => self.either(left, right, true),
            Expression::Arithmetic(operator, left, right) => {
                let (left, right) = self.both(left, right)?;
                arithmetic::binary(*operator, &left, &right, self.work)
            }
            Expression::Compare(first, others) => self.compare(first, others),
            Expression::Ternary { condition, yes, no } => {
                let branch = if self.truth(condition)? { yes } else { no };
                self.value(branch)
            }
            Expression::Index(operand, index) => {
                let (operand, index) = self.both(operand, index)?;
                subscript::item(&operand, &index, self.work)
            }
            Expression::Slice(operand, bounds) => self.slice(operand, bounds),
            Expression::Call(function, arguments) => self.call(function, arguments),
            Expression::Comprehension(comprehension) => self.comprehension(comprehension),
            Expression::Lambda(lambda) => self.lambda(lambda),
        }
    }

    fn truth(&mut self, expression: &Expression) -> Result<bool, Fault> {
        self.value(expression).map(|value| value.truth())
    }

    fn both(&mut self, left: &Expression, right: &Expression) -> Result<(Value, Value), Fault> {
        Ok((self.value(left)?, self.value(right)?))
    }

    fn unary(&mut self, operator: Unary, operand: &Expression) -> Result<Value, Fault> {
        arithmetic::unary(operator, &self.value(operand)?)
    }

    /// Returns the left value if it decides the result, otherwise the right one.
    fn either(&mut self, left: &Expression, right: &Expression, decides: bool) -> Result<Value, Fault> {
        let left = self.value(left)?;
        if left.truth() == decides { Ok(left) } else { self.value(right) }
    }

    fn display(&mut self, expressions: &[Expression]) -> Result<Vec<Value>, Fault> {
        let mut size = 0;
        let mut values = Vec::with_capacity(expressions.len());
        for expression in expressions {
            let more = match expression {
                Expression::Star(inner) => items(&self.value(inner)?, self.work)?,
                one => vec![self.value(one)?],
            };
            for value in more {
                size = sized(value.size().saturating_add(size))?;
                values.push(value);
            }
        }
        Ok(values)
    }

    fn map(&mut self, parts: &[(Option<Expression>, Expression)]) -> Result<Value, Fault> {
        let mut entries = Entries::default();
        for (name, value) in parts {
            if let Some(name) = name {
                let (name, value) = self.both(name, value)?;
                entries.insert(key(&name)?, name, value);
                continue;
            }
            let Value::Map(more) = self.value(value)? else {
                return Err(Fault::new("'**' needs a dictionary", "write a dictionary behind it"));
            };
            for (name, value) in more.entries.borrow().iter() {
                entries.insert(key(name)?, name.clone(), value.clone());
            }
        }
        checked(Value::map(entries), self.work)
    }

    /// Evaluates a name, or a chain of names: a variable, a property of a namespace, a constant or a function, and from
    /// there the attributes of its value.
    fn name(&mut self, expression: &Expression) -> Result<Value, Fault> {
        if let Some(value) = self.defined(expression)? {
            return Ok(value);
        }
        if let Some(name) = expression.dotted_name() {
            if let Some(value) = functions::constant(&name) {
                return Ok(value);
            }
            if let Some(function) = functions::find(&name) {
                return Ok(Value::Function(function));
            }
            return Err(self.names.undefined(&name));
        }
        let Expression::Attribute(object, name) = expression else {
            return Err(Fault::new("a name is missing", "write one"));
        };
        let object = self.value(object)?;
        self.attribute(&object, name)
    }

    /// Evaluates a name, or a chain of names, whose first one is a variable or a property, or a namespace of properties.
    fn defined(&mut self, expression: &Expression) -> Result<Option<Value>, Fault> {
        match expression {
            Expression::Name(name) => {
                if let Some(value) = self.locals.as_ref().and_then(|locals| locals.get(name)) {
                    return Ok(Some(value));
                }
                let value = self.names.get(name)?;
                // A text is copied.
                self.work.take(value.as_ref().and_then(Value::as_text).map_or(0, str::len) / 64)?;
                Ok(value)
            }
            Expression::Attribute(object, name) => {
                if object.dotted_name().is_none() {
                    return Ok(None);
                }
                if let Some(object) = self.defined(object)? {
                    return self.attribute(&object, name).map(Some);
                }
                match expression.dotted_name() {
                    Some(name) => self.names.get(&name),
                    None => Ok(None),
                }
            }
            _ => Ok(None),
        }
    }

    /// Returns `object.name`: a method, or an entry of a dictionary from YAML.
    fn attribute(&self, object: &Value, name: &str) -> Result<Value, Fault> {
        if functions::has_method(object, name) {
            return Ok(Value::Function(Function::Method(Box::new(object.clone()), name.to_owned())));
        }
        match object {
            Value::Map(map) if map.dotted => subscript::item(object, &Value::text(name), self.work),
            Value::Map(_) => Err(Fault::new(
                format!(
                    "the dictionary has no attribute '{name}': only dictionaries of YAML files have their keys as attributes"
                ),
                format!("write ['{name}'], or xacro.dotify(…) around the dictionary"),
            )),
            _ => Err(Fault::new(
                format!("'{}' is {}, which has no '{name}'", object.shown(), object.kind()),
                "correct the name after the dot",
            )),
        }
    }
}

fn set(items: Vec<Value>) -> Result<Value, Fault> {
    functions::set_of(items)
}

#[cfg(test)]
mod tests;
