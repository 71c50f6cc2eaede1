//! `belvedere check`: what a robot or world file is understood to be, and everything that is wrong with it.

mod counted;
mod robot;
mod streams;
mod world;

use super::error::CliError;
use super::follow::print_line;
use super::sensor_models::Devices;
use crate::description::load::{self, Described, LoadOptions, default_robot_name, xacro_argument};
use crate::description::mesh::UpAxis;
use crate::description::model::{Model, World};
use crate::description::models::package_path;
use crate::description::{Diagnostics, Problem, Rules, Severity, Source};
use crate::rig::RigError;
use crate::simulation::{Simulation, SimulationError, SpawnOptions};
use std::path::PathBuf;
use streams::Streams;

#[allow(clippy::doc_markdown, reason = "the words are help text, shown as they stand")]
/// Show what a robot or world file is understood to be, and everything that is wrong with it.
///
/// Prints the tree of links with their joints, the sensors with all their parameters after defaults and plugins, the
/// streams that `belvedere run` publishes of them, and every problem as `file:line: severity: what; remedy`. Of a world
/// it prints models, lights and physics. The exit code is 1 if there are errors.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "Examples:
  belvedere check
  belvedere check kobuki_hexagons_kinect
  belvedere check my_robot.urdf.xacro --package-path ~/catkin_ws/src
  belvedere check my_robot.urdf.xacro use_camera:=true --package-path ~/catkin_ws/src
  belvedere check my.world")]
pub struct CheckArgs {
    /// A .urdf, .xacro, .world or .sdf file, or the name of a robot or world of ours
    /// [default: the robot that `belvedere run` takes]
    #[arg(value_name = "FILE|NAME")]
    pub file: Option<PathBuf>,
    /// Arguments of the robot's xacro, for its $(arg NAME)
    #[arg(value_name = "NAME:=VALUE", value_parser = xacro_argument)]
    pub xacro_args: Vec<(String, String)>,
    /// A folder of ROS packages, looked into before ROS_PACKAGE_PATH and our own; may be repeated
    #[arg(long, value_name = "FOLDER")]
    pub package_path: Vec<PathBuf>,
    /// Go on as Gazebo classic does where something is missing, with a warning in place of the error
    #[arg(long)]
    pub gazebo_compat: bool,
    /// Leave out models, meshes and textures that the world names and nobody has, with a warning for each, as Gazebo does
    #[arg(long)]
    pub skip_missing: bool,
    /// Turn Collada meshes as their <up_axis> says. Gazebo and rviz ignore it, and so does belvedere without this
    #[arg(long)]
    pub apply_up_axis: bool,
    /// What sensors are whose files ask for no preset: as their elements say, or the devices that they stand for
    #[arg(long, value_enum, default_value_t)]
    pub sensor_models: Devices,
}

impl CheckArgs {
    fn rules(&self) -> Rules {
        let up_axis = if self.apply_up_axis { UpAxis::Applied } else { UpAxis::Ignored };
        let sensor_models = self.sensor_models.into();
        Rules { gazebo_compat: self.gazebo_compat, skip_missing: self.skip_missing, up_axis, sensor_models }
    }
}

/// Runs the command.
///
/// # Errors
/// [`CliError::Description`] with every error in the file; failures of standard output.
pub fn run(args: &CheckArgs) -> Result<(), CliError> {
    let ros_package_path = std::env::var_os("ROS_PACKAGE_PATH");
    let packages = package_path(args.package_path.iter().cloned(), ros_package_path.as_deref());
    let file = args.file.clone().unwrap_or_else(|| default_robot_name().into());
    let mut diagnostics = Diagnostics::default();
    let options = LoadOptions { packages, rules: args.rules(), xacro_args: args.xacro_args.clone() };
    let report = load::load(&file, &options, &mut diagnostics).map(|read| match read {
        Described::World(world) => {
            let streams = rehearse(&world, None, args.gazebo_compat, &mut diagnostics);
            world::report(&world, &streams, args.gazebo_compat)
        }
        Described::Model(robot) => {
            let streams = rehearse(&World::empty(), Some(&robot), args.gazebo_compat, &mut diagnostics);
            robot::report(&robot, &streams, args.gazebo_compat)
        }
    });
    for line in report.into_iter().flatten() {
        print_line(&line)?;
    }
    // Errors are printed by main(), as the command fails with them.
    for problem in diagnostics.problems().iter().filter(|problem| problem.severity != Severity::Error) {
        print_line(&problem.to_string())?;
    }
    if diagnostics.has_errors() {
        return Err(CliError::Description(diagnostics.errors().cloned().collect()));
    }
    let count = diagnostics.problems().len();
    print_line(&match count {
        0 => "no problems".to_owned(),
        1 => "no errors, 1 remark".to_owned(),
        _ => format!("no errors, {count} remarks"),
    })
}

/// Makes the simulation that `belvedere run` makes of a world, or of a robot in an empty one, and opens its streams as a
/// server does. What is wrong, and what is decided on the way, is added to `diagnostics`. A file with errors has none.
fn rehearse(
    world: &World,
    robot: Option<&Model>,
    gazebo_compat: bool,
    diagnostics: &mut Diagnostics,
) -> Streams {
    if diagnostics.has_errors() {
        return Streams::unknown();
    }
    let mut notes = Vec::new();
    let opened = (|| {
        let mut simulation = Simulation::builder(world.clone()).gazebo_compat(gazebo_compat).build()?;
        let spawned = robot.map(|robot| {
            simulation.spawn(robot, SpawnOptions { is_robot: Some(true), ..SpawnOptions::default() })
        });
        let rig = spawned.transpose().and_then(|_| simulation.streams());
        notes.extend_from_slice(simulation.notes());
        rig
    })();
    for note in notes {
        diagnostics.add(note);
    }
    match opened {
        Ok(rig) => Streams::of(rig),
        Err(error) => {
            let source = robot.map_or(&world.source, |robot| &robot.source);
            diagnostics.add(problem(error, source));
            Streams::unknown()
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
