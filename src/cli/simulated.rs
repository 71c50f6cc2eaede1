//! What is simulated: the arguments that `run` and `check` share, and the simulation that they make.

use super::robots::RobotArgs;
use super::sensor_models::Devices;
use crate::description::load::{default_world, load_world};
use crate::description::mesh::UpAxis;
use crate::description::model::{Model, World};
use crate::description::models::package_path;
use crate::description::package::PackagePath;
use crate::description::{Diagnostics, Rules};
use crate::entities::EntityId;
use crate::robot::Autopilot;
use crate::simulation::{Simulation, SimulationError, SpawnOptions};
use std::path::PathBuf;

#[allow(clippy::doc_markdown, reason = "the words are help text, shown as they stand")]
/// The robots, the world, and how their files are read.
#[derive(Clone, Debug, clap::Args)]
#[group(skip)]
#[allow(clippy::struct_excessive_bools, reason = "each is a switch of the command line")]
pub(super) struct SimulatedArgs {
    #[command(flatten)]
    pub(super) robots: RobotArgs,
    /// The world: an SDF file, or the name of one of ours
    /// [default: tag_ceiling, or TURTLEBOT_GAZEBO_WORLD_FILE]
    #[arg(long, value_name = "FILE|NAME")]
    pub(super) world: Option<PathBuf>,
    /// What robots do when nobody sends them velocity commands [default: loop, round the room of our own robot in our
    /// own world; still, with a robot or a world of yours]
    #[arg(long, value_enum)]
    drive: Option<Autopilot>,
    /// Behave as Gazebo classic where it differs from what is right: its principal point, NaN for depths out of
    /// range, ranges that begin at the minimum, sensors on missing links left out
    #[arg(long)]
    pub(super) gazebo_compat: bool,
    /// Leave out models and meshes that the world names and nobody has, with a warning for each, as Gazebo does
    #[arg(long)]
    skip_missing: bool,
    /// Turn meshes so that z is up: Collada as its <up_axis> says, glTF from its y. Gazebo and rviz take the numbers as they
    /// stand, and so does belvedere without this
    #[arg(long)]
    apply_up_axis: bool,
    /// What sensors are whose files ask for no preset: as their elements say, or the devices that they stand for, with
    /// their noise, shadows and range: a Kinect's plugin is a Kinect
    #[arg(long, value_enum, default_value_t)]
    sensor_models: Devices,
    /// Publish what is true of every pixel and beam as well: TOPIC/truth/depth, range, normal, instance, class,
    /// incidence, flow_back, flow_forward
    #[arg(long)]
    pub(super) truth: bool,
    /// Treat warnings as errors, so that nothing runs that would differ from what its files say
    #[arg(long)]
    strict: bool,
    /// A folder of ROS packages, looked into before ROS_PACKAGE_PATH and our own; may be repeated
    #[arg(long, value_name = "FOLDER")]
    package_path: Vec<PathBuf>,
}

impl SimulatedArgs {
    /// Returns how robots, and models that are spawned later, are read. What the world lacks may be left out, but not what
    /// a robot lacks.
    pub(super) fn rules(&self) -> Rules {
        let up_axis = if self.apply_up_axis { UpAxis::Applied } else { UpAxis::Ignored };
        let sensor_models = self.sensor_models.into();
        Rules { gazebo_compat: self.gazebo_compat, skip_missing: false, up_axis, sensor_models }
    }

    /// Adds a folder of packages after those that are given.
    pub(super) fn add_package_folder(&mut self, folder: PathBuf) {
        self.package_path.push(folder);
    }

    /// Leaves out what is not asked for: our own world, or the robot that would be added to a world.
    pub(super) fn be_alone(&mut self, is_world: bool) {
        if is_world && self.robots.are_ours() {
            self.robots.be_none();
        } else if !is_world {
            self.world.get_or_insert_with(|| "empty".into());
        }
    }

    /// Returns where packages are looked for.
    pub(super) fn packages(&self) -> PackagePath {
        let ros_package_path = std::env::var_os("ROS_PACKAGE_PATH");
        package_path(self.package_path.iter().cloned(), ros_package_path.as_deref())
    }

    /// Returns the world's file or name.
    pub(super) fn world(&self) -> PathBuf {
        self.world.clone().unwrap_or_else(default_world)
    }

    /// Loads the world and the robots. Neither is to be used if `diagnostics` has errors.
    pub(super) fn load(
        &self,
        packages: &PackagePath,
        diagnostics: &mut Diagnostics,
    ) -> (Option<World>, Vec<(Model, SpawnOptions)>) {
        let rules = Rules { skip_missing: self.skip_missing, ..self.rules() };
        let world = load_world(self.world(), packages, rules, diagnostics);
        let taken = world.iter().flat_map(|world| &world.models).map(|model| model.name.as_str());
        let robots = self.robots.load(packages, self.rules(), &taken.collect(), diagnostics);
        self.judge(diagnostics);
        (world, robots)
    }

    /// Makes warnings errors, if that was asked for.
    pub(super) fn judge(&self, diagnostics: &mut Diagnostics) {
        if self.strict {
            diagnostics.warnings_are_errors();
        }
    }

    /// Puts the robots into a simulation of their world, each with its autopilot, and returns their identities.
    ///
    /// # Errors
    /// When a robot cannot be used, or cannot stand where it is to start.
    pub(super) fn spawn(
        &self,
        simulation: &mut Simulation,
        robots: &[(Model, SpawnOptions)],
    ) -> Result<Vec<EntityId>, SimulationError> {
        let drive = self.drive();
        let spawn = |(model, options): &(Model, SpawnOptions)| {
            let start = options.world_from_model * drive.start_pose();
            let id = simulation.spawn(model, SpawnOptions { world_from_model: start, ..options.clone() })?;
            // A robot without a base stays where it is; a note says so.
            let _ = simulation.set_autopilot(id, drive);
            Ok(id)
        };
        robots.iter().map(spawn).collect()
    }

    /// Only our own robot in our own world drives by itself.
    fn drive(&self) -> Autopilot {
        let is_ours = self.world.is_none() && self.robots.are_ours();
        self.drive.unwrap_or(if is_ours { Autopilot::Loop } else { Autopilot::Still })
    }
}
