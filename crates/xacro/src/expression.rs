//! The grammar of `${…}`: Python's expressions without assignments, comprehensions and lambdas.
//!
//! | binds weakest first | |
//! |---|---|
//! | `a if c else b` | |
//! | `or`, `and`, `not` | |
//! | `== != < <= > >= in not in` | chains, as in `0 < x < 1` |
//! | `+ -`, then `* / // %`, then unary `+ -`, then `**` | |
//! | `f(x)`, `x[i]`, `x[i:j]`, `x.method()` | |

mod tokens;

use super::fault::Fault;
use super::value::Value;
use tokens::{Token, syntax, tokens};

/// An expression, parsed.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Expression {
    Literal(Value),
    /// A property, with dots if it lies in a namespace.
    Name(String),
    List(Vec<Expression>),
    Negate(Box<Expression>),
    Plus(Box<Expression>),
    Not(Box<Expression>),
    And(Box<Expression>, Box<Expression>),
    Or(Box<Expression>, Box<Expression>),
    Arithmetic(Arithmetic, Box<Expression>, Box<Expression>),
    Compare(Box<Expression>, Vec<(Comparison, Expression)>),
    Ternary {
        condition: Box<Expression>,
        yes: Box<Expression>,
        no: Box<Expression>,
    },
    Index(Box<Expression>, Box<Expression>),
    Slice(Box<Expression>, Option<Box<Expression>>, Option<Box<Expression>>),
    /// A function by its name, or a method by its name behind a dot.
    Call(String, Vec<Expression>),
    Method(Box<Expression>, String, Vec<Expression>),
}

impl Expression {
    /// How deep it is nested.
    pub(super) fn levels(&self) -> usize {
        let deepest = |all: &[Self]| all.iter().map(Self::levels).max().unwrap_or(0);
        let bound = |bound: &Option<Box<Self>>| bound.as_ref().map_or(0, |bound| bound.levels());
        1 + match self {
            Self::Literal(_) | Self::Name(_) => 0,
            Self::List(items) | Self::Call(_, items) => deepest(items),
            Self::Negate(inner) | Self::Plus(inner) | Self::Not(inner) => inner.levels(),
            Self::And(a, b) | Self::Or(a, b) | Self::Arithmetic(_, a, b) | Self::Index(a, b) => {
                a.levels().max(b.levels())
            }
            Self::Compare(first, others) => {
                others.iter().map(|(_, other)| other.levels()).fold(first.levels(), usize::max)
            }
            Self::Ternary { condition, yes, no } => condition.levels().max(yes.levels()).max(no.levels()),
            Self::Slice(operand, start, end) => operand.levels().max(bound(start)).max(bound(end)),
            Self::Method(object, _, items) => object.levels().max(deepest(items)),
        }
    }
}

/// Arithmetic of two operands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Arithmetic {
    Add,
    Subtract,
    Multiply,
    Divide,
    FloorDivide,
    Remainder,
    Power,
}

/// Comparisons of two operands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Comparison {
    Equal,
    NotEqual,
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
    In,
    NotIn,
}

/// Parses the inside of `${…}`.
pub(super) fn parse(text: &str) -> Result<Expression, Fault> {
    let mut parser = Parser { text, tokens: tokens(text)?, next: 0, nesting: 0 };
    let expression = parser.ternary_or_tuple()?;
    match parser.peek() {
        None => Ok(expression),
        Some(token) => Err(parser.unexpected(&token.describe())),
    }
}

/// More than anyone writes, few enough for any stack.
const MAX_NESTING: u32 = 60;
struct Parser<'a> {
    text: &'a str,
    tokens: Vec<Token>,
    next: usize,
    nesting: u32,
}

impl Parser<'_> {
    fn peek(&self) -> Option<&Token> {
        self.tokens.get(self.next)
    }

    fn take_symbol(&mut self, symbol: &str) -> bool {
        let found = matches!(self.peek(), Some(Token::Symbol(next)) if *next == symbol);
        self.next += usize::from(found);
        found
    }

    fn take_word(&mut self, word: &str) -> bool {
        let found = matches!(self.peek(), Some(Token::Name(next)) if next == word);
        self.next += usize::from(found);
        found
    }

    fn unexpected(&self, what: &str) -> Fault {
        syntax(self.text, &format!("{what} is not expected there"))
    }

    fn expect(&mut self, symbol: &str) -> Result<(), Fault> {
        if self.take_symbol(symbol) {
            return Ok(());
        }
        Err(syntax(self.text, &format!("'{symbol}' is missing")))
    }

    /// `a, b` without brackets is a tuple.
    fn ternary_or_tuple(&mut self) -> Result<Expression, Fault> {
        let first = self.ternary()?;
        if !self.take_symbol(",") {
            return Ok(first);
        }
        let mut items = vec![first];
        while self.peek().is_some() && !matches!(self.peek(), Some(Token::Symbol(")"))) {
            items.push(self.ternary()?);
            if !self.take_symbol(",") {
                break;
            }
        }
        Ok(Expression::List(items))
    }

    fn ternary(&mut self) -> Result<Expression, Fault> {
        self.nesting += 1;
        if self.nesting > MAX_NESTING {
            return Err(syntax(self.text, "it is nested too deeply"));
        }
        let yes = self.or()?;
        let expression = if self.take_word("if") {
            let condition = Box::new(self.or()?);
            if !self.take_word("else") {
                return Err(syntax(self.text, "'if' without 'else'"));
            }
            Expression::Ternary { condition, yes: Box::new(yes), no: Box::new(self.ternary()?) }
        } else {
            yes
        };
        self.nesting -= 1;
        Ok(expression)
    }

    fn or(&mut self) -> Result<Expression, Fault> {
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
            operand = Expression::Not(Box::new(operand));
        }
        Ok(operand)
    }

    fn comparison(&mut self) -> Result<Expression, Fault> {
        let first = self.sum()?;
        let mut others = Vec::new();
        while let Some(comparison) = self.take_comparison()? {
            others.push((comparison, self.sum()?));
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
        if self.take_word("not") {
            return if self.take_word("in") {
                Ok(Some(Comparison::NotIn))
            } else {
                Err(self.unexpected("'not'"))
            };
        }
        Ok(None)
    }

    fn sum(&mut self) -> Result<Expression, Fault> {
        let mut left = self.product()?;
        loop {
            let operator = if self.take_symbol("+") {
                Arithmetic::Add
            } else if self.take_symbol("-") {
                Arithmetic::Subtract
            } else {
                return Ok(left);
            };
            left = Expression::Arithmetic(operator, Box::new(left), Box::new(self.product()?));
        }
    }

    fn product(&mut self) -> Result<Expression, Fault> {
        let mut left = self.unary()?;
        loop {
            let operator = if self.take_symbol("*") {
                Arithmetic::Multiply
            } else if self.take_symbol("//") {
                Arithmetic::FloorDivide
            } else if self.take_symbol("/") {
                Arithmetic::Divide
            } else if self.take_symbol("%") {
                Arithmetic::Remainder
            } else {
                return Ok(left);
            };
            left = Expression::Arithmetic(operator, Box::new(left), Box::new(self.unary()?));
        }
    }

    fn unary(&mut self) -> Result<Expression, Fault> {
        self.nesting += 1;
        if self.nesting > MAX_NESTING {
            return Err(syntax(self.text, "it is nested too deeply"));
        }
        let expression = if self.take_symbol("-") {
            Expression::Negate(Box::new(self.unary()?))
        } else if self.take_symbol("+") {
            Expression::Plus(Box::new(self.unary()?))
        } else {
            self.power()?
        };
        self.nesting -= 1;
        Ok(expression)
    }

    /// `-a ** -b` is −(a^(−b)): the exponent may have a sign of its own.
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
                let arguments = self.items(")")?;
                let Expression::Name(name) = operand else { return Err(self.unexpected("'('")) };
                operand = Expression::Call(name, arguments);
            } else if self.take_symbol("[") {
                operand = self.subscript(operand)?;
            } else if self.take_symbol(".") {
                let Some(Token::Name(name)) = self.peek().cloned() else {
                    return Err(syntax(self.text, "a name is missing behind '.'"));
                };
                self.next += 1;
                operand = match operand {
                    Expression::Name(before) => Expression::Name(format!("{before}.{name}")),
                    other if self.take_symbol("(") => {
                        Expression::Method(Box::new(other), name, self.items(")")?)
                    }
                    // A key of a dictionary.
                    other => {
                        let key = Expression::Literal(Value::Text(name));
                        Expression::Index(Box::new(other), Box::new(key))
                    }
                };
            } else {
                return Ok(operand);
            }
        }
    }

    fn subscript(&mut self, operand: Expression) -> Result<Expression, Fault> {
        let at = |parser: &Self, symbol| matches!(parser.peek(), Some(Token::Symbol(s)) if *s == symbol);
        let start = if at(self, ":") { None } else { Some(Box::new(self.ternary()?)) };
        if !self.take_symbol(":") {
            self.expect("]")?;
            let index = start.ok_or_else(|| syntax(self.text, "an index is missing"))?;
            return Ok(Expression::Index(Box::new(operand), index));
        }
        let end = if at(self, "]") { None } else { Some(Box::new(self.ternary()?)) };
        self.expect("]")?;
        Ok(Expression::Slice(Box::new(operand), start, end))
    }

    fn items(&mut self, end: &str) -> Result<Vec<Expression>, Fault> {
        let mut items = Vec::new();
        while !self.take_symbol(end) {
            items.push(self.ternary()?);
            if !self.take_symbol(",") {
                self.expect(end)?;
                break;
            }
        }
        Ok(items)
    }

    fn atom(&mut self) -> Result<Expression, Fault> {
        let Some(token) = self.peek().cloned() else {
            return Err(syntax(self.text, "it ends too early"));
        };
        self.next += 1;
        match token {
            Token::Literal(Value::Text(mut text)) => {
                // Texts side by side are one, as in Python.
                while let Some(Token::Literal(Value::Text(more))) = self.peek() {
                    text.push_str(more);
                    self.next += 1;
                }
                Ok(Expression::Literal(Value::Text(text)))
            }
            Token::Literal(value) => Ok(Expression::Literal(value)),
            Token::Name(word) if ["if", "else", "and", "or", "not", "in"].contains(&word.as_str()) => {
                Err(self.unexpected(&format!("'{word}'")))
            }
            Token::Name(name) => Ok(Expression::Name(name)),
            Token::Symbol("(") => {
                if self.take_symbol(")") {
                    return Ok(Expression::List(Vec::new()));
                }
                let inside = self.ternary_or_tuple()?;
                self.expect(")")?;
                Ok(inside)
            }
            Token::Symbol("[") => Ok(Expression::List(self.items("]")?)),
            Token::Symbol(symbol) => Err(self.unexpected(&format!("'{symbol}'"))),
        }
    }
}
