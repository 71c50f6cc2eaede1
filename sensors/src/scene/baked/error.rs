//! What may be wrong with a baked scene.

use crate::scene::SceneFault;

/// Why bytes are not a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum BakedError {
    /// The bytes do not begin at a multiple of 64.
    Misaligned,
    /// They do not begin as a baked scene does, or come from a machine of another byte order.
    NotAScene {
        /// The number that they begin with.
        magic: u64,
    },
    /// Another version of this library wrote them.
    Version {
        /// Theirs.
        found: u32,
        /// The one that can be read.
        known: u32,
    },
    /// There are fewer bytes, or more, than there should be.
    Length {
        /// Bytes that there are.
        have: u64,
        /// Bytes that there should be.
        need: u64,
    },
    /// A section does not begin where the one before ends, or ends behind the last byte.
    Section {
        /// Which.
        section: &'static str,
        /// Where it is said to begin, in bytes.
        offset: u64,
        /// How many elements it is said to have.
        count: u64,
    },
    /// The sections are not a scene.
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
