//! The options that choose robots: `--robot`, `--name`, `--pose`.

use super::place::{PLACE, Place};
use crate::description::diagnostics::Source;
use crate::description::load::{LoadOptions, default_robot_name, load_robot, xacro_argument};
use crate::description::model::Model;
use crate::description::package::PackagePath;
use crate::description::suggestion::nearest;
use crate::description::text::count;
use crate::description::xacro::unused_argument;
use crate::description::{Diagnostics, Rules};
use crate::entities::model_name;
use crate::simulation::SpawnOptions;
use belvedere_sensors::Pose;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

#[allow(clippy::doc_markdown, reason = "the words are help text, shown as they stand")]
/// The robots of a run.
#[derive(Clone, Debug, clap::Args)]
pub struct RobotArgs {
    /// The robot: a .urdf, .xacro or .sdf file, or the name of one in turtlebot_description/robots; may be repeated, for
    /// several robots; none, for a world that has its own robot [default: kobuki_nostack_camera, or the choice of
    /// TURTLEBOT_BASE, _STACKS and _3D_SENSOR]
    #[arg(long, value_name = "FILE|NAME|none")]
    robot: Vec<PathBuf>,
    /// xacro arguments of the robots, for $(arg NAME)
    #[arg(value_name = "NAME:=VALUE", value_parser = argument)]
    xacro_args: Vec<(String, String)>,
    /// Name of the robot in the world, one for each --robot in their order; with several robots, topics are /NAME/...
    /// and frames NAME/... [default: the name in its description, numbered if several have the same name]
    #[arg(long, value_name = "NAME", value_parser = model_name)]
    name: Vec<String>,
    /// Start position in metres, and heading in degrees, one for each --robot in their order: X,Y or X,Y,YAW on the
    /// floor, X,Y,Z,YAW above it [default: the origin; several robots stand in a row, 1 m apart]
    #[arg(long, value_name = PLACE, allow_hyphen_values = true)]
    pose: Vec<Place>,
    /// Whether the same arguments are for many files, of which some do not have them.
    #[arg(skip)]
    are_for_many: bool,
}

/// The value of `--robot` for no robot at all.
const NONE: &str = "none";

/// Commands of features that this program was built without. A command and its feature have the same name.
const LEFT_OUT: &[&str] = if cfg!(feature = "link") { &[] } else { &["link"] };

/// Parses a xacro argument. Other text may be a misspelt command, and the message suggests it.
pub(super) fn argument(text: &str) -> Result<(String, String), String> {
    xacro_argument(text).map_err(|why| {
        if LEFT_OUT.contains(&text) {
            return format!("this belvedere was built without '{text}'; build it with --features {text}");
        }
        let near = nearest(text, super::command_names());
        let near = near.map(|near| format!("did you mean the command '{near}'? ")).unwrap_or_default();
        format!("{near}{why}")
    })
}

impl RobotArgs {
    /// Returns the xacro arguments of the robots.
    pub(super) fn xacro_args(&self) -> &[(String, String)] {
        &self.xacro_args
    }

    /// Adds a xacro argument before the others.
    pub(super) fn add_argument(&mut self, argument: (String, String)) {
        self.xacro_args.insert(0, argument);
    }

    /// Adds a file or name as `--robot` does.
    pub(super) fn add(&mut self, robot: PathBuf) {
        self.robot.push(robot);
    }

    /// Says nothing of xacro arguments that a robot does not have: they are for many files.
    pub(super) fn be_for_many(&mut self) {
        self.are_for_many = true;
    }

    /// Takes no robot, as `--robot none` does.
    pub(super) fn be_none(&mut self) {
        self.robot = vec![NONE.into()];
    }

    /// Returns true if no robot is to run.
    pub(super) fn is_none(&self) -> bool {
        self.robot.iter().any(|robot| robot == Path::new(NONE))
    }

    /// Returns true if the default robot runs, because none was given.
    pub(super) fn are_ours(&self) -> bool {
        self.robot.is_empty()
    }

    /// Loads the robots and sorts them by name, so that a run does not depend on the order of the arguments. `taken`
    /// are the names of the world's models.
    pub(super) fn load(
        &self,
        packages: &PackagePath,
        rules: Rules,
        taken: &HashSet<&str>,
        diagnostics: &mut Diagnostics,
    ) -> Vec<(Model, SpawnOptions)> {
        let files = match &self.robot[..] {
            [] => vec![default_robot_name().into()],
            [robot] if *robot == Path::new(NONE) => Vec::new(),
            robots => robots.to_vec(),
        };
        if self.is_none() && !files.is_empty() {
            diagnostics.error(
                &Source::new("the command line", 0),
                format!("--robot {NONE} is combined with other robots"),
                "remove it, or remove the other robots",
            );
            return Vec::new();
        }
        for (option, given) in [("--name", self.name.len()), ("--pose", self.pose.len())] {
            if given > files.len() {
                diagnostics.error(
                    &Source::new("the command line", 0),
                    format!("{given} {option} for {}", count(files.len() as u64, "robot")),
                    format!("give {option} once for each --robot, in their order"),
                );
            }
        }
        let options = LoadOptions { packages: packages.clone(), rules, xacro_args: self.xacro_args.clone() };
        let mut models: Vec<(Model, Pose)> = Vec::new();
        for (index, file) in files.iter().enumerate() {
            let Some(mut model) = load_robot(file, &options, diagnostics) else { continue };
            if let Some(name) = self.name.get(index) {
                model.name.clone_from(name);
            }
            let row = Place::on_floor(0.0, index as f64);
            models.push((model, self.pose.get(index).copied().unwrap_or(row).pose()));
        }
        self.forgive_arguments(&files, diagnostics);
        self.tell_apart(&mut models, taken, diagnostics);
        let is_one = files.len() == 1;
        let mut robots: Vec<_> = models
            .into_iter()
            .map(|(model, world_from_model)| {
                let namespace = if is_one { String::new() } else { model.name.clone() };
                let name = model.name.clone();
                (model, SpawnOptions { name, namespace, world_from_model, is_robot: Some(true) })
            })
            .collect();
        robots.sort_by(|(_, one), (_, other)| one.name.cmp(&other.name));
        robots
    }

    /// Removes the warnings about xacro arguments that one robot does not have and another one has: all robots are given
    /// all of them. Adds one for each argument if there is no robot.
    fn forgive_arguments(&self, files: &[PathBuf], diagnostics: &mut Diagnostics) {
        for (name, _) in &self.xacro_args {
            let what = unused_argument(name);
            if files.is_empty() && !self.are_for_many {
                diagnostics.warning(
                    &Source::new("the command line", 0),
                    &*what,
                    "leave it out: there is no robot",
                );
            }
            let lacking = diagnostics.problems().iter().filter(|problem| problem.what == what).count();
            let different: HashSet<&PathBuf> = files.iter().collect();
            if lacking < different.len() || self.are_for_many {
                diagnostics.retain(|problem| problem.what != what);
            }
        }
    }

    /// Numbers robots whose files give them the same name; reports an error if a name given with --name is taken.
    fn tell_apart(&self, models: &mut [(Model, Pose)], taken: &HashSet<&str>, diagnostics: &mut Diagnostics) {
        let mut count: HashMap<String, usize> = HashMap::new();
        for (model, _) in &*models {
            *count.entry(model.name.clone()).or_default() += 1;
        }
        let mut number: HashMap<String, usize> = HashMap::new();
        for (index, (model, _)) in models.iter_mut().enumerate() {
            let (is_given, name) = (index < self.name.len(), model.name.clone());
            if count[&name] > 1 && is_given {
                diagnostics.error(
                    &model.source,
                    format!("two robots are called '{name}'"),
                    "give each its own --name",
                );
            } else if count[&name] > 1 {
                let number = number.entry(name.clone()).or_default();
                *number += 1;
                model.name = format!("{name}_{number}");
            }
            if self.are_for_many && !is_given {
                // A file that is checked by itself shares no world with a model of its name.
                while taken.contains(model.name.as_str()) {
                    model.name.push('_');
                }
            } else if taken.contains(model.name.as_str()) {
                diagnostics.error(
                    &model.source,
                    format!("a model of the world is called '{}'", model.name),
                    "give the robot another --name",
                );
            }
        }
    }
}
