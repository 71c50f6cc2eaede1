//! What was found wrong in the user's files, each with its place and its remedy.

use std::collections::BTreeSet;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A place in a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    /// The file as it was opened.
    pub file: Arc<Path>,
    /// Line number from 1; 0 when the whole file is meant.
    pub line: u32,
}

impl Source {
    /// A line of a file; line 0 means the whole file.
    pub fn new(file: impl Into<PathBuf>, line: u32) -> Self {
        Self { file: file.into().into(), line }
    }
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file.display())?;
        if self.line > 0 { write!(f, ":{}", self.line) } else { Ok(()) }
    }
}

/// How bad a [`Problem`] is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Worth knowing: a choice that was made for the user.
    Note,
    /// Something is ignored that the user may have counted on.
    Warning,
    /// The description cannot be used as it is.
    Error,
}

impl fmt::Display for Severity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Note => "note",
            Self::Warning => "warning",
            Self::Error => "error",
        })
    }
}

/// One thing found wrong: where, what, and what to do about it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// How bad it is.
    pub severity: Severity,
    /// Where it stands.
    pub source: Source,
    /// What is wrong, naming the offending value.
    pub what: String,
    /// What the user can do.
    pub remedy: String,
}

impl fmt::Display for Problem {
    /// `file:line: error: what; remedy`, the form that editors and compilers' users know.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}: {}", self.source, self.severity, self.what)?;
        if self.remedy.is_empty() { Ok(()) } else { write!(f, "; {}", self.remedy) }
    }
}

impl std::error::Error for Problem {}

/// Every problem found while loading, in the order of discovery; and every file that was read.
#[derive(Debug, Default, Clone)]
pub struct Diagnostics {
    problems: Vec<Problem>,
    files: BTreeSet<PathBuf>,
}

impl Diagnostics {
    /// Notes that the description cannot be used.
    pub fn error(&mut self, source: &Source, what: impl Into<String>, remedy: impl Into<String>) {
        self.push(Severity::Error, source, what, remedy);
    }

    /// Notes that something is ignored.
    pub fn warning(&mut self, source: &Source, what: impl Into<String>, remedy: impl Into<String>) {
        self.push(Severity::Warning, source, what, remedy);
    }

    /// Notes a choice that was made.
    pub fn note(&mut self, source: &Source, what: impl Into<String>, remedy: impl Into<String>) {
        self.push(Severity::Note, source, what, remedy);
    }

    fn push(
        &mut self,
        severity: Severity,
        source: &Source,
        what: impl Into<String>,
        remedy: impl Into<String>,
    ) {
        let problem = Problem { severity, source: source.clone(), what: what.into(), remedy: remedy.into() };
        // A macro called twice, or a file included twice, repeats its problems: say each once.
        if !self.problems.contains(&problem) {
            self.problems.push(problem);
        }
    }

    /// Takes in a problem found elsewhere.
    pub fn add(&mut self, problem: Problem) {
        if !self.problems.contains(&problem) {
            self.problems.push(problem);
        }
    }

    /// Notes that what is loaded depends on the content of a file.
    pub fn opened(&mut self, file: &Path) {
        if !self.files.contains(file) {
            self.files.insert(file.to_owned());
        }
    }

    /// The files on whose content that depends which was loaded, as they were opened.
    pub fn files(&self) -> &BTreeSet<PathBuf> {
        &self.files
    }

    /// All problems, in the order of discovery.
    pub fn problems(&self) -> &[Problem] {
        &self.problems
    }

    /// The errors alone.
    pub fn errors(&self) -> impl Iterator<Item = &Problem> {
        self.problems.iter().filter(|problem| problem.severity == Severity::Error)
    }

    /// Makes every warning an error.
    pub fn warnings_are_errors(&mut self) {
        for problem in &mut self.problems {
            if problem.severity == Severity::Warning {
                problem.severity = Severity::Error;
            }
        }
    }

    /// True when the description cannot be used.
    pub fn has_errors(&self) -> bool {
        self.errors().next().is_some()
    }
}
