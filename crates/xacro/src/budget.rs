//! Limits on what a file may expand to.
//!
//! Macros, properties, includes and instances multiply their content: thirty doublings of a short text are a gigabyte.
//! Code that expands a file counts its output and its depth here, and ends with one clear error long before the stack
//! overflows or the memory is full.

use std::fmt;

/// The greatest number of elements, which is far more than robots and worlds have.
const MAX_ELEMENTS: usize = 500_000;
/// The greatest number of bytes of text, or of triangles.
const MAX_BYTES: usize = 256 << 20;
/// The greatest number of levels: nested elements, macro calls and included files together. The two megabytes of a
/// thread's stack are enough for more.
const MAX_DEPTH: usize = 300;

/// Counts what one file has expanded to so far.
#[derive(Debug, Default)]
pub struct Budget {
    elements: usize,
    bytes: usize,
    depth: usize,
}

/// The limit that was exceeded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Spent {
    /// The number of elements.
    Elements,
    /// The number of bytes.
    Bytes,
    /// The number of levels.
    Depth,
}

impl Spent {
    /// The remedy that error messages name.
    pub const REMEDY: &str = "look for what contains or repeats itself too often";
}

impl fmt::Display for Spent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Elements => write!(f, "this expands to more than {MAX_ELEMENTS} elements"),
            Self::Bytes => write!(f, "this expands to more than {} MB", MAX_BYTES >> 20),
            Self::Depth => write!(f, "this is nested more than {MAX_DEPTH} deep"),
        }
    }
}

impl Budget {
    /// Adds elements, and the bytes that they take together.
    ///
    /// # Errors
    /// The limit that is exceeded.
    pub fn take(&mut self, elements: usize, bytes: usize) -> Result<(), Spent> {
        self.elements = self.elements.saturating_add(elements);
        self.bytes = self.bytes.saturating_add(bytes);
        if self.elements > MAX_ELEMENTS {
            Err(Spent::Elements)
        } else if self.bytes > MAX_BYTES {
            Err(Spent::Bytes)
        } else {
            Ok(())
        }
    }

    /// Descends a number of levels.
    ///
    /// # Errors
    /// The limit that is exceeded; no level is entered then.
    pub fn enter(&mut self, levels: usize) -> Result<(), Spent> {
        self.has_room_below(levels)?;
        self.depth += levels;
        Ok(())
    }

    /// Leaves levels that were entered.
    pub fn leave(&mut self, levels: usize) {
        self.depth = self.depth.saturating_sub(levels);
    }

    /// Checks that a number of levels below this one are allowed.
    ///
    /// # Errors
    /// The limit that would be exceeded.
    pub fn has_room_below(&self, levels: usize) -> Result<(), Spent> {
        if self.depth.saturating_add(levels) > MAX_DEPTH { Err(Spent::Depth) } else { Ok(()) }
    }
}
