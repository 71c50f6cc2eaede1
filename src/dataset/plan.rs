//! [`Plan`]: reads and checks a plan's file, and reports each error with its line.

mod identity;
mod placement;
mod randomize;
mod tables;
mod text;

pub(super) use identity::{Identity, hex};
pub(super) use randomize::{Randomization, Ranges};

use super::DatasetError;
use crate::description::diagnostics::Source;
use crate::description::encoding::{NotRead, utf_8};
use crate::description::file;
use crate::description::load::{LoadOptions, load_robot, load_world};
use crate::description::model::{Model, World};
use crate::description::package::PackagePath;
use crate::description::text::count;
use crate::description::{Diagnostics, Problem, Rules, Severity};
use belvedere_sensors::Pose;
use placement::{Random, Route};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::{Path, PathBuf};
use tables::{PlanFile, classes, listed, random, route, sensors};
use text::Text;

/// Default number of samples per shard.
const SAMPLES_PER_SHARD: u64 = 100;
/// Most samples, because their numbers have eight digits.
const MOST_SAMPLES: u64 = 99_999_999;
/// The truth channel that needs the previous frame.
pub(super) const FLOW: &str = "flow_back";

/// The definition of a data set.
#[derive(Debug, Clone)]
pub struct Plan {
    /// The plan's file.
    pub(super) source: PathBuf,
    /// SHA-256 of everything that determines the bytes: the plan, the files that it refers to, the version of this
    /// program.
    pub(super) identity: Identity,
    pub(super) worlds: Vec<World>,
    /// The name of each world in the plan.
    pub(super) world_names: Vec<String>,
    pub(super) robot: Model,
    pub(super) sensors: Vec<SensorPlan>,
    pub(super) seeds: Vec<u64>,
    /// Listed poses, `world_from_robot`.
    pub(super) listed: Vec<Pose>,
    pub(super) route: Option<Route>,
    pub(super) random: Option<Random>,
    /// Limits of random looks, if looks are randomized.
    pub(super) randomization: Option<Randomization>,
    /// Names of classes, by their numbers.
    pub(super) classes: BTreeMap<u32, String>,
    samples_per_shard: u64,
}

/// A sensor's stream that is stored in each sample.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SensorPlan {
    /// Beginning of its files' names, as in `NAME.png`.
    pub name: String,
    /// Its stream, with a leading slash.
    pub topic: String,
    /// Truth channels that are stored with it.
    pub truth: Vec<String>,
    /// True if visible objects are listed, with boxes.
    pub labels: bool,
    /// Its place in the plan's file.
    pub(super) source: Source,
}

/// One sample of a plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sample {
    /// Its number, from 0.
    pub index: u64,
    /// Index of the world.
    pub world: usize,
    /// Index of the seed.
    pub seed: usize,
    /// Index of the pose.
    pub pose: u64,
}

impl Plan {
    /// Reads a plan, with the worlds and the robot that it names: files in the same folder, or names found in
    /// `packages`.
    ///
    /// # Errors
    /// Errors in the plan or in these files.
    pub fn read(path: &Path, packages: &PackagePath) -> Result<Self, DatasetError> {
        let bytes =
            file::read(path).map_err(|source| DatasetError::Input { path: path.to_owned(), source })?;
        let text = utf_8(bytes, path).map_err(|NotRead { what, remedy }| {
            let (severity, source) = (Severity::Error, Source::new(path, 0));
            DatasetError::Description(vec![Problem { severity, source, what, remedy }])
        })?;
        let mut diagnostics = Diagnostics::default();
        let plan = Self::parse(&Text { path, text: &text }, packages, &mut diagnostics);
        for problem in diagnostics.problems() {
            if problem.severity == Severity::Warning {
                tracing::warn!("{problem}");
            }
        }
        let errors: Vec<_> = diagnostics.errors().cloned().collect();
        plan.filter(|_| errors.is_empty()).ok_or(DatasetError::Description(errors))
    }

    fn parse(text: &Text<'_>, packages: &PackagePath, diagnostics: &mut Diagnostics) -> Option<Self> {
        let file: PlanFile = match toml::from_str(text.text) {
            Ok(file) => file,
            Err(error) => {
                let source = text.source(&error.span().unwrap_or(0..0));
                let what = error.message().replace('\n', ", ");
                diagnostics.error(&source, what, "see docs/datasets.md for the format of plans");
                return None;
            }
        };
        let folder = text.path.parent().unwrap_or(Path::new(""));
        let beside = |name: &str| match folder.join(name) {
            path if path.is_file() => path.to_string_lossy().into_owned(),
            _ => name.to_owned(),
        };
        let (mut worlds, mut world_names) = (Vec::new(), Vec::new());
        for name in file.worlds.get_ref() {
            let rules = Rules::default();
            let Some(world) = load_world(beside(name.get_ref()), packages, rules, diagnostics) else {
                continue;
            };
            worlds.push(world);
            world_names.push(name.get_ref().clone());
        }
        if file.worlds.get_ref().is_empty() {
            let source = text.source(&file.worlds.span());
            diagnostics.error(
                &source,
                "worlds is empty",
                "name at least one, such as worlds = [\"playground\"]",
            );
        }
        let options =
            LoadOptions { packages: packages.clone(), rules: Rules::default(), xacro_args: Vec::new() };
        let robot = load_robot(beside(file.robot.get_ref()), &options, diagnostics);
        let mut files = diagnostics.files().clone();
        files.extend(identity::pictures(&worlds, robot.as_ref()).cloned());
        let randomization = file
            .randomize
            .as_ref()
            .map(|table| randomize::randomization(text, table, &worlds, robot.as_ref(), diagnostics));
        let seeds = file.seeds.as_ref().map_or(vec![1], |seeds| seeds.get_ref().clone());
        if let Some(given) = &file.seeds
            && (seeds.is_empty() || seeds.iter().collect::<BTreeSet<_>>().len() < seeds.len())
        {
            let what = format!("seeds = {seeds:?} is empty or has a seed twice");
            diagnostics.error(
                &text.source(&given.span()),
                what,
                "write each seed once, such as seeds = [1, 2]",
            );
        }
        let samples_per_shard = file.samples_per_shard.as_ref().map_or(SAMPLES_PER_SHARD, |n| *n.get_ref());
        if let Some(given) = file.samples_per_shard.as_ref().filter(|given| *given.get_ref() == 0) {
            diagnostics.error(&text.source(&given.span()), "samples_per_shard = 0", "write 1 or more");
        }
        let sensors = sensors(text, &file.sensors, diagnostics);
        let plan = Self {
            source: text.path.to_owned(),
            identity: Identity::new(text.text, &files, &identity::roots(text.path, packages)),
            worlds,
            world_names,
            robot: robot?,
            sensors,
            seeds,
            listed: listed(text, &file.poses.get_ref().list, diagnostics),
            route: file.poses.get_ref().path.as_ref().and_then(|path| route(text, path, diagnostics)),
            random: file.poses.get_ref().random.as_ref().and_then(|table| random(text, table, diagnostics)),
            randomization,
            classes: classes(text, &file.classes, diagnostics),
            samples_per_shard: samples_per_shard.max(1),
        };
        let samples = plan.poses().checked_mul((plan.worlds.len() * plan.seeds.len()) as u64);
        if samples.is_none_or(|samples| samples == 0 || samples > MOST_SAMPLES) && !diagnostics.has_errors() {
            let what = samples.map_or("far too many samples".to_owned(), |samples| count(samples, "sample"));
            let remedy = format!("request 1 to {MOST_SAMPLES}, with list, path or random in [poses]");
            diagnostics.error(&text.source(&file.poses.span()), what, remedy);
        }
        Some(plan)
    }

    /// Returns the number of poses for each world and seed.
    pub(super) fn poses(&self) -> u64 {
        let route = self.route.as_ref().map_or(0, |route| route.count);
        let random = self.random.as_ref().map_or(0, |random| random.count);
        (self.listed.len() as u64).saturating_add(route).saturating_add(random)
    }

    /// Returns the number of samples.
    pub fn samples(&self) -> u64 {
        self.poses() * (self.worlds.len() * self.seeds.len()) as u64
    }

    /// Returns the number of shards.
    pub fn shards(&self) -> u64 {
        self.samples().div_ceil(self.samples_per_shard)
    }

    /// Returns the shard of a sample.
    pub(super) fn shard_of(&self, sample: u64) -> u64 {
        sample / self.samples_per_shard
    }

    /// Returns the numbers of a shard's samples.
    pub fn samples_of(&self, shard: u64) -> Range<u64> {
        let first = shard * self.samples_per_shard;
        first..(first + self.samples_per_shard).min(self.samples())
    }

    /// Returns a sample by its index: poses vary fastest, then seeds, then worlds.
    pub fn sample(&self, index: u64) -> Sample {
        let (poses, seeds) = (self.poses(), self.seeds.len() as u64);
        Sample {
            index,
            world: (index / poses / seeds) as usize,
            seed: (index / poses % seeds) as usize,
            pose: index % poses,
        }
    }

    /// Returns the streams that are stored in each sample.
    pub fn sensors(&self) -> &[SensorPlan] {
        &self.sensors
    }
}
