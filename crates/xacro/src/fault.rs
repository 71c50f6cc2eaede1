//! What goes wrong inside a text or an expression, before its place in the file is known.

use crate::budget::Spent;
use crate::diagnostics::{Problem, Severity, Source};

/// A problem that may not know its place yet.
#[derive(Debug, Clone)]
pub(super) struct Fault {
    /// Set when it lies elsewhere than where the text stands, as in a property that is evaluated when used.
    pub(super) source: Option<Source>,
    pub(super) what: String,
    pub(super) remedy: String,
}

impl From<Spent> for Fault {
    fn from(spent: Spent) -> Self {
        Self::new(spent.to_string(), Spent::REMEDY)
    }
}

impl Fault {
    pub(super) fn new(what: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { source: None, what: what.into(), remedy: remedy.into() }
    }

    /// Puts it at `source` unless it has a place.
    pub(super) fn at(mut self, source: &Source) -> Self {
        self.source.get_or_insert_with(|| source.clone());
        self
    }

    /// As an error, at `source` unless it has a place.
    pub(super) fn into_problem(self, source: &Source) -> Problem {
        Problem {
            severity: Severity::Error,
            source: self.source.unwrap_or_else(|| source.clone()),
            what: self.what,
            remedy: self.remedy,
        }
    }
}
