//! The command line, for `python -m belvedere`.

use pyo3::prelude::*;
use std::ffi::OsString;

/// Runs a command line, whose first word is the name of the program, and returns its exit code. It handles Ctrl-C itself.
#[pyfunction]
pub(crate) fn run_words(py: Python<'_>, words: Vec<OsString>) -> u8 {
    py.detach(|| belvedere::cli::run_words(&words))
}
