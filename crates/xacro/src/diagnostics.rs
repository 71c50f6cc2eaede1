//! Problems found in the user's files, each with its place and its remedy.

use std::collections::hash_map::DefaultHasher;
use std::collections::{BTreeSet, HashMap};
use std::fmt;
use std::hash::{Hash as _, Hasher as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A place in a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    /// The file as it was opened.
    pub file: Arc<Path>,
    /// Line number from 1; 0 for the whole file.
    pub line: u32,
}

impl Source {
    /// Creates a source from a file and a line; line 0 is the whole file.
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

/// The severity of a [`Problem`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Information, such as a choice that was made for the user.
    Note,
    /// Something is ignored that the user may rely on.
    Warning,
    /// The description cannot be used.
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

/// A problem: its place, a description, and a remedy.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// The severity.
    pub severity: Severity,
    /// The place in the file.
    pub source: Source,
    /// What is wrong, including the invalid value.
    pub what: String,
    /// What the user can do.
    pub remedy: String,
}

impl fmt::Display for Problem {
    /// Writes `file:line: error: what; remedy`, a form that editors know from compilers.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}: {}", self.source, self.severity, self.what)?;
        if self.remedy.is_empty() { Ok(()) } else { write!(f, "; {}", self.remedy) }
    }
}

impl std::error::Error for Problem {}

/// All problems found while loading, in the order of discovery, and all files that were read.
#[derive(Debug, Default, Clone)]
pub struct Diagnostics {
    problems: Vec<Problem>,
    /// The indices of the problems, by hashes of their places and texts.
    known: HashMap<u64, Vec<usize>>,
    files: BTreeSet<PathBuf>,
}

impl Diagnostics {
    /// Adds an error: the description cannot be used.
    pub fn error(&mut self, source: &Source, what: impl Into<String>, remedy: impl Into<String>) {
        self.push(Severity::Error, source, what, remedy);
    }

    /// Adds a warning: something is ignored.
    pub fn warning(&mut self, source: &Source, what: impl Into<String>, remedy: impl Into<String>) {
        self.push(Severity::Warning, source, what, remedy);
    }

    /// Adds a note: a choice was made for the user.
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
        self.add(problem);
    }

    /// Adds a problem that was found elsewhere.
    ///
    /// A macro that is called twice, or a file that is included twice, repeats its problems. Each is reported once.
    pub fn add(&mut self, problem: Problem) {
        let mut hasher = DefaultHasher::new();
        (problem.source.line, &problem.what).hash(&mut hasher);
        let same = self.known.entry(hasher.finish()).or_default();
        if !same.iter().any(|&index| self.problems[index] == problem) {
            same.push(self.problems.len());
            self.problems.push(problem);
        }
    }

    /// Returns true if there are so many problems that nobody reads suggestions for further ones, each of which compares
    /// a name with all others.
    pub fn is_crowded(&self) -> bool {
        self.problems.len() > 200
    }

    /// Records that the result depends on the content of a file.
    pub fn opened(&mut self, file: &Path) {
        if !self.files.contains(file) {
            self.files.insert(file.to_owned());
        }
    }

    /// Returns the files on whose content the result depends, as they were opened.
    pub fn files(&self) -> &BTreeSet<PathBuf> {
        &self.files
    }

    /// Returns all problems, in the order of discovery.
    pub fn problems(&self) -> &[Problem] {
        &self.problems
    }

    /// Returns only the errors.
    pub fn errors(&self) -> impl Iterator<Item = &Problem> {
        self.problems.iter().filter(|problem| problem.severity == Severity::Error)
    }

    /// Turns every warning into an error.
    pub fn warnings_are_errors(&mut self) {
        for problem in &mut self.problems {
            if problem.severity == Severity::Warning {
                problem.severity = Severity::Error;
            }
        }
    }

    /// Returns true if there are errors, so that the description cannot be used.
    pub fn has_errors(&self) -> bool {
        self.errors().next().is_some()
    }
}
