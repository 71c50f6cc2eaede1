//! `belvedere check`: how a robot or world file is interpreted, and every problem in it.

mod counted;
mod folder;
mod robot;
mod streams;
mod world;

use super::error::CliError;
use super::follow::print_line;
use super::simulated::SimulatedArgs;
use crate::description::load::{self, LoadOptions, is_world, robot_names, world_names};
use crate::description::model::{Model, World};
use crate::description::package::PackagePath;
use crate::description::shell::quoted;
use crate::description::text::count;
use crate::description::{Diagnostics, Problem, Severity, Source};
use crate::rig::RigError;
use crate::simulation::{Simulation, SimulationError, SpawnOptions};
use std::path::{Path, PathBuf};
use streams::Streams;

#[allow(clippy::doc_markdown, reason = "the words are help text, shown as they stand")]
/// Show how `belvedere run` interprets its robots and its world, and every problem in their files.
///
/// Accepts the arguments of `run` that choose what is simulated, and opens the same streams. Prints the world's models,
/// lights and physics; each robot's tree of links and joints; the sensors with all their parameters after defaults and
/// plugins; the streams of each sensor; and every problem as `file:line: severity: problem; remedy`. The exit code is 1
/// if there are errors.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "Examples:
  belvedere check
  belvedere check kobuki_hexagons_kinect
  belvedere check my_robot.urdf.xacro --package-path ~/catkin_ws/src
  belvedere check my_robot.urdf.xacro use_camera:=true --package-path ~/catkin_ws/src
  belvedere check my.world
  belvedere check my.world --robot none            (a world that has its own robot)
  belvedere check my_robot.urdf.xacro --world my.world
  belvedere check --all ~/catkin_ws/src                (a line for each robot, model and world)")]
pub struct CheckArgs {
    /// A .urdf, .xacro, .world or .sdf file, or the name of a shipped robot or world: a world is used like --world, a
    /// robot like --robot
    #[arg(value_name = "FILE|NAME")]
    pub file: Option<PathBuf>,
    /// Check every robot, model and world in this folder and those below it: a line for each .urdf, .xacro, .sdf and
    /// .world file, and a summary. Each is checked alone: robots in an empty world, and worlds without a robot, unless
    /// --world or --robot is given. The folder is also searched for packages, and for the models of model://. The exit
    /// code is 1 if a file has errors
    #[arg(long, value_name = "FOLDER")]
    pub all: Option<PathBuf>,
    #[command(flatten)]
    simulated: SimulatedArgs,
}

/// Runs the command.
///
/// # Errors
/// [`CliError::Checked`] with every error in the files; failures of standard output.
pub fn run(args: &CheckArgs) -> Result<(), CliError> {
    if let Some(folder) = &args.all {
        return folder::check_all(folder, args);
    }
    let mut diagnostics = Diagnostics::default();
    for line in diagnose(args, &args.simulated.packages(), &mut diagnostics) {
        print_line(&line)?;
    }
    // main() prints the errors that the command returns, and then the counts.
    for problem in diagnostics.problems().iter().filter(|problem| problem.severity != Severity::Error) {
        print_line(&problem.to_string())?;
    }
    if diagnostics.has_errors() {
        let errors = diagnostics.errors().cloned().collect();
        return Err(CliError::Checked { errors, counts: counts(&diagnostics) });
    }
    print_line(&counts(&diagnostics))
}

/// Returns the report, and adds every problem to `diagnostics`.
fn diagnose(args: &CheckArgs, packages: &PackagePath, diagnostics: &mut Diagnostics) -> Vec<String> {
    let simulated = args.simulated(packages, diagnostics);
    let report = simulated.map(|simulated| report(&simulated, packages, diagnostics));
    args.simulated.judge(diagnostics);
    report.unwrap_or_default()
}

/// Returns the number of errors, warnings and notes in words.
fn counts(diagnostics: &Diagnostics) -> String {
    let counted = |severity, word: &str| {
        let number = diagnostics.problems().iter().filter(|problem| problem.severity == severity).count();
        (number > 0).then(|| count(number as u64, word))
    };
    let errors = counted(Severity::Error, "error");
    let others = [counted(Severity::Warning, "warning"), counted(Severity::Note, "note")];
    let others = others.into_iter().flatten().collect::<Vec<_>>().join(" and ");
    match (errors, others.is_empty()) {
        (None, true) => "no problems".to_owned(),
        (Some(errors), true) => errors,
        (errors, false) => format!("{}, {others}", errors.as_deref().unwrap_or("no errors")),
    }
}

impl CheckArgs {
    /// Returns the arguments of the run that is checked: the file is its world or its robot.
    fn simulated(&self, packages: &PackagePath, diagnostics: &mut Diagnostics) -> Option<SimulatedArgs> {
        let mut simulated = self.simulated.clone();
        let Some(file) = &self.file else { return Some(simulated) };
        let options = LoadOptions {
            packages: packages.clone(),
            rules: simulated.rules(),
            xacro_args: simulated.robots.xacro_args().to_vec(),
        };
        let is_name = name_of(file).is_some_and(|name| is_known(name, packages));
        if file.is_dir() && !is_name {
            diagnostics.error(
                &Source::new(file, 0),
                "this is a folder",
                format!("name a file in it, or check all files: belvedere check --all {}", quoted(file)),
            );
            return None;
        }
        if is_unknown_name(file, packages) {
            // This reports the unknown name and suggests similar names of robots and worlds.
            let _ = load::load(file, &options, diagnostics);
            return None;
        }
        let (option, is_given) = if is_world(file, &options) {
            ("--world", simulated.world.replace(file.clone()).is_some())
        } else {
            ("--robot", !simulated.robots.are_ours())
        };
        if is_given && option == "--robot" && simulated.robots.is_none() {
            diagnostics.error(
                &Source::new("the command line", 0),
                format!("'{}' is a robot, but --robot none is given", file.display()),
                "leave out --robot none, which is for worlds that have their own robot",
            );
            return None;
        }
        if is_given {
            diagnostics.error(
                &Source::new("the command line", 0),
                format!("'{}' is given together with {option}", file.display()),
                format!("leave one of them out, or give both with {option}"),
            );
            return None;
        }
        if option == "--robot" {
            simulated.robots.add(file.clone());
        }
        Some(simulated)
    }
}

/// Returns true if the argument is a name, but not that of a shipped robot or world.
fn is_unknown_name(file_or_name: &Path, packages: &PackagePath) -> bool {
    name_of(file_or_name).is_some_and(|name| !file_or_name.is_file() && !is_known(name, packages))
}

/// Returns the argument as a name, unless it can only be a path.
fn name_of(file_or_name: &Path) -> Option<&str> {
    file_or_name.to_str().filter(|name| !name.contains(['/', '.']))
}

/// Returns true for the name of a shipped robot or world.
fn is_known(name: &str, packages: &PackagePath) -> bool {
    let has = |names: Vec<String>| names.iter().any(|known| known == name);
    has(robot_names(packages)) || has(world_names(packages))
}

/// Returns the report on the world and each robot.
fn report(args: &SimulatedArgs, packages: &PackagePath, diagnostics: &mut Diagnostics) -> Vec<String> {
    let (world, robots) = args.load(packages, diagnostics);
    let (streams, numbers) = rehearse(args, world.as_ref(), &robots, diagnostics);
    // If only a robot was given, the default world is not reported.
    let world = world.filter(|_| args.world.is_some() || args.robots.are_ours());
    let mut lines =
        world.map(|world| world::report(&world, &streams, args.gazebo_compat)).unwrap_or_default();
    for (index, (model, options)) in robots.iter().enumerate() {
        let number = numbers.get(index).copied().unwrap_or_default();
        lines.extend(robot::report(model, &options.namespace, number, &streams, args.gazebo_compat));
    }
    lines
}

/// Makes the simulation that `belvedere run` makes, opens its streams as a server does, and returns them with the
/// robots' numbers. Problems and notes are added to `diagnostics`. Files with errors have no streams.
fn rehearse(
    args: &SimulatedArgs,
    world: Option<&World>,
    robots: &[(Model, SpawnOptions)],
    diagnostics: &mut Diagnostics,
) -> (Streams, Vec<usize>) {
    let Some(world) = world.filter(|_| !diagnostics.has_errors()) else {
        return (Streams::unknown(), Vec::new());
    };
    let mut notes = Vec::new();
    let opened = (|| {
        let mut simulation = Simulation::builder(world.clone()).gazebo_compat(args.gazebo_compat).build()?;
        let spawned = args.spawn(&mut simulation, robots);
        let opened = spawned.and_then(|ids| Ok((simulation.streams(args.truth)?, ids)));
        notes.extend_from_slice(simulation.notes());
        opened
    })();
    for note in notes {
        diagnostics.add(note);
    }
    match opened {
        Ok((rig, ids)) => (Streams::of(rig), ids.iter().map(|id| id.index()).collect()),
        Err(error) => {
            let source = robots.first().map_or(&world.source, |(robot, _)| &robot.source);
            diagnostics.add(problem(error, source));
            (Streams::unknown(), Vec::new())
        }
    }
}

/// Converts an error to a problem of the file: at its own line if it has one, else at `source`.
fn problem(error: SimulationError, source: &Source) -> Problem {
    match error {
        SimulationError::Description(problem) | SimulationError::Rig(RigError::Description(problem)) => {
            problem
        }
        other => Problem {
            severity: Severity::Error,
            source: source.clone(),
            what: other.to_string(),
            remedy: String::new(),
        },
    }
}
