//! The arguments that `run` and `check` share, and the simulation that is made from them.

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
    /// The world: an SDF file, or the name of a shipped world
    /// [default: tag_ceiling, or TURTLEBOT_GAZEBO_WORLD_FILE]
    #[arg(long, value_name = "FILE|NAME")]
    pub(super) world: Option<PathBuf>,
    /// What robots do while they receive no velocity commands [default: loop, which circles the room, for the default
    /// robot in the default world; still for any other robot or world]
    #[arg(long, value_enum)]
    drive: Option<Autopilot>,
    /// Behave like Gazebo classic where it differs from the correct behaviour: its principal point, NaN for depths out
    /// of range, ranges that begin at the minimum, sensors on missing links are ignored
    #[arg(long)]
    pub(super) gazebo_compat: bool,
    /// Skip models and meshes of the world and of robots that are not found, with a warning for each, as Gazebo does
    #[arg(long)]
    skip_missing: bool,
    /// Rotate meshes so that z is up: Collada meshes according to their <up_axis>, glTF from its y. Gazebo and rviz use
    /// the numbers of the file unchanged, and so does belvedere by default
    #[arg(long)]
    apply_up_axis: bool,
    /// How to model sensors whose files choose no preset: exactly as their elements specify, or as the devices that
    /// they stand for, with their noise, shadows and range: a Kinect's plugin is then a Kinect
    #[arg(long, value_enum, default_value_t)]
    sensor_models: Devices,
    /// Also publish ground truth for every pixel and beam: TOPIC/truth/depth, range, normal, instance, class,
    /// incidence, flow_back, flow_forward; and the pose of each robot in the world, truth/pose
    #[arg(long)]
    pub(super) truth: bool,
    /// Treat warnings as errors, so that only files that are simulated exactly as written are run
    #[arg(long)]
    strict: bool,
    /// A folder of ROS packages, searched before ROS_PACKAGE_PATH and the shipped packages; may be repeated
    #[arg(long, value_name = "FOLDER")]
    package_path: Vec<PathBuf>,
}

impl SimulatedArgs {
    /// Returns the rules for reading the world, the robots, and models that are spawned later.
    pub(super) fn rules(&self) -> Rules {
        let up_axis = if self.apply_up_axis { UpAxis::Applied } else { UpAxis::Ignored };
        let sensor_models = self.sensor_models.into();
        Rules { gazebo_compat: self.gazebo_compat, skip_missing: self.skip_missing, up_axis, sensor_models }
    }

    /// Adds a folder of packages after those that are given.
    pub(super) fn add_package_folder(&mut self, folder: PathBuf) {
        self.package_path.push(folder);
    }

    /// Removes the defaults, for one of many files: the robot that would be added to a world, or the world that a robot
    /// would run in.
    pub(super) fn be_alone(&mut self, is_world: bool) {
        self.robots.be_for_many();
        if is_world && self.robots.are_ours() {
            self.robots.be_none();
        } else if !is_world {
            self.world.get_or_insert_with(|| "empty".into());
        }
    }

    /// Returns the folders that are searched for packages.
    pub(super) fn packages(&self) -> PackagePath {
        let ros_package_path = std::env::var_os("ROS_PACKAGE_PATH");
        package_path(self.package_path.iter().cloned(), ros_package_path.as_deref())
    }

    /// Returns the world's file or name.
    pub(super) fn world(&self) -> PathBuf {
        self.world.clone().unwrap_or_else(default_world)
    }

    /// Loads the world and the robots. Neither must be used if `diagnostics` has errors.
    pub(super) fn load(
        &self,
        packages: &PackagePath,
        diagnostics: &mut Diagnostics,
    ) -> (Option<World>, Vec<(Model, SpawnOptions)>) {
        let world = load_world(self.world(), packages, self.rules(), diagnostics);
        let taken = world.iter().flat_map(|world| &world.models).map(|model| model.name.as_str());
        let robots = self.robots.load(packages, self.rules(), &taken.collect(), diagnostics);
        self.judge(diagnostics);
        (world, robots)
    }

    /// Turns warnings into errors if --strict was given.
    pub(super) fn judge(&self, diagnostics: &mut Diagnostics) {
        if self.strict {
            diagnostics.warnings_are_errors();
        }
    }

    /// Puts the robots into a simulation of their world, each with its autopilot, and returns their identities.
    ///
    /// # Errors
    /// If a robot cannot be used, or cannot be placed at its start pose.
    pub(super) fn spawn(
        &self,
        simulation: &mut Simulation,
        robots: &[(Model, SpawnOptions)],
    ) -> Result<Vec<EntityId>, SimulationError> {
        let drive = self.drive();
        let spawn = |(model, options): &(Model, SpawnOptions)| {
            let start = options.world_from_model * drive.start_pose();
            let id = simulation.spawn(model, SpawnOptions { world_from_model: start, ..options.clone() })?;
            // This fails for a robot without a base, which does not move; a note reports that.
            let _ = simulation.set_autopilot(id, drive);
            Ok(id)
        };
        robots.iter().map(spawn).collect()
    }

    /// Returns the autopilot. By default only the default robot in the default world drives by itself.
    fn drive(&self) -> Autopilot {
        let is_ours = self.world.is_none() && self.robots.are_ours();
        self.drive.unwrap_or(if is_ours { Autopilot::Loop } else { Autopilot::Still })
    }
}
