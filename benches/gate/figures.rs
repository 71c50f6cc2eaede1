//! The measurements of one copy of the program, the combined figures of several, and the gain of one SIMD level over
//! another.

use serde::{Deserialize, Serialize};

/// How the figures of an entry are printed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Unit {
    /// Million units of work per second.
    Rate,
    /// Milliseconds per unit of work.
    Time,
}

/// One line of what a copy prints.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Report {
    /// An entry was measured.
    Measured(Figures),
    /// An entry could not be measured, with the reason.
    LeftOut { group: String, name: String, why: String },
}

/// The figures of an entry.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// A scene, or `frames`.
    pub group: String,
    /// The name in its group.
    pub name: String,
    /// The unit in which both sides are printed.
    pub unit: Unit,
    /// The name of the other side.
    pub peer: String,
    /// Our seconds per unit of work.
    pub ours_s: f64,
    /// The other side's seconds per unit of work.
    pub theirs_s: f64,
    /// How many times as fast we are.
    pub ratio: f64,
}

impl Figures {
    /// Returns group and name.
    pub fn title(&self) -> String {
        format!("{}/{}", self.group, self.name)
    }

    /// Returns true if both are of the same entry.
    pub fn is_same_entry(&self, other: &Self) -> bool {
        (&self.group, &self.name) == (&other.group, &other.name)
    }

    /// Returns true if the other side is parry3d, which is equally fast at every SIMD level.
    pub fn is_beside_parry(&self) -> bool {
        self.peer.contains("parry3d")
    }
}

/// An entry as measured by several copies: the medians of the figures, and the lowest and highest ratio.
#[derive(Debug, Clone, PartialEq)]
pub struct Pooled {
    /// The medians; each is taken separately.
    pub figures: Figures,
    /// The lowest and the highest ratio.
    pub range: [f64; 2],
}

impl Pooled {
    /// Returns the spread of the copies, as a fraction of the median.
    pub fn spread(&self) -> f64 {
        (self.range[1] - self.range[0]) / self.figures.ratio
    }
}

/// Combines the figures of copies, in the order in which the entries first appear.
pub fn pool(copies: &[Vec<Figures>]) -> Vec<Pooled> {
    let mut pooled: Vec<Pooled> = Vec::new();
    for first in copies.iter().flatten() {
        if pooled.iter().any(|done| done.figures.is_same_entry(first)) {
            continue;
        }
        let same = || copies.iter().flatten().filter(|other| other.is_same_entry(first));
        let ratios = || same().map(|figures| figures.ratio);
        let figures = Figures {
            ours_s: median(same().map(|figures| figures.ours_s).collect()),
            theirs_s: median(same().map(|figures| figures.theirs_s).collect()),
            ratio: median(ratios().collect()),
            ..first.clone()
        };
        let range = [ratios().fold(f64::INFINITY, f64::min), ratios().fold(0.0, f64::max)];
        pooled.push(Pooled { figures, range });
    }
    pooled
}

/// Returns how many times as fast one SIMD level is as another, by group: the geometric mean over the entries that are
/// compared with parry3d. A group is left out unless all its entries in `whole` were measured at both levels.
pub fn gains(wide: &[Pooled], narrow: &[Pooled], whole: &[Figures]) -> Vec<(String, f64)> {
    let mut groups: Vec<&String> = whole.iter().map(|entry| &entry.group).collect();
    groups.dedup();
    let gain = |group: &String| {
        let entries: Vec<_> =
            whole.iter().filter(|entry| entry.group == *group && entry.is_beside_parry()).collect();
        let ratio = |level: &[Pooled], entry: &Figures| {
            level.iter().find(|pooled| pooled.figures.is_same_entry(entry)).map(|pooled| pooled.figures.ratio)
        };
        let logarithms: Option<Vec<f64>> =
            entries.iter().map(|entry| Some((ratio(wide, entry)? / ratio(narrow, entry)?).ln())).collect();
        let logarithms = logarithms.filter(|logarithms| !logarithms.is_empty())?;
        Some((group.clone(), (logarithms.iter().sum::<f64>() / logarithms.len() as f64).exp()))
    };
    groups.into_iter().filter_map(gain).collect()
}

/// Returns the median: the middle value, or the mean of the middle two.
pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    match values.len() {
        0 => f64::NAN,
        count if count % 2 == 1 => values[count / 2],
        count => 0.5 * (values[count / 2 - 1] + values[count / 2]),
    }
}
