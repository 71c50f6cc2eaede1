//! Errors of building a table.

/// The greatest number of columns or rows of a table.
pub(super) const MOST: u32 = 16_384;

/// The reason why a table of rays cannot be built.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum TableError {
    /// There are no rays, or more than 16384 columns or rows.
    Size {
        /// Number of columns.
        width: u32,
        /// Number of rows.
        height: u32,
    },
    /// There is no ray: all pixels are outside the domain of the lens.
    Empty,
    /// The number of directions is not the number of rays.
    Count {
        /// Columns × rows.
        expected: usize,
        /// Number of directions given.
        found: usize,
    },
    /// A direction has a coordinate that is not finite.
    NotFinite {
        /// Column of the ray.
        column: u32,
        /// Row of the ray.
        row: u32,
    },
    /// The length of a direction differs from 1 by more than 1e-4.
    NotUnit {
        /// Column of the ray.
        column: u32,
        /// Row of the ray.
        row: u32,
        /// Length of the direction.
        length: f64,
    },
    /// The buffer has fewer cache lines than [`RayTable::required_len`](crate::optics::RayTable::required_len).
    BufferTooSmall {
        /// Number of cache lines that are needed.
        required: usize,
        /// Number of cache lines of the buffer.
        found: usize,
    },
}

impl core::fmt::Display for TableError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match *self {
            Self::Size { width, height } => {
                write!(f, "a table of {width} × {height} rays: there must be 1 to {MOST} columns and rows")
            }
            Self::Empty => f.write_str("no pixel sees anything: the lens maps none of them"),
            Self::Count { expected, found } => {
                write!(f, "{found} directions for {expected} rays: give one for each, row after row")
            }
            Self::NotFinite { column, row } => {
                write!(f, "the direction at column {column}, row {row} is not finite")
            }
            Self::NotUnit { column, row, length } => {
                write!(
                    f,
                    "the direction at column {column}, row {row} has a length of {length}: normalise it to 1"
                )
            }
            Self::BufferTooSmall { required, found } => {
                write!(f, "a buffer of {found} cache lines: {required} are needed")
            }
        }
    }
}

impl core::error::Error for TableError {}

pub(super) fn check_size(width: u32, height: u32) -> Result<(), TableError> {
    let size = 1..=MOST;
    if size.contains(&width) && size.contains(&height) {
        Ok(())
    } else {
        Err(TableError::Size { width, height })
    }
}
