//! Faults inside a text or an expression, before their place in the file is known.

use crate::budget::Spent;
use crate::diagnostics::{Problem, Severity, Source};

/// A problem whose place may not be known yet.
#[derive(Debug, Clone)]
pub(super) struct Fault {
    /// Set if the place is not that of the text, as in a property that is evaluated when it is used.
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

    /// Sets the place to `source` if there is none.
    pub(super) fn at(mut self, source: &Source) -> Self {
        self.source.get_or_insert_with(|| source.clone());
        self
    }

    /// Converts the fault to an error, at `source` if there is no place.
    pub(super) fn into_problem(self, source: &Source) -> Problem {
        Problem {
            severity: Severity::Error,
            source: self.source.unwrap_or_else(|| source.clone()),
            what: self.what,
            remedy: self.remedy,
        }
    }
}
