//! [`Consumer`]: who follows a stream.

use std::fmt;

/// A process that follows a stream, by the name that it opened its node with.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Consumer {
    /// The node's name: what it passed to [`Node::open`](crate::Node::open).
    pub name: String,
    /// Its process; 0 when that is not known.
    pub pid: u32,
}

impl fmt::Display for Consumer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "\"{}\" (process {})", self.name, self.pid)
    }
}
