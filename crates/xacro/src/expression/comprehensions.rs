//! `for … in … if …` after the element of a comprehension.

use super::super::fault::Fault;
use super::parser::Parser;
use super::{Clause, Collection, Comprehension, Expression, Target};
use std::rc::Rc;

impl Parser<'_> {
    pub(super) fn comprehension(
        &mut self,
        kind: Collection,
        key: Option<Expression>,
        element: Expression,
    ) -> Result<Expression, Fault> {
        if matches!(element, Expression::Star(_)) {
            return Err(self.unexpected("'*'"));
        }
        let mut clauses = Vec::new();
        while self.take_word("for") {
            let target = self.targets()?;
            if !self.take_word("in") {
                return Err(self.error("'for' without 'in'"));
            }
            let items = self.or()?;
            let mut conditions = Vec::new();
            while self.take_word("if") {
                conditions.push(self.or()?);
            }
            clauses.push(Clause { target, items, conditions });
        }
        Ok(Expression::Comprehension(Rc::new(Comprehension { kind, element, key, clauses })))
    }

    /// Reads `a`, or `a, b`.
    fn targets(&mut self) -> Result<Target, Fault> {
        let first = self.target()?;
        if !self.is_at(",") {
            return Ok(first);
        }
        let mut targets = vec![first];
        while self.take_symbol(",") && !self.is_at_word("in") && !self.is_at(")") && !self.is_at("]") {
            targets.push(self.target()?);
        }
        Ok(Target::Tuple(targets))
    }

    fn target(&mut self) -> Result<Target, Fault> {
        if let Some(name) = self.take_name() {
            return Ok(Target::Name(name));
        }
        let close = if self.take_symbol("(") {
            ")"
        } else if self.take_symbol("[") {
            "]"
        } else {
            return Err(self.error("a name is missing after 'for'"));
        };
        let inside = self.targets()?;
        self.expect(close)?;
        Ok(inside)
    }
}
