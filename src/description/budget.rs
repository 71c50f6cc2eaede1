//! One budget for what files unfold into.
//!
//! Macros, properties, includes and instances make much of little: thirty doublings of a short text are a gigabyte. So
//! whoever unfolds a file counts here what comes of it, and how deep it is in it, and ends with one clear error long
//! before the stack or the memory does.

use std::fmt;

/// Elements: far more than robots and worlds have.
const MAX_ELEMENTS: usize = 500_000;
/// Bytes of text, or of triangles.
const MAX_BYTES: usize = 256 << 20;
/// Levels: elements in elements, calls in calls, files in files, together. A thread's two megabytes bear more.
const MAX_DEPTH: usize = 300;

/// What has been spent on one file.
#[derive(Debug, Default)]
pub(super) struct Budget {
    elements: usize,
    bytes: usize,
    depth: usize,
}

/// More was asked for than there is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Spent {
    Elements,
    Bytes,
    Depth,
}

impl Spent {
    /// What the user can do.
    pub(super) const REMEDY: &str = "look for what contains or repeats itself too often";
}

impl fmt::Display for Spent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Elements => write!(f, "this unfolds into more than {MAX_ELEMENTS} elements"),
            Self::Bytes => write!(f, "this unfolds into more than {} MB", MAX_BYTES >> 20),
            Self::Depth => write!(f, "this is nested more than {MAX_DEPTH} deep"),
        }
    }
}

impl Budget {
    /// Takes so many elements of so many bytes in all.
    pub(super) fn take(&mut self, elements: usize, bytes: usize) -> Result<(), Spent> {
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

    /// Goes so many levels down. After an error no level was taken.
    pub(super) fn enter(&mut self, levels: usize) -> Result<(), Spent> {
        self.has_room_below(levels)?;
        self.depth += levels;
        Ok(())
    }

    /// Comes back up from what was entered.
    pub(super) fn leave(&mut self, levels: usize) {
        self.depth = self.depth.saturating_sub(levels);
    }

    /// Whether so many levels below this one are allowed.
    pub(super) fn has_room_below(&self, levels: usize) -> Result<(), Spent> {
        if self.depth.saturating_add(levels) > MAX_DEPTH { Err(Spent::Depth) } else { Ok(()) }
    }
}
