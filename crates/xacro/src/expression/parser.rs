//! Operators, from those that bind weakest to calls and subscripts.

use super::super::fault::Fault;
use super::tokens::{Token, syntax, tokens};
use super::{Arithmetic, Comparison, Expression, Lambda, Unary};
use std::rc::Rc;

/// More nesting than files have, and little enough for any stack.
const MAX_NESTING: u32 = 60;

/// The words that cannot be names.
pub(super) const KEYWORDS: [&str; 32] = [
    "and", "as", "assert", "async", "await", "break", "class", "continue", "def", "del", "elif", "else",
    "except", "finally", "for", "from", "global", "if", "import", "in", "is", "lambda", "nonlocal", "not",
    "or", "pass", "raise", "return", "try", "while", "with", "yield",
];

/// The binary operators with their precedence; a greater number binds more strongly.
const OPERATORS: [(&str, u32, Arithmetic); 11] = [
    ("|", 1, Arithmetic::BitOr),
    ("^", 2, Arithmetic::BitXor),
    ("&", 3, Arithmetic::BitAnd),
    ("<<", 4, Arithmetic::ShiftLeft),
    (">>", 4, Arithmetic::ShiftRight),
    ("+", 5, Arithmetic::Add),
    ("-", 5, Arithmetic::Subtract),
    ("*", 6, Arithmetic::Multiply),
    ("/", 6, Arithmetic::Divide),
    ("//", 6, Arithmetic::FloorDivide),
    ("%", 6, Arithmetic::Remainder),
];

pub(super) struct Parser<'a> {
    pub(super) text: &'a str,
    tokens: Vec<Token>,
    next: usize,
    nesting: u32,
}

impl<'a> Parser<'a> {
    pub(super) fn of(text: &'a str) -> Result<Self, Fault> {
        Ok(Self { text, tokens: tokens(text)?, next: 0, nesting: 0 })
    }

    pub(super) fn whole(mut self) -> Result<Expression, Fault> {
        let expression = self.ternary_or_tuple()?;
        match self.peek() {
            None => Ok(expression),
            Some(token) => Err(self.unexpected(&token.describe())),
        }
    }

    pub(super) fn peek(&self) -> Option<&Token> {
        self.tokens.get(self.next)
    }

    /// Returns the next token and advances past it.
    pub(super) fn take(&mut self) -> Option<Token> {
        let token = self.peek().cloned();
        self.next += 1;
        token
    }

    pub(super) fn is_at(&self, symbol: &str) -> bool {
        matches!(self.peek(), Some(Token::Symbol(next)) if *next == symbol)
    }

    pub(super) fn is_at_word(&self, word: &str) -> bool {
        matches!(self.peek(), Some(Token::Name(next)) if next == word)
    }

    pub(super) fn take_symbol(&mut self, symbol: &str) -> bool {
        let found = self.is_at(symbol);
        self.next += usize::from(found);
        found
    }

    pub(super) fn take_word(&mut self, word: &str) -> bool {
        let found = self.is_at_word(word);
        self.next += usize::from(found);
        found
    }

    /// Takes a name that is not a keyword.
    pub(super) fn take_name(&mut self) -> Option<String> {
        match self.peek() {
            Some(Token::Name(name)) if !KEYWORDS.contains(&name.as_str()) => {
                let name = name.clone();
                self.next += 1;
                Some(name)
            }
            _ => None,
        }
    }

    /// Takes a name and the `=` after it.
    pub(super) fn take_keyword(&mut self) -> Option<String> {
        let begin = self.next;
        if let Some(name) = self.take_name()
            && self.take_symbol("=")
        {
            return Some(name);
        }
        self.next = begin;
        None
    }

    pub(super) fn error(&self, what: &str) -> Fault {
        syntax(self.text, what)
    }

    pub(super) fn unexpected(&self, what: &str) -> Fault {
        self.error(&format!("{what} is not expected there"))
    }

    pub(super) fn expect(&mut self, symbol: &str) -> Result<(), Fault> {
        if self.take_symbol(symbol) {
            return Ok(());
        }
        if self.is_at(":=") {
            return Err(self.error("':=' is not supported: define a property"));
        }
        Err(self.error(&format!("'{symbol}' is missing")))
    }

    /// Enters a level of nesting, which the caller leaves by [`Self::leave`].
    fn enter(&mut self) -> Result<(), Fault> {
        self.nesting += 1;
        if self.nesting > MAX_NESTING { Err(self.error("it is nested too deeply")) } else { Ok(()) }
    }

    fn leave(&mut self) {
        self.nesting -= 1;
    }

    /// Reads `a`, or `a, b` without brackets, which is a tuple.
    pub(super) fn ternary_or_tuple(&mut self) -> Result<Expression, Fault> {
        let first = self.star_or_ternary()?;
        if !self.is_at(",") {
            return Ok(first);
        }
        let mut items = vec![first];
        while self.take_symbol(",") && self.peek().is_some() && !self.is_at(")") && !self.is_at("]") {
            items.push(self.star_or_ternary()?);
        }
        Ok(Expression::Tuple(items))
    }

    pub(super) fn star_or_ternary(&mut self) -> Result<Expression, Fault> {
        if self.take_symbol("*") {
            return Ok(Expression::Star(Box::new(self.binary(1)?)));
        }
        self.ternary()
    }

    pub(super) fn ternary(&mut self) -> Result<Expression, Fault> {
        self.enter()?;
        if self.take_word("lambda") {
            let lambda = self.lambda()?;
            self.leave();
            return Ok(lambda);
        }
        let yes = self.or()?;
        let expression = if self.take_word("if") {
            let condition = Box::new(self.or()?);
            if !self.take_word("else") {
                return Err(self.error("'if' without 'else'"));
            }
            Expression::Ternary { condition, yes: Box::new(yes), no: Box::new(self.ternary()?) }
        } else {
            yes
        };
        self.leave();
        Ok(expression)
    }

    fn lambda(&mut self) -> Result<Expression, Fault> {
        let mut parameters: Vec<(String, Option<Expression>)> = Vec::new();
        let mut rest = None;
        while !self.take_symbol(":") {
            if self.take_symbol("*") {
                rest = Some(self.take_name().ok_or_else(|| self.error("a name is missing after '*'"))?);
            } else {
                let name =
                    self.take_name().ok_or_else(|| self.error("a parameter of 'lambda' has no name"))?;
                let default = if self.take_symbol("=") { Some(self.ternary()?) } else { None };
                let is_out_of_order =
                    default.is_none() && parameters.iter().any(|(_, default)| default.is_some());
                if rest.is_some() || is_out_of_order || parameters.iter().any(|(known, _)| *known == name) {
                    return Err(
                        self.error(&format!("the parameter '{name}' of 'lambda' is not allowed there"))
                    );
                }
                parameters.push((name, default));
            }
            if !self.take_symbol(",") {
                self.expect(":")?;
                break;
            }
        }
        let body = self.ternary()?;
        // A call needs more stack than an operator.
        let levels = 4 + body.levels();
        Ok(Expression::Lambda(Rc::new(Lambda { parameters, rest, body, levels })))
    }

    pub(super) fn or(&mut self) -> Result<Expression, Fault> {
        let mut left = self.and()?;
        while self.take_word("or") {
            left = Expression::Or(Box::new(left), Box::new(self.and()?));
        }
        Ok(left)
    }

    fn and(&mut self) -> Result<Expression, Fault> {
        let mut left = self.not()?;
        while self.take_word("and") {
            left = Expression::And(Box::new(left), Box::new(self.not()?));
        }
        Ok(left)
    }

    fn not(&mut self) -> Result<Expression, Fault> {
        let mut count = 0_usize;
        while self.take_word("not") {
            count += 1;
        }
        let mut operand = self.comparison()?;
        for _ in 0..count.min(2 + count % 2) {
            operand = Expression::Unary(Unary::Not, Box::new(operand));
        }
        Ok(operand)
    }

    fn comparison(&mut self) -> Result<Expression, Fault> {
        let first = self.binary(1)?;
        let mut others = Vec::new();
        while let Some(comparison) = self.take_comparison()? {
            others.push((comparison, self.binary(1)?));
        }
        Ok(if others.is_empty() { first } else { Expression::Compare(Box::new(first), others) })
    }

    fn take_comparison(&mut self) -> Result<Option<Comparison>, Fault> {
        let comparisons = [
            ("==", Comparison::Equal),
            ("!=", Comparison::NotEqual),
            ("<=", Comparison::LessOrEqual),
            (">=", Comparison::GreaterOrEqual),
            ("<", Comparison::Less),
            (">", Comparison::Greater),
        ];
        for (symbol, comparison) in comparisons {
            if self.take_symbol(symbol) {
                return Ok(Some(comparison));
            }
        }
        if self.take_word("in") {
            return Ok(Some(Comparison::In));
        }
        if self.take_word("is") {
            return Ok(Some(if self.take_word("not") { Comparison::IsNot } else { Comparison::Is }));
        }
        if self.take_word("not") {
            return if self.take_word("in") {
                Ok(Some(Comparison::NotIn))
            } else {
                Err(self.unexpected("'not'"))
            };
        }
        Ok(None)
    }

    /// Reads operators whose precedence is at least `level`.
    pub(super) fn binary(&mut self, level: u32) -> Result<Expression, Fault> {
        let mut left = self.unary()?;
        loop {
            let found = OPERATORS.iter().find(|(symbol, binds, _)| *binds >= level && self.is_at(symbol));
            let Some((_, binds, operator)) = found else { return Ok(left) };
            self.next += 1;
            self.enter()?;
            let right = self.binary(binds + 1)?;
            self.leave();
            left = Expression::Arithmetic(*operator, Box::new(left), Box::new(right));
        }
    }

    fn unary(&mut self) -> Result<Expression, Fault> {
        self.enter()?;
        let operators = [("-", Unary::Negate), ("+", Unary::Plus), ("~", Unary::Invert)];
        let found = operators.into_iter().find(|(symbol, _)| self.take_symbol(symbol));
        let expression = match found {
            Some((_, operator)) => Expression::Unary(operator, Box::new(self.unary()?)),
            None => self.power()?,
        };
        self.leave();
        Ok(expression)
    }

    /// Reads `-a ** -b`, which is −(a^(−b)): the exponent may have a sign of its own.
    fn power(&mut self) -> Result<Expression, Fault> {
        let base = self.postfix()?;
        if !self.take_symbol("**") {
            return Ok(base);
        }
        Ok(Expression::Arithmetic(Arithmetic::Power, Box::new(base), Box::new(self.unary()?)))
    }

    fn postfix(&mut self) -> Result<Expression, Fault> {
        let mut operand = self.atom()?;
        loop {
            if self.take_symbol("(") {
                operand = Expression::Call(Box::new(operand), self.arguments()?);
            } else if self.take_symbol("[") {
                operand = self.subscript(operand)?;
            } else if self.take_symbol(".") {
                let name = self.take_name().ok_or_else(|| self.error("a name is missing after '.'"))?;
                operand = Expression::Attribute(Box::new(operand), name);
            } else {
                return Ok(operand);
            }
        }
    }

    fn subscript(&mut self, operand: Expression) -> Result<Expression, Fault> {
        if self.is_at("]") {
            return Err(self.error("an index is missing"));
        }
        let start = if self.is_at(":") { None } else { Some(self.ternary_or_tuple()?) };
        if !self.is_at(":") {
            self.expect("]")?;
            let index = start.ok_or_else(|| self.error("an index is missing"))?;
            return Ok(Expression::Index(Box::new(operand), Box::new(index)));
        }
        let mut bounds = [start, None, None];
        for bound in &mut bounds[1..] {
            if !self.take_symbol(":") {
                break;
            }
            if !self.is_at(":") && !self.is_at("]") {
                *bound = Some(self.ternary()?);
            }
        }
        self.expect("]")?;
        Ok(Expression::Slice(Box::new(operand), Box::new(bounds)))
    }
}
