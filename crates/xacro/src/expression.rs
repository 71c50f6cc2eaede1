//! The grammar of `${…}`: Python's expressions, without assignments, `await`, `yield` and f-strings.
//!
//! | binds weakest first | |
//! |---|---|
//! | `lambda x: …`, `a if c else b` | |
//! | `or`, `and`, `not` | |
//! | `== != < <= > >= in`, `not in`, `is`, `is not` | chains, as in `0 < x < 1` |
//! | the bitwise or, `^`, `&`, `<< >>`, `+ -`, `* / // %` | each binds more strongly than the previous one |
//! | unary `+ - ~`, then `**` | |
//! | `f(x)`, `x[i]`, `x[i:j:k]`, `x.name` | |
//! | `[…]`, `(…)`, `{…}` | displays and comprehensions |

mod atoms;
mod comprehensions;
mod literals;
mod parser;
mod tokens;

use super::fault::Fault;
use super::value::Value;
use std::rc::Rc;

/// A parsed expression.
#[derive(Debug, Clone)]
pub(super) enum Expression {
    Literal(Value),
    Name(String),
    /// `object.name`.
    Attribute(Box<Expression>, String),
    List(Vec<Expression>),
    Tuple(Vec<Expression>),
    Set(Vec<Expression>),
    /// Keys and values; a value without a key is a dictionary whose entries are added.
    Map(Vec<(Option<Expression>, Expression)>),
    /// `*items` in a display.
    Star(Box<Expression>),
    Unary(Unary, Box<Expression>),
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
    /// The object, then start, end and step.
    Slice(Box<Expression>, Box<[Option<Expression>; 3]>),
    Call(Box<Expression>, Vec<Argument>),
    Comprehension(Rc<Comprehension>),
    Lambda(Rc<Lambda>),
}

/// Operators of one operand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Unary {
    Negate,
    Plus,
    Invert,
    Not,
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
    BitAnd,
    BitOr,
    BitXor,
    ShiftLeft,
    ShiftRight,
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
    Is,
    IsNot,
}

/// An argument of a call.
#[derive(Debug, Clone)]
pub(super) enum Argument {
    Positional(Expression),
    Keyword(String, Expression),
    /// `*items`.
    Items(Expression),
    /// `**dictionary`.
    Keywords(Expression),
}

/// `[element for target in items if condition]`, and the corresponding forms for sets, dictionaries and generators.
#[derive(Debug)]
pub(super) struct Comprehension {
    pub(super) kind: Collection,
    /// The item, or the value of a dictionary's entry.
    pub(super) element: Expression,
    /// The key of a dictionary's entry.
    pub(super) key: Option<Expression>,
    pub(super) clauses: Vec<Clause>,
}

/// The type of the collection that a comprehension creates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Collection {
    List,
    Set,
    Map,
    Generator,
}

/// `for target in items`, with its conditions.
#[derive(Debug)]
pub(super) struct Clause {
    pub(super) target: Target,
    pub(super) items: Expression,
    pub(super) conditions: Vec<Expression>,
}

/// The target of the assignment by `for`.
#[derive(Debug)]
pub(super) enum Target {
    Name(String),
    Tuple(Vec<Target>),
}

/// `lambda a, b=1, *rest: body`.
#[derive(Debug)]
pub(super) struct Lambda {
    /// Names and their defaults.
    pub(super) parameters: Vec<(String, Option<Expression>)>,
    /// The name that takes further positional arguments.
    pub(super) rest: Option<String>,
    pub(super) body: Expression,
    /// The number of levels of expressions that a call counts as.
    pub(super) levels: usize,
}

impl Expression {
    /// Returns the depth of nesting.
    pub(super) fn levels(&self) -> usize {
        let mut deepest = 0;
        self.each(&mut |part| deepest = deepest.max(part.levels()));
        let own = match self {
            Self::Call(..) => 2,
            Self::Comprehension(comprehension) => 2 + comprehension.clauses.len(),
            _ => 1,
        };
        own + deepest
    }

    /// Visits the direct parts. The body of a lambda is not visited: it is evaluated when the lambda is called.
    fn each(&self, visit: &mut dyn FnMut(&Self)) {
        match self {
            Self::Literal(_) | Self::Name(_) => {}
            Self::List(items) | Self::Tuple(items) | Self::Set(items) => items.iter().for_each(visit),
            Self::Map(entries) => entries.iter().for_each(|(key, value)| {
                key.iter().for_each(&mut *visit);
                visit(value);
            }),
            Self::Star(inner) | Self::Unary(_, inner) | Self::Attribute(inner, _) => visit(inner),
            Self::And(a, b) | Self::Or(a, b) | Self::Arithmetic(_, a, b) | Self::Index(a, b) => {
                visit(a);
                visit(b);
            }
            Self::Compare(first, others) => {
                visit(first);
                for (_, other) in others {
                    visit(other);
                }
            }
            Self::Ternary { condition, yes, no } => {
                for part in [condition, yes, no] {
                    visit(part);
                }
            }
            Self::Slice(object, bounds) => {
                visit(object);
                bounds.iter().flatten().for_each(visit);
            }
            Self::Call(function, arguments) => {
                visit(function);
                for argument in arguments {
                    let (Argument::Positional(value)
                    | Argument::Keyword(_, value)
                    | Argument::Items(value)
                    | Argument::Keywords(value)) = argument;
                    visit(value);
                }
            }
            Self::Comprehension(comprehension) => {
                visit(&comprehension.element);
                comprehension.key.iter().for_each(&mut *visit);
                for clause in &comprehension.clauses {
                    visit(&clause.items);
                    clause.conditions.iter().for_each(&mut *visit);
                }
            }
            Self::Lambda(lambda) => {
                lambda.parameters.iter().filter_map(|(_, default)| default.as_ref()).for_each(visit);
            }
        }
    }

    /// Returns the names of a chain `a.b.c`, or `None` if the expression is anything else.
    pub(super) fn dotted_name(&self) -> Option<String> {
        match self {
            Self::Name(name) => Some(name.clone()),
            Self::Attribute(object, name) => Some(format!("{}.{name}", object.dotted_name()?)),
            _ => None,
        }
    }
}

/// Returns true if a word is one of Python's keywords, which cannot be names.
pub(super) fn is_keyword(word: &str) -> bool {
    parser::KEYWORDS.contains(&word) || ["True", "False", "None"].contains(&word)
}

/// Parses the inside of `${…}`.
pub(super) fn parse(text: &str) -> Result<Expression, Fault> {
    parser::Parser::of(text)?.whole()
}
