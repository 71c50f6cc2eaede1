//! Why a table cannot be made.

/// Columns or rows of a table, at most.
pub(super) const MOST: u32 = 16_384;

/// What is wrong with a table of rays.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum TableError {
    /// There are no rays, or more than 16384 columns or rows.
    Size {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// Not a single ray: all pixels lie beyond what the lens maps.
    Empty,
    /// Not one direction a ray.
    Count {
        /// Columns × rows.
        expected: usize,
        /// Directions.
        found: usize,
    },
    /// A direction has a coordinate that is not finite.
    NotFinite {
        /// Of the ray.
        column: u32,
        /// Of the ray.
        row: u32,
    },
    /// A direction's length is not 1 to within 1e-4.
    NotUnit {
        /// Of the ray.
        column: u32,
        /// Of the ray.
        row: u32,
        /// What it is.
        length: f64,
    },
    /// Fewer cache lines than [`RayTable::required_len`](crate::optics::RayTable::required_len).
    BufferTooSmall {
        /// Cache lines that are needed.
        required: usize,
        /// Those that there are.
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
