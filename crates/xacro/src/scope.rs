//! Storage of names: properties, blocks and macros, in nested scopes.
//!
//! The outermost scope is that of the file. As in xacro, the scope of a macro call is inside the scope of its caller,
//! so a macro sees the caller's properties.

use super::fault::Fault;
use super::macros::Macro;
use super::value::Value;
use crate::diagnostics::Source;
use crate::xml::{Node, Weight};
use std::collections::HashMap;
use std::rc::Rc;

/// A property and its state of evaluation.
#[derive(Debug, Clone)]
pub(super) enum Property {
    Known(Value),
    /// The text is evaluated on first use, in the scope that contains the property.
    Lazy {
        text: String,
        source: Source,
    },
    /// The property is being evaluated; using it now is a cycle.
    Evaluating,
    /// The property could not be evaluated when its namespace was closed.
    Broken(Fault),
}

/// Elements to be inserted by `insert_block`.
#[derive(Debug, Clone)]
pub(super) struct Block {
    pub(super) nodes: Rc<[Node]>,
    /// The size that each insertion adds to the budget.
    pub(super) weight: Weight,
    /// True if the block is already expanded. A macro's argument is expanded in the scope of the caller, a property
    /// block where it is inserted.
    pub(super) expanded: bool,
}

/// The names of a file, a macro call or a namespace.
#[derive(Debug, Clone, Default)]
pub(super) struct Scope {
    pub(super) properties: HashMap<String, Property>,
    /// Blocks by name including the stars: `*origin` (the element) or `**content` (its content).
    pub(super) blocks: HashMap<String, Block>,
    pub(super) macros: HashMap<String, Rc<Macro>>,
    /// The namespaces of files that were included with `ns`.
    pub(super) namespaces: HashMap<String, Rc<Scope>>,
}
