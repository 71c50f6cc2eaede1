//! What may be wrong with a lens.

use crate::ParameterError;

/// Refuses a value for which `holds` is not true; comparisons with NaN never are.
pub(super) fn require(
    name: &'static str,
    value: f64,
    holds: bool,
    rule: &'static str,
) -> Result<(), ParameterError> {
    ParameterError::require("lens", name, value, holds, rule)
}

/// Refuses NaN and infinities.
pub(super) fn require_finite(name: &'static str, value: f64) -> Result<(), ParameterError> {
    require(name, value, value.is_finite(), "a finite number")
}

/// Most columns and rows of a grid. Columns of a ring are counted on over its seam, up to twice its width, in 16 bits.
pub const MAX_GRID_SIZE: u32 = 32_767;
