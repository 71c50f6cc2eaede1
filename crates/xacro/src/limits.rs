//! Limits on the values of expressions, and on the work of computing them.

use super::fault::Fault;
use std::cell::Cell;

/// The greatest size of one value in bytes.
const MAX_SIZE: usize = 4_000_000;
/// The greatest length of an integer in bits. Python prints no integer with more than 4300 digits.
const MAX_BITS: u64 = 14_000;
/// The greatest number of steps of all expressions of a file: they take a second or two.
const MAX_WORK: usize = 10_000_000;

/// Returns the size of a value that is to be created.
///
/// # Errors
/// If the value would be too large.
pub(super) fn sized(size: usize) -> Result<usize, Fault> {
    if size > MAX_SIZE {
        let what = format!("a text or list grows beyond {MAX_SIZE} bytes, or is nested too deeply");
        return Err(Fault::new(what, "look for an expression that joins, repeats or nests others too often"));
    }
    Ok(size)
}

/// Checks the length of an integer that is to be created.
///
/// # Errors
/// If the integer would be too long.
pub(super) fn bits(bits: u64) -> Result<(), Fault> {
    if bits > MAX_BITS { Err(too_large()) } else { Ok(()) }
}

/// Returns the fault of an integer that is too long.
pub(super) fn too_large() -> Fault {
    let what = format!("an integer grows beyond {MAX_BITS} bits");
    Fault::new(what, "write one of the numbers with a decimal point")
}

/// Counts the steps of all expressions of one expansion.
#[derive(Debug, Default)]
pub(super) struct Work(Cell<usize>);

impl Work {
    /// Counts steps.
    ///
    /// # Errors
    /// The limit that is exceeded.
    pub(super) fn take(&self, steps: usize) -> Result<(), Fault> {
        self.0.set(self.0.get().saturating_add(steps));
        if self.0.get() <= MAX_WORK {
            return Ok(());
        }
        let what = format!("the expressions take more than {MAX_WORK} steps");
        Err(Fault::new(what, "look for a comprehension or lambda that repeats itself too often"))
    }
}
