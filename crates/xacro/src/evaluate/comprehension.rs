//! Comprehensions. A generator is computed at once; the fault of an item is kept until that item is requested.

use super::{Evaluator, Locals};
use crate::expression::{Clause, Collection, Comprehension, Target};
use crate::fault::Fault;
use crate::functions::{checked, items, key, set_of};
use crate::limits::sized;
use crate::value::{Entries, Value};
use std::cell::RefCell;
use std::rc::Rc;

/// The items so far, with their keys for a dictionary.
#[derive(Default)]
struct Made {
    items: Vec<Value>,
    keys: Vec<Value>,
    size: usize,
}

impl Evaluator<'_> {
    pub(super) fn comprehension(&mut self, comprehension: &Comprehension) -> Result<Value, Fault> {
        let [first, rest @ ..] = &comprehension.clauses[..] else {
            return Err(Fault::new("a comprehension has no 'for'", "write one"));
        };
        // The first list is evaluated outside, so that its fault is not treated as that of an item.
        let outer = items(&self.value(&first.items)?, self.work)?;
        let around = self.locals.take();
        self.locals = Some(Rc::new(Locals { variables: RefCell::default(), around: around.clone() }));
        let mut made = Made::default();
        let result = self.clause(comprehension, first, outer, rest, &mut made);
        self.locals = around;
        match (comprehension.kind, result) {
            (Collection::Generator, result) => Ok(Value::iterator("generator", made.items, result.err())),
            (_, Err(fault)) => Err(fault),
            (Collection::List, Ok(())) => checked(Value::list(made.items), self.work),
            (Collection::Set, Ok(())) => set_of(made.items),
            (Collection::Map, Ok(())) => {
                let mut entries = Entries::default();
                for (name, value) in made.keys.into_iter().zip(made.items) {
                    entries.insert(key(&name)?, name, value);
                }
                checked(Value::map(entries), self.work)
            }
        }
    }

    fn clause(
        &mut self,
        comprehension: &Comprehension,
        clause: &Clause,
        values: Vec<Value>,
        rest: &[Clause],
        made: &mut Made,
    ) -> Result<(), Fault> {
        'items: for value in values {
            self.assign(&clause.target, value)?;
            for condition in &clause.conditions {
                if !self.truth(condition)? {
                    continue 'items;
                }
            }
            match rest {
                [] => self.element(comprehension, made)?,
                [next, rest @ ..] => {
                    let values = items(&self.value(&next.items)?, self.work)?;
                    self.clause(comprehension, next, values, rest, made)?;
                }
            }
        }
        Ok(())
    }

    fn element(&mut self, comprehension: &Comprehension, made: &mut Made) -> Result<(), Fault> {
        if let Some(key) = &comprehension.key {
            let key = self.value(key)?;
            made.size = sized(key.size().saturating_add(made.size))?;
            made.keys.push(key);
        }
        let value = self.value(&comprehension.element)?;
        made.size = sized(value.size().saturating_add(made.size))?;
        made.items.push(value);
        Ok(())
    }

    fn assign(&mut self, target: &Target, value: Value) -> Result<(), Fault> {
        match target {
            Target::Name(name) => {
                if let Some(locals) = &self.locals {
                    locals.set(name, value);
                }
                Ok(())
            }
            Target::Tuple(targets) => {
                let parts = items(&value, self.work)?;
                if parts.len() != targets.len() {
                    return Err(Fault::new(
                        format!(
                            "'{}' has {} parts, not the {} of 'for'",
                            value.shown(),
                            parts.len(),
                            targets.len()
                        ),
                        "write as many names as there are parts",
                    ));
                }
                targets.iter().zip(parts).try_for_each(|(target, part)| self.assign(target, part))
            }
        }
    }
}
