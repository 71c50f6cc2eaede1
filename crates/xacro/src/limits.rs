//! Limits on the values of expressions.

use super::fault::Fault;

/// The greatest size of one value in bytes.
const MAX_SIZE: usize = 4_000_000;

/// Returns the size of a value that is to be made.
///
/// # Errors
/// A value that would be too large.
pub(super) fn sized(size: usize) -> Result<usize, Fault> {
    if size > MAX_SIZE {
        let what = format!("a text or list grows beyond {MAX_SIZE} bytes");
        return Err(Fault::new(what, "look for a property that joins or repeats others too often"));
    }
    Ok(size)
}

/// The fault of an integer that does not fit into 64 bits.
pub(super) fn too_large() -> Fault {
    Fault::new("an integer grows beyond 64 bits", "write one of the numbers with a decimal point")
}
