//! Problems found in the user's files, each with its place and its remedy.

use super::shorten::shortened;
use super::suggestion::{did_you_mean, did_you_mean_or};
use std::borrow::Cow;
use std::collections::{BTreeSet, HashSet};
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The number of problems after which no further names are suggested.
const CROWD: usize = 200;

/// A place in a file.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
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
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
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
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
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
    /// Writes `file:line: error: what; remedy`, a form that editors know from compilers. Long texts are shortened.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}: {}", self.source, self.severity, shortened(&self.what))?;
        if self.remedy.is_empty() { Ok(()) } else { write!(f, "; {}", shortened(&self.remedy)) }
    }
}

impl std::error::Error for Problem {}

/// All problems found while loading, in the order of discovery, and all files that were read.
#[derive(Debug, Default, Clone)]
pub struct Diagnostics {
    problems: Vec<Problem>,
    /// The same problems, for finding repetitions.
    known: HashSet<Problem>,
    /// What was reported by [`Self::warning_once`].
    once: HashSet<String>,
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

    /// Adds a warning, unless the same was reported by this method for another place.
    pub fn warning_once(&mut self, source: &Source, what: impl Into<String>, remedy: impl Into<String>) {
        let what = what.into();
        if !self.once.contains(&what) {
            self.warning(source, what.as_str(), remedy);
            self.once.insert(what);
        }
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
        self.add(Problem { severity, source: source.clone(), what: what.into(), remedy: remedy.into() });
    }

    /// Adds a problem that was found elsewhere. Long texts that it quotes are shortened.
    pub fn add(&mut self, mut problem: Problem) {
        for text in [&mut problem.what, &mut problem.remedy] {
            if let Cow::Owned(short) = shortened(text) {
                *text = short;
            }
        }
        // A macro that is called twice, or a file that is included twice, repeats its problems. Each is reported once.
        if self.known.insert(problem.clone()) {
            self.problems.push(problem);
        }
    }

    /// Returns the question "did you mean …?" for an unknown name, if there is a probable candidate. `None` as well if there
    /// are so many problems that nobody reads suggestions for further ones: each compares the name with all candidates, so
    /// that a file of many unknown names would take quadratic time.
    pub fn did_you_mean<'a>(
        &self,
        name: &str,
        candidates: impl IntoIterator<Item = &'a str>,
    ) -> Option<String> {
        if self.is_crowded() { None } else { did_you_mean(name, candidates) }
    }

    /// Returns the same question followed by another remedy; only the remedy if there is no question.
    pub fn did_you_mean_or<'a>(
        &self,
        name: &str,
        candidates: impl IntoIterator<Item = &'a str>,
        otherwise: &str,
    ) -> String {
        if self.is_crowded() { otherwise.to_owned() } else { did_you_mean_or(name, candidates, otherwise) }
    }

    /// Returns true if there are too many problems for suggestions. Check this before collecting candidates.
    pub fn is_crowded(&self) -> bool {
        self.problems.len() > CROWD
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

    /// Turns every warning into an error, which says that it is one because of `--strict`.
    pub fn warnings_are_errors(&mut self) {
        for problem in &mut self.problems {
            if problem.severity == Severity::Warning {
                problem.severity = Severity::Error;
                self.known.insert(problem.clone());
                problem.what.push_str(" (without --strict, a warning)");
            }
        }
    }

    /// Removes the problems that do not fulfil a condition.
    pub fn retain(&mut self, condition: impl Fn(&Problem) -> bool) {
        self.problems.retain(&condition);
        self.known.retain(condition);
    }

    /// Returns true if there are errors, so that the description cannot be used.
    pub fn has_errors(&self) -> bool {
        self.errors().next().is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Instant;

    fn problems(count: u32) -> Diagnostics {
        let mut diagnostics = Diagnostics::default();
        for line in 0..count {
            diagnostics.warning(&Source::new("f", line), "what", "remedy");
        }
        diagnostics
    }

    #[test]
    fn each_problem_is_reported_once() {
        let mut diagnostics = problems(2);
        diagnostics.warning(&Source::new("f", 1), "what", "remedy");
        diagnostics.add(diagnostics.problems()[0].clone());
        assert_eq!(diagnostics.problems().len(), 2);
        diagnostics.error(&Source::new("f", 1), "what", "remedy");
        assert_eq!(diagnostics.problems().len(), 3);
        // What was a warning is now the error that it becomes.
        let mut strict = problems(1);
        strict.warnings_are_errors();
        strict.error(&Source::new("f", 0), "what", "remedy");
        assert_eq!(strict.problems().len(), 1);
    }

    /// If each problem were compared with all others, eight times as many would take 64 times as long.
    #[test]
    fn the_time_for_a_problem_does_not_depend_on_their_number() {
        let time = |count: u32| {
            let start = Instant::now();
            assert_eq!(problems(count).problems().len(), count as usize);
            start.elapsed()
        };
        assert!((0..5).any(|_| time(16_000) < 24 * time(2_000)));
    }

    #[test]
    fn a_problem_quotes_little_of_a_long_text() {
        let long = "x".repeat(60_000);
        let mut diagnostics = Diagnostics::default();
        diagnostics.error(
            &Source::new("f", 1),
            format!("the name '{long}' is not '{long}'"),
            format!("write '{long}'"),
        );
        let told = &diagnostics.problems()[0];
        assert!(told.what.starts_with("the name 'xxx") && told.what.contains("xxx' is not 'xxx"), "{told}");
        assert!(told.to_string().len() < 900, "{told}");
        // So does one that no loader has added.
        let other = Problem { what: long.clone(), remedy: long, ..told.clone() };
        assert!(other.to_string().len() < 3000, "{other}");
    }
}
