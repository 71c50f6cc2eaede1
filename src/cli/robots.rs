//! Which robots run: `--robot`, `--name`, `--pose`.

use super::place::{PLACE, Place};
use crate::description::diagnostics::Source;
use crate::description::load::{LoadOptions, default_robot_name, load_robot, xacro_argument};
use crate::description::model::Model;
use crate::description::package::PackagePath;
use crate::description::suggestion::nearest;
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
    /// The robot: a .urdf or .xacro file, or the name of one in turtlebot_description/robots; may be repeated, for
    /// several robots; none, for a world that has its own
    /// [default: kobuki_nostack_camera, or what TURTLEBOT_BASE, _STACKS and _3D_SENSOR choose]
    #[arg(long, value_name = "FILE|NAME|none")]
    robot: Vec<PathBuf>,
    /// Arguments of the robots' xacro, for its $(arg NAME)
    #[arg(value_name = "NAME:=VALUE", value_parser = argument)]
    xacro_args: Vec<(String, String)>,
    /// What the robot is called in the world, one for each --robot in their order; of several, its topics are
    /// /NAME/... and its frames NAME/... [default: as its description has it, numbered if several are called so]
    #[arg(long, value_name = "NAME", value_parser = model_name)]
    name: Vec<String>,
    /// Where it starts in metres, and its heading in degrees, one for each --robot in their order: X,Y or X,Y,YAW on the
    /// floor, X,Y,Z,YAW above it [default: the origin; several stand in a row, 1 m apart]
    #[arg(long, value_name = PLACE, allow_hyphen_values = true)]
    pose: Vec<Place>,
}

/// What is given for no robot at all.
const NONE: &str = "none";

/// Commands that this program was built without: their names are those of the features that bring them.
const LEFT_OUT: &[&str] = if cfg!(feature = "link") { &[] } else { &["link"] };

/// An argument of xacro; what is none may be a command that was misspelt.
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
    /// Arguments of the robots' xacro.
    pub(super) fn xacro_args(&self) -> &[(String, String)] {
        &self.xacro_args
    }

    /// Adds one before the others.
    pub(super) fn add_argument(&mut self, argument: (String, String)) {
        self.xacro_args.insert(0, argument);
    }

    /// Takes a file or name as `--robot` does.
    pub(super) fn add(&mut self, robot: PathBuf) {
        self.robot.push(robot);
    }

    /// Takes no robot, as `--robot none` does.
    pub(super) fn be_none(&mut self) {
        self.robot = vec![NONE.into()];
    }

    /// Whether no robot is asked for.
    pub(super) fn is_none(&self) -> bool {
        self.robot.iter().any(|robot| robot == Path::new(NONE))
    }

    /// Whether our own robot runs, because none was asked for.
    pub(super) fn are_ours(&self) -> bool {
        self.robot.is_empty()
    }

    /// Loads them, in the order of their names, so that a run does not depend on the order in which they were given.
    /// `taken` are the names of the world's models.
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
                format!("--robot {NONE} stands beside other robots"),
                "leave it out, or give it alone",
            );
            return Vec::new();
        }
        for (option, count) in [("--name", self.name.len()), ("--pose", self.pose.len())] {
            if count > files.len() {
                diagnostics.error(
                    &Source::new("the command line", 0),
                    format!("{count} {option} for {} robots", files.len()),
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

    /// Numbers robots that are called alike by their files; refuses names that were given and are taken.
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
            if taken.contains(model.name.as_str()) {
                diagnostics.error(
                    &model.source,
                    format!("a model of the world is called '{}'", model.name),
                    "give the robot another --name",
                );
            }
        }
    }
}
