//! Exceptions that name the argument.

use pyo3::PyErr;
use pyo3::exceptions::PyValueError;
use std::fmt::Display;

/// Returns a `ValueError` with this message.
pub(crate) fn value_error(words: impl Display) -> PyErr {
    PyValueError::new_err(words.to_string())
}

/// Returns a `ValueError` about an argument.
pub(crate) fn of(argument: &str, words: impl Display) -> PyErr {
    value_error(format_args!("{argument}: {words}"))
}
