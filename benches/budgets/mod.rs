//! `benches/budgets.toml`: the recorded ratios, and the best ratios that were ever measured.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::PathBuf;

type Map<V> = BTreeMap<String, V>;

/// Ratios of one SIMD level: by group (a scene, or `frames`), then by entry.
pub type Ratios = Map<Map<f64>>;

/// The file.
#[derive(Debug, Default, Clone, PartialEq, Serialize, Deserialize)]
pub struct Budgets {
    /// Instructions that callgrind counts, by benchmark.
    #[serde(default)]
    pub instructions: Map<u64>,
    /// The processor on which the records of each SIMD level were measured.
    #[serde(default)]
    pub processors: Map<String>,
    /// The best ratios that were ever measured, by processor and SIMD level.
    #[serde(default)]
    pub best: Map<Map<Ratios>>,
    /// Why a best is lower than it was, by processor, SIMD level, group and entry.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub lowered: Map<Map<Map<Map<Lowered>>>>,
    /// The entries that vary more than others even with several copies, by group and entry.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub noise: Map<Map<Noise>>,
    /// The records, by SIMD level.
    #[serde(flatten)]
    pub levels: Map<Ratios>,
}

/// Why a best is lower than it was.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lowered {
    /// The highest value it has had.
    pub best: f64,
    /// The lowest value that is allowed now; `None` if the entry was removed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub now: Option<f64>,
    /// What was gained in return.
    pub why: String,
}

/// A tolerance of an entry other than a tenth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Noise {
    /// As a fraction of the ratio.
    pub tolerance: f64,
    /// The measurements that justify it.
    pub why: String,
}

/// How far a record may be below the best of its processor.
const RECORD_BELOW_BEST: f64 = 0.10;
/// The largest error of rounding a ratio to three digits, as a fraction.
const ROUNDING: f64 = 0.005;
/// The largest tolerance.
const MOST_NOISE: f64 = 0.25;

const HEAD: &str = "\
# Limits of `cargo bench --bench gate` and `cargo bench --bench counts`; benches/README.md explains them.
#
# Ratios by SIMD level; more is better. `cargo bench --bench gate -- --record` writes the records, and raises the bests of
# the processor that it runs on. It never lowers a best. If you lower or remove a best by hand, add a table that says what
# was gained in return, without `now` if the entry was removed:
#   [lowered.\"the processor\".avx512.S1.R1]
#   best = 120.0
#   now = 105.0
#   why = \"Distances are exact to the last bit since 0123abc.\"
# [noise.group.entry] widens the tolerance of 10 % for an entry that varies even with several copies, and gives the
# measurements that justify it.
#
# The bests of family 25 model 17 are the highest ratios that this file has had for each entry: those of 2026-11-27 are
# medians over copies of the executable, older ones were entered by hand and measured with one copy. Older ratios are left
# out if the entry measured something else: those of refit_S3 before 5edb6a5 were compared with a build by parry3d, those
# of moving_500 before 9970624 cast other rays, and those of R5 before 8bb9168 cast a million rays.
# Some frames were first measured on another or a busy machine (depth_64x64, depth_kinect, device_rgb, the lenses,
# rolling_shutter, scan_beams, scan_moving, truth). Their bests are an eighth lower than those measurements, by hand.
# Instructions are copied by hand from the output of `cargo bench --bench counts`.

";

impl Budgets {
    /// Returns the path of the file.
    pub fn path() -> PathBuf {
        [env!("CARGO_MANIFEST_DIR"), "benches", "budgets.toml"].iter().collect()
    }

    /// Reads the file. If there is none, there are no records.
    ///
    /// # Errors
    /// A text that names the file and the fault.
    pub fn read() -> Result<Self, String> {
        let path = Self::path();
        match std::fs::read_to_string(&path) {
            Ok(text) => Self::parse(&text).map_err(|error| format!("{}: {error}", path.display())),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(Self::default()),
            Err(error) => Err(format!("{}: {error}", path.display())),
        }
    }

    /// # Errors
    /// A text that names line or entry, fault and remedy.
    pub fn parse(text: &str) -> Result<Self, String> {
        let budgets: Self = toml::from_str(text).map_err(|error| error.to_string())?;
        budgets.check_ratios()?;
        budgets.check_records()?;
        budgets.check_lowered()?;
        budgets.check_noise()?;
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
    /// If something cannot be expressed in TOML.
    pub fn to_text(&self) -> Result<String, String> {
        Ok(format!("{HEAD}{}", toml::to_string(self).map_err(|error| error.to_string())?))
    }

    /// Returns the recorded ratio.
    pub fn ratio(&self, level: &str, group: &str, entry: &str) -> Option<f64> {
        self.levels.get(level)?.get(group)?.get(entry).copied()
    }

    /// Returns the best ratio that was ever measured on a processor.
    pub fn best(&self, processor: &str, level: &str, group: &str, entry: &str) -> Option<f64> {
        self.best.get(processor)?.get(level)?.get(group)?.get(entry).copied()
    }

    /// Returns the wider tolerance of an entry, if it has one.
    pub fn noise(&self, group: &str, entry: &str) -> Option<&Noise> {
        self.noise.get(group)?.get(entry)
    }

    /// Records a ratio, to three digits, as the best of its processor if it is better, and as the record of the
    /// level if that is of this processor or there is none.
    pub fn record(&mut self, processor: &str, level: &str, group: &str, entry: &str, ratio: f64) {
        let digits = (2.0 - ratio.log10().floor()).clamp(0.0, 6.0) as usize;
        let rounded: f64 = format!("{ratio:.digits$}").parse().unwrap_or(ratio);
        if self.processors.entry(level.into()).or_insert_with(|| processor.into()) == processor {
            let groups = self.levels.entry(level.into()).or_default();
            groups.entry(group.into()).or_default().insert(entry.into(), rounded);
        }
        let levels = self.best.entry(processor.into()).or_default();
        let groups = levels.entry(level.into()).or_default();
        let best = groups.entry(group.into()).or_default().entry(entry.into()).or_insert(rounded);
        *best = best.max(rounded);
    }

    /// Checks that all ratios are numbers above 0, because nothing can fall below others.
    fn check_ratios(&self) -> Result<(), String> {
        let all = self.best.values().chain([&self.levels]).flat_map(flat);
        match all.into_iter().find(|(.., ratio)| !(ratio.is_finite() && **ratio > 0.0)) {
            Some((level, group, entry, ratio)) => {
                Err(format!("[{level}.{group}] {entry} = {ratio}: a ratio must be more than 0"))
            }
            None => Ok(()),
        }
    }

    /// Checks that each record is within the tolerance of the best of its processor, and no better.
    fn check_records(&self) -> Result<(), String> {
        for (level, group, entry, &record) in flat(&self.levels) {
            let processor = self.processors.get(level).map_or("", String::as_str);
            let Some(best) = self.best(processor, level, group, entry) else { continue };
            let at = format!("[{level}.{group}] {entry} = {record}");
            if record > best {
                return Err(format!(
                    "{at} is above the best of its processor, {best}: raise the best in \
                     [best.\"{processor}\".{level}.{group}] to it"
                ));
            }
            let below = self.noise(group, entry).map_or(RECORD_BELOW_BEST, |noise| noise.tolerance);
            if record < best * (1.0 - below) * (1.0 - ROUNDING) {
                return Err(format!(
                    "{at} is more than {:.0} % below the best of its processor, {best}: raise the record, or lower the \
                     best and say in [lowered.\"{processor}\".{level}.{group}.{entry}] what was gained in return",
                    100.0 * below
                ));
            }
        }
        Ok(())
    }

    /// Checks that each table of `lowered` has a reason, and that the best is not lower than it says.
    fn check_lowered(&self) -> Result<(), String> {
        for (processor, levels) in &self.lowered {
            for (level, group, entry, line) in flat(levels) {
                let at = format!("[lowered.\"{processor}\".{level}.{group}.{entry}]");
                if line.why.trim().is_empty() {
                    return Err(format!("{at}: `why` is empty: say what was gained in return"));
                }
                if !line.now.is_none_or(|now| 0.0 < now && now < line.best) {
                    return Err(format!("{at}: `now` must be more than 0 and less than `best`"));
                }
                let best = self.best(processor, level, group, entry);
                let remedy = match (best, line.now) {
                    (Some(best), Some(now)) if best < now => {
                        "set `now` to it and say in `why` what was gained"
                    }
                    (Some(_), None) => {
                        "the line says that the entry is gone: add `now` to it, or take out the best"
                    }
                    (None, Some(_)) => "add the best, or take `now` out if the entry is gone",
                    _ => continue,
                };
                let best = best.map_or("not there".into(), |best| best.to_string());
                return Err(format!("{at}: the best is {best}: {remedy}"));
            }
        }
        Ok(())
    }

    /// Checks that each wider tolerance has a reason and is not too wide.
    fn check_noise(&self) -> Result<(), String> {
        for (group, entries) in &self.noise {
            for (entry, Noise { tolerance, why }) in entries {
                if why.trim().is_empty() {
                    return Err(format!(
                        "[noise.{group}.{entry}]: `why` is empty: say how much was seen, and where"
                    ));
                }
                if !(RECORD_BELOW_BEST < *tolerance && *tolerance <= MOST_NOISE) {
                    return Err(format!(
                        "[noise.{group}.{entry}] tolerance = {tolerance}: it must be more than {RECORD_BELOW_BEST}, \
                         which all entries have, and at most {MOST_NOISE}: take out an entry that varies more"
                    ));
                }
            }
        }
        Ok(())
    }
}

/// Returns every value with its level, group and entry.
fn flat<V>(levels: &Map<Map<Map<V>>>) -> impl Iterator<Item = (&str, &str, &str, &V)> {
    levels.iter().flat_map(|(level, groups)| {
        groups.iter().flat_map(move |(group, entries)| {
            entries.iter().map(move |(entry, value)| (level.as_str(), group.as_str(), entry.as_str(), value))
        })
    })
}
