//! Where names live: properties, blocks and macros, in scopes that lie over each other.
//!
//! The file is the lowest scope. Every macro call lies on that of its caller, as in xacro: a macro sees the
//! properties of whoever calls it.

use super::fault::Fault;
use super::macros::Macro;
use super::value::Value;
use crate::diagnostics::Source;
use crate::xml::{Node, Weight};
use std::collections::HashMap;
use std::rc::Rc;

/// A property, as far as it is known.
#[derive(Debug, Clone)]
pub(super) enum Property {
    Known(Value),
    /// Its text is evaluated when it is first used, in the scope that holds it.
    Lazy {
        text: String,
        source: Source,
    },
    /// Is being evaluated just now: using it is a circle.
    Evaluating,
    /// Could not be evaluated when its namespace was closed.
    Broken(Fault),
}

/// Elements to be inserted by `insert_block`.
#[derive(Debug, Clone)]
pub(super) struct Block {
    pub(super) nodes: Rc<[Node]>,
    /// What each insertion takes of the budget.
    pub(super) weight: Weight,
    /// A macro's argument was expanded where the macro was called; a property block is expanded where it is
    /// inserted.
    pub(super) expanded: bool,
}

/// The names of a file, a macro call or a namespace.
#[derive(Debug, Clone, Default)]
pub(super) struct Scope {
    pub(super) properties: HashMap<String, Property>,
    /// By name with its stars: `*origin` (the element) or `**content` (what is inside).
    pub(super) blocks: HashMap<String, Block>,
    pub(super) macros: HashMap<String, Rc<Macro>>,
    /// Files included with `ns`.
    pub(super) namespaces: HashMap<String, Rc<Scope>>,
}
