//! [`Consumer`]: a process that subscribes to a stream.

use std::fmt;

/// A process that subscribes to a stream, identified by the name of its node.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Consumer {
    /// The node's name, as passed to [`Node::open`](crate::Node::open).
    pub name: String,
    /// Its process id; 0 if unknown.
    pub pid: u32,
}

impl fmt::Display for Consumer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "\"{}\" (process {})", self.name, self.pid)
    }
}
