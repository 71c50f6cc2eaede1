//! `benches/budgets.toml`: what was measured when it was last recorded.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Ratios of one SIMD level: by group (a scene, or `frames`), then by entry.
pub type Ratios = BTreeMap<String, BTreeMap<String, f64>>;

/// The file.
#[derive(Debug, Default, Clone, PartialEq, Serialize, Deserialize)]
pub struct Budgets {
    /// Instructions that callgrind counts, by benchmark.
    #[serde(default)]
    pub instructions: BTreeMap<String, u64>,
    /// What the ratios of each SIMD level were measured on.
    #[serde(default)]
    pub processors: BTreeMap<String, String>,
    /// Ratios of other processors, by processor and SIMD level, where an entry differs by more than the tolerance.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub elsewhere: BTreeMap<String, BTreeMap<String, Ratios>>,
    /// By SIMD level.
    #[serde(flatten)]
    pub levels: BTreeMap<String, Ratios>,
}

const HEAD: &str = "\
# What `cargo bench --bench gate` and `cargo bench --bench counts` hold the code to; benches/README.md explains.
# Ratios, more of which is better, by SIMD level: written by `cargo bench --bench gate -- --record`.
# Those of frames that were new on another or a busy machine are, by hand, an eighth lower than measured there.
# Those of rings (R2) at avx512 are, by hand, the lowest that were seen on two machines.
# Those of other processors (elsewhere), by hand, are the lowest that were measured there.
# Instructions, by hand from what `cargo bench --bench counts` prints.

";

impl Budgets {
    /// Where the file is.
    pub fn path() -> PathBuf {
        [env!("CARGO_MANIFEST_DIR"), "benches", "budgets.toml"].iter().collect()
    }

    /// Reads the file; without one there are no records.
    ///
    /// # Errors
    /// A text that names the file, and what is wrong with it.
    pub fn read() -> Result<Self, String> {
        let path = Self::path();
        match std::fs::read_to_string(&path) {
            Ok(text) => Self::parse(&text).map_err(|error| format!("{}: {error}", path.display())),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(Self::default()),
            Err(error) => Err(format!("{}: {error}", path.display())),
        }
    }

    /// # Errors
    /// A text that names line and fault.
    pub fn parse(text: &str) -> Result<Self, String> {
        let budgets: Self = toml::from_str(text).map_err(|error| error.to_string())?;
        for (level, groups) in budgets.elsewhere.values().chain([&budgets.levels]).flatten() {
            for (group, entries) in groups {
                if let Some((entry, ratio)) =
                    entries.iter().find(|(_, ratio)| !(ratio.is_finite() && **ratio > 0.0))
                {
                    return Err(format!("[{level}.{group}] {entry} = {ratio}: a ratio must be more than 0"));
                }
            }
        }
        Ok(budgets)
    }

    /// # Errors
    /// A text that names the file.
    pub fn write(&self) -> Result<(), String> {
        let path = Self::path();
        let text = self.to_text()?;
        std::fs::write(&path, text).map_err(|error| format!("{}: {error}", path.display()))
    }

    /// # Errors
    /// When something cannot be expressed in TOML.
    pub fn to_text(&self) -> Result<String, String> {
        Ok(format!("{HEAD}{}", toml::to_string(self).map_err(|error| error.to_string())?))
    }

    /// The recorded ratio.
    pub fn ratio(&self, level: &str, group: &str, entry: &str) -> Option<f64> {
        self.levels.get(level)?.get(group)?.get(entry).copied()
    }

    /// The ratio that was recorded on a processor that is not that of the other records.
    pub fn ratio_elsewhere(&self, processor: &str, level: &str, group: &str, entry: &str) -> Option<f64> {
        self.elsewhere.get(processor)?.get(level)?.get(group)?.get(entry).copied()
    }

    /// Records a ratio, to three digits.
    pub fn record(&mut self, level: &str, group: &str, entry: &str, ratio: f64) {
        let digits = (2.0 - ratio.log10().floor()).clamp(0.0, 6.0) as usize;
        let rounded = format!("{ratio:.digits$}").parse().unwrap_or(ratio);
        let groups = self.levels.entry(level.into()).or_default();
        groups.entry(group.into()).or_default().insert(entry.into(), rounded);
    }
}
