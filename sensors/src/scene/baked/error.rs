//! Errors of baked scenes.

use crate::scene::SceneFault;

/// The reason why bytes are not a valid baked scene.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum BakedError {
    /// The bytes do not begin at a multiple of 64.
    Misaligned,
    /// The bytes do not start like a baked scene, or come from a machine with another byte order.
    NotAScene {
        /// The number that the bytes start with.
        magic: u64,
    },
    /// The bytes were written by another version of this library.
    Version {
        /// The format version of the bytes.
        found: u32,
        /// The format version that can be read.
        known: u32,
    },
    /// The number of bytes is wrong.
    Length {
        /// Number of bytes that there are.
        have: u64,
        /// Number of bytes that there should be.
        need: u64,
    },
    /// A section does not start where the previous one ends, or ends after the last byte.
    Section {
        /// Name of the section.
        section: &'static str,
        /// Offset at which the table says it starts, in bytes.
        offset: u64,
        /// Number of elements that the table says it has.
        count: u64,
    },
    /// The sections do not form a valid scene.
    Scene(SceneFault),
}

impl core::fmt::Display for BakedError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Misaligned => f.write_str("a baked scene must lie at a multiple of 64 bytes in memory"),
            Self::NotAScene { magic } => write!(
                f,
                "these bytes begin with {magic:#018x}, not as a baked scene of this machine's byte order does"
            ),
            Self::Version { found, known } => {
                write!(
                    f,
                    "the baked scene is of version {found}, and only {known} can be read: bake it again"
                )
            }
            Self::Length { have, need } => {
                write!(f, "the baked scene has {have} bytes, and should have {need}: was it cut off?")
            }
            Self::Section { section, offset, count } => write!(
                f,
                "section `{section}` of the baked scene cannot lie at byte {offset} with {count} elements"
            ),
            Self::Scene(fault) => fault.fmt(f),
        }
    }
}

impl core::error::Error for BakedError {}

impl From<SceneFault> for BakedError {
    fn from(fault: SceneFault) -> Self {
        Self::Scene(fault)
    }
}
