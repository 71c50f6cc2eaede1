//! Checks of lens parameters.

use crate::ParameterError;

/// Rejects a value for which `holds` is false; comparisons with NaN are always false.
pub(super) fn require(
    name: &'static str,
    value: f64,
    holds: bool,
    rule: &'static str,
) -> Result<(), ParameterError> {
    ParameterError::require("lens", name, value, holds, rule)
}

/// Rejects NaN and infinities.
pub(super) fn require_finite(name: &'static str, value: f64) -> Result<(), ParameterError> {
    require(name, value, value.is_finite(), "a finite number")
}

/// The greatest number of columns or rows of a grid. The columns of a ring are counted past its seam, up to twice its
/// width, in 16 bits.
pub const MAX_GRID_SIZE: u32 = 32_767;
