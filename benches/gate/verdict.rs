//! Judges a measured ratio by its reference.

use super::budgets::Budgets;

/// The fraction by which a ratio may fall below the best of its processor, or rise above it before it should be
/// recorded.
pub const TOLERANCE: f64 = 0.10;
/// The same for a record from another processor of the same SIMD level, which has other caches and other clock rates
/// for wide instructions.
pub const TOLERANCE_ELSEWHERE: f64 = 0.35;

/// The reference of a ratio.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mark {
    /// The reference ratio.
    pub ratio: f64,
    /// The tolerance, as a fraction of the ratio.
    pub tolerance: f64,
    /// The source of the ratio.
    pub source: Source,
}

/// The source of a reference.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// The best that was ever measured on this processor.
    Best,
    /// The record of the SIMD level, from this processor.
    Record,
    /// The record of the SIMD level, from another processor.
    RecordElsewhere,
}

/// Returns the reference of an entry: the best of this processor if there is one, otherwise the record.
pub fn mark(budgets: &Budgets, processor: &str, level: &str, group: &str, entry: &str) -> Option<Mark> {
    let (ratio, source) = match budgets.best(processor, level, group, entry) {
        Some(best) => (best, Source::Best),
        None if budgets.processors.get(level).is_some_and(|recorded| recorded == processor) => {
            (budgets.ratio(level, group, entry)?, Source::Record)
        }
        None => (budgets.ratio(level, group, entry)?, Source::RecordElsewhere),
    };
    let least = if source == Source::RecordElsewhere { TOLERANCE_ELSEWHERE } else { TOLERANCE };
    let noise = budgets.noise(group, entry).map_or(least, |noise| noise.tolerance);
    Some(Mark { ratio, tolerance: least.max(noise), source })
}

/// The verdict on a ratio.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// Within the tolerance.
    Holds,
    /// More than the tolerance above its reference: it should be recorded, or a later loss goes unnoticed.
    Better,
    /// More than the tolerance below its reference, or not a number.
    Falls,
    /// There is no record at this SIMD level.
    NotRecorded,
}

/// Judges a ratio, more of which is better.
pub fn judge(ratio: f64, mark: Option<Mark>) -> Verdict {
    let Some(mark) = mark else { return Verdict::NotRecorded };
    if ratio > mark.ratio * (1.0 + mark.tolerance) {
        Verdict::Better
    } else if ratio >= mark.ratio * (1.0 - mark.tolerance) {
        Verdict::Holds
    } else {
        Verdict::Falls
    }
}

impl core::fmt::Display for Mark {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let source = match self.source {
            Source::Best => "best",
            Source::Record | Source::RecordElsewhere => "record",
        };
        f.pad(&format!("{source} {:.2}×", self.ratio))
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
