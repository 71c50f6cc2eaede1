//! What a measured ratio means beside the recorded one.

/// How far a ratio may fall below its record, or rise above it before the record is called out of date.
pub const TOLERANCE: f64 = 0.10;
/// The same for a record from another processor of the same SIMD level: other caches, other clock rates for wide
/// instructions.
pub const TOLERANCE_ELSEWHERE: f64 = 0.35;

/// What is said about a ratio.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// Within the tolerance.
    Holds,
    /// More than the tolerance above its record: time to record anew, so that it is held.
    Better,
    /// More than the tolerance below its record, or not a number.
    Falls,
    /// Nobody has recorded it at this SIMD level.
    NotRecorded,
}

/// Judges a ratio, more of which is better.
pub fn judge(ratio: f64, recorded: Option<f64>, tolerance: f64) -> Verdict {
    match recorded {
        None => Verdict::NotRecorded,
        Some(recorded) if ratio > recorded * (1.0 + tolerance) => Verdict::Better,
        Some(recorded) if ratio >= recorded * (1.0 - tolerance) => Verdict::Holds,
        Some(_) => Verdict::Falls,
    }
}

impl core::fmt::Display for Verdict {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.pad(match self {
            Self::Holds => "holds",
            Self::Better => "better: record it",
            Self::Falls => "FALLS",
            Self::NotRecorded => "not recorded",
        })
    }
}
