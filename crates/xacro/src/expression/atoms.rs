//! Literals, names, displays in brackets, and the arguments of calls.

use super::super::fault::Fault;
use super::super::value::Value;
use super::parser::Parser;
use super::tokens::Token;
use super::{Argument, Collection, Expression};

impl Parser<'_> {
    pub(super) fn atom(&mut self) -> Result<Expression, Fault> {
        if let Some(name) = self.take_name() {
            return Ok(Expression::Name(name));
        }
        match self.take() {
            None => Err(self.error("it ends too early")),
            Some(Token::Literal(Value::Text(mut text))) => {
                // Adjacent texts are joined, as in Python.
                while let Some(Token::Literal(Value::Text(more))) = self.peek() {
                    text.push_str(more);
                    self.take();
                }
                Ok(Expression::Literal(Value::Text(text)))
            }
            Some(Token::Literal(value)) => Ok(Expression::Literal(value)),
            Some(Token::Symbol("(")) => self.in_parentheses(),
            Some(Token::Symbol("[")) => self.list(),
            Some(Token::Symbol("{")) => self.map_or_set(),
            Some(token) => Err(self.unexpected(&token.describe())),
        }
    }

    fn in_parentheses(&mut self) -> Result<Expression, Fault> {
        if self.take_symbol(")") {
            return Ok(Expression::Tuple(Vec::new()));
        }
        let inside = self.ternary_or_tuple()?;
        let inside = if self.is_at_word("for") {
            self.comprehension(Collection::Generator, None, inside)?
        } else {
            inside
        };
        self.expect(")")?;
        if matches!(inside, Expression::Star(_)) {
            return Err(self.unexpected("'*'"));
        }
        Ok(inside)
    }

    fn list(&mut self) -> Result<Expression, Fault> {
        if self.take_symbol("]") {
            return Ok(Expression::List(Vec::new()));
        }
        let first = self.star_or_ternary()?;
        if self.is_at_word("for") {
            let list = self.comprehension(Collection::List, None, first)?;
            self.expect("]")?;
            return Ok(list);
        }
        Ok(Expression::List(self.further_items(first, "]")?))
    }

    fn further_items(&mut self, first: Expression, end: &str) -> Result<Vec<Expression>, Fault> {
        let mut items = vec![first];
        while !self.take_symbol(end) {
            self.expect(",")?;
            if self.take_symbol(end) {
                break;
            }
            items.push(self.star_or_ternary()?);
        }
        Ok(items)
    }

    fn map_or_set(&mut self) -> Result<Expression, Fault> {
        if self.take_symbol("}") {
            return Ok(Expression::Map(Vec::new()));
        }
        if self.is_at("**") {
            return self.further_entries(Vec::new());
        }
        let first = self.star_or_ternary()?;
        if self.take_symbol(":") {
            let value = self.ternary()?;
            if self.is_at_word("for") {
                let map = self.comprehension(Collection::Map, Some(first), value)?;
                self.expect("}")?;
                return Ok(map);
            }
            let entries = vec![(Some(first), value)];
            return if self.take_symbol("}") {
                Ok(Expression::Map(entries))
            } else {
                self.expect(",")?;
                self.further_entries(entries)
            };
        }
        if self.is_at_word("for") {
            let set = self.comprehension(Collection::Set, None, first)?;
            self.expect("}")?;
            return Ok(set);
        }
        Ok(Expression::Set(self.further_items(first, "}")?))
    }

    fn further_entries(
        &mut self,
        mut entries: Vec<(Option<Expression>, Expression)>,
    ) -> Result<Expression, Fault> {
        while !self.take_symbol("}") {
            if self.take_symbol("**") {
                entries.push((None, self.binary(1)?));
            } else {
                let key = self.ternary()?;
                self.expect(":")?;
                entries.push((Some(key), self.ternary()?));
            }
            if !self.take_symbol(",") {
                self.expect("}")?;
                break;
            }
        }
        Ok(Expression::Map(entries))
    }

    /// Reads the arguments of a call up to the closing bracket.
    pub(super) fn arguments(&mut self) -> Result<Vec<Argument>, Fault> {
        let mut arguments = Vec::new();
        while !self.take_symbol(")") {
            let argument = if self.take_symbol("**") {
                Argument::Keywords(self.ternary()?)
            } else if self.take_symbol("*") {
                Argument::Items(self.ternary()?)
            } else if let Some(name) = self.take_keyword() {
                let is_repeated =
                    |known: &Argument| matches!(known, Argument::Keyword(known, _) if *known == name);
                if arguments.iter().any(is_repeated) {
                    return Err(self.error(&format!("the argument '{name}' is given twice")));
                }
                Argument::Keyword(name, self.ternary()?)
            } else {
                let value = self.ternary()?;
                if arguments
                    .iter()
                    .any(|known| matches!(known, Argument::Keyword(..) | Argument::Keywords(_)))
                {
                    return Err(self.error("an argument without a name follows one with a name"));
                }
                if self.is_at_word("for") {
                    if !arguments.is_empty() {
                        return Err(self.error("a generator beside other arguments needs brackets"));
                    }
                    Argument::Positional(self.comprehension(Collection::Generator, None, value)?)
                } else {
                    Argument::Positional(value)
                }
            };
            arguments.push(argument);
            if !self.take_symbol(",") {
                self.expect(")")?;
                break;
            }
        }
        Ok(arguments)
    }
}
