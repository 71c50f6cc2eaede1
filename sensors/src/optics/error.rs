//! What may be wrong with a lens.

/// Why parameters are not a lens.
///
/// ```
/// use belvedere_sensors::optics::{Eucm, Intrinsics};
/// let intrinsics = Intrinsics { fx: 300.0, fy: 300.0, cx: 319.5, cy: 239.5, skew: 0.0 };
/// assert_eq!(
///     Eucm::new(intrinsics, 1.5, 1.0).unwrap_err().to_string(),
///     "lens parameter `alpha` is 1.5 and must be from 0 to 1: compare value and order of the parameters with \
///      the camera's calibration"
/// );
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum LensError {
    /// A parameter is out of its range, or not a finite number.
    Parameter {
        /// Which.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it may be, in words that follow "must be".
        allowed: &'static str,
    },
    /// A number of distortion coefficients that OpenCV's order does not have.
    CoefficientCount {
        /// How many there are.
        count: usize,
    },
}

impl core::fmt::Display for LensError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Parameter { name, value, allowed } => write!(
                f,
                "lens parameter `{name}` is {value} and must be {allowed}: compare value and order of the \
                 parameters with the camera's calibration"
            ),
            Self::CoefficientCount { count } => write!(
                f,
                "the lens has {count} distortion coefficients and must have 0, 4, 5, 8, 12 or 14 \
                 (k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4 τx τy): fill up with zeros"
            ),
        }
    }
}

impl core::error::Error for LensError {}

/// Refuses a value for which `holds` is not true; comparisons with NaN never are.
pub(super) fn require(
    name: &'static str,
    value: f64,
    holds: bool,
    allowed: &'static str,
) -> Result<(), LensError> {
    if holds { Ok(()) } else { Err(LensError::Parameter { name, value, allowed }) }
}

/// Refuses NaN and infinities.
pub(super) fn require_finite(name: &'static str, value: f64) -> Result<(), LensError> {
    require(name, value, value.is_finite(), "a finite number")
}

/// Most columns and rows of a grid. Columns of a ring are counted on over its seam, up to twice its width, in 16 bits.
pub const MAX_GRID_SIZE: u32 = 32_767;

/// Why rules of directions are no grid of rays.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum GridError {
    /// Columns, rows, width or height: not 1 to [`MAX_GRID_SIZE`].
    Size {
        /// Which of them.
        parameter: &'static str,
        /// What it is.
        value: u32,
    },
    /// An angle or a step is NaN or infinite.
    Number {
        /// Which of them.
        parameter: &'static str,
        /// What it is.
        value: f64,
    },
}

impl core::fmt::Display for GridError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match *self {
            Self::Size { parameter, value } => {
                write!(f, "{parameter} of the grid is {value}; it must be 1 to {MAX_GRID_SIZE}")
            }
            Self::Number { parameter, value } => {
                write!(f, "{parameter} of the grid is {value}; it must be a finite number")
            }
        }
    }
}

impl core::error::Error for GridError {}
