//! The orders that change a simulation, and the command that is sent for each.

use crate::cli::error::CliError;
use crate::cli::place::{PLACE, Place};
use crate::description::load::{Spawnable, xacro_argument};
use crate::description::models::package_path;
use crate::description::shell::quoted;
use crate::description::{Diagnostics, Severity};
use belvedere_bridge::payload::SimulationCommand;
use belvedere_bridge::{Operation, Text};
use std::path::{Path, PathBuf};

// A doc comment here would appear as the help text of `belvedere control`.
#[allow(clippy::doc_markdown, reason = "the words are help text, shown as they stand")]
#[derive(Clone, Debug, clap::Subcommand)]
pub(super) enum Order {
    /// Pause simulated time
    Pause,
    /// Resume simulated time
    Resume,
    /// Run a number of physics steps, with everything that is published meanwhile, then pause
    Step {
        /// Number of steps
        #[arg(default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..))]
        steps: u64,
    },
    /// Restart at time 0; the streams then have the same bytes as after a fresh start
    Reset,
    /// Put every model back to its start pose, at rest; time continues
    ResetWorld,
    /// Move a model and stop its motion
    Move {
        /// Name of the model, as listed by `belvedere control states`
        model: String,
        /// Position in metres, and heading in degrees, counter-clockwise seen from above
        #[arg(value_name = PLACE, allow_hyphen_values = true)]
        pose: Place,
        /// Reference frame of the pose: a model, MODEL::LINK or world
        #[arg(long, value_name = "FRAME", default_value = "world")]
        relative_to: String,
    },
    /// Add a model to the world, with its base and its sensors
    Spawn {
        /// A .urdf or .xacro file, an SDF file with one <model>, or the name of a robot, as `belvedere robots` lists them
        #[arg(value_name = "FILE|NAME")]
        file: PathBuf,
        /// xacro arguments of the robot, for $(arg NAME)
        #[arg(value_name = "NAME:=VALUE", value_parser = xacro_argument)]
        xacro_args: Vec<(String, String)>,
        /// A folder of ROS packages, searched before ROS_PACKAGE_PATH and the shipped packages; may be repeated
        #[arg(long, value_name = "FOLDER")]
        package_path: Vec<PathBuf>,
        /// Name of the new model [default: its namespace, or else the name in the file]
        #[arg(long, value_name = "NAME")]
        name: Option<String>,
        /// Prefix of its topics and frames, as in /NAMESPACE/scan [default: none]
        #[arg(long, value_name = "NAMESPACE")]
        namespace: Option<String>,
        /// Position in metres, and heading in degrees
        #[arg(long, value_name = PLACE, allow_hyphen_values = true, default_value = "0,0")]
        pose: Place,
        /// Reference frame of the pose: a model, MODEL::LINK or world
        #[arg(long, value_name = "FRAME", default_value = "world")]
        relative_to: String,
    },
    /// Remove a model from the world
    Delete {
        /// Name of the model, as listed by `belvedere control states`
        name: String,
    },
    /// Change settings of a sensor from its next frame on; if one is refused, none is changed
    Configure {
        /// Name of the sensor, as listed by `belvedere control settings`, or one of its topics
        sensor: String,
        /// New values, such as update_rate=15. noise_mean and noise_stddev are in metres for a lidar, and in colour
        /// units from 0 to 1 for a camera; exposure multiplies the light
        #[arg(value_name = "SETTING=VALUE", required = true)]
        settings: Vec<String>,
    },
}

/// What is sent to the simulator for an order.
pub(super) struct Message {
    pub(super) command: SimulationCommand,
    pub(super) text: String,
    /// True if the text is not that of the file which was named.
    is_expanded: bool,
}

impl Order {
    /// Returns the order's name on the command line.
    pub(super) fn word(&self) -> &'static str {
        match self {
            Self::Pause => "pause",
            Self::Resume => "resume",
            Self::Step { .. } => "step",
            Self::Reset => "reset",
            Self::ResetWorld => "reset-world",
            Self::Move { .. } => "move",
            Self::Spawn { .. } => "spawn",
            Self::Delete { .. } => "delete",
            Self::Configure { .. } => "configure",
        }
    }

    fn operation(&self) -> Operation {
        match self {
            Self::Pause => Operation::Pause,
            Self::Resume => Operation::Resume,
            Self::Step { .. } => Operation::Step,
            Self::Reset => Operation::ResetSimulation,
            Self::ResetWorld => Operation::ResetWorld,
            Self::Move { .. } => Operation::SetModelState,
            Self::Spawn { .. } => Operation::Spawn,
            Self::Delete { .. } => Operation::Delete,
            Self::Configure { .. } => Operation::Configure,
        }
    }

    /// Returns what is sent to the simulator.
    pub(super) fn message(&self) -> Result<Message, CliError> {
        let command = SimulationCommand::new(self.operation());
        let mut message = Message { command, text: String::new(), is_expanded: false };
        let Message { command, text, is_expanded } = &mut message;
        match self {
            Self::Pause | Self::Resume | Self::Reset | Self::ResetWorld => {}
            Self::Step { steps } => command.steps = *steps,
            Self::Move { model, pose, relative_to } => {
                command.name = self.name(model)?;
                command.reference = self.name(relative_to)?;
                set_pose(command, *pose);
            }
            Self::Spawn { file, xacro_args, package_path, name, namespace, pose, relative_to } => {
                let spawnable = read(file, xacro_args, package_path)?;
                (*text, *is_expanded) = (spawnable.text, spawnable.is_expanded);
                let name = name.as_deref().or(namespace.as_deref());
                command.name = self.name(name.unwrap_or_default())?;
                command.robot_namespace = self.name(namespace.as_deref().unwrap_or_default())?;
                command.reference = self.name(relative_to)?;
                set_pose(command, *pose);
            }
            Self::Delete { name } => command.name = self.name(name)?,
            Self::Configure { sensor, settings } => {
                command.name = self.name(sensor)?;
                *text = settings.join(" ");
            }
        }
        Ok(message)
    }

    /// Returns the simulator's reason for a refusal. A problem in a spawned file is reported with the file's name.
    pub(super) fn refusal(&self, message: &Message, reason: &str) -> String {
        let Self::Spawn { file, .. } = self else { return reason.to_owned() };
        // The simulator does not know the file's name: it reports the model's name, or "text" if no name was given.
        let name = message.command.name.as_str();
        let known = if name.is_empty() { "text" } else { name };
        let place = reason.strip_prefix(known).and_then(|rest| rest.strip_prefix(':'));
        match place.filter(|place| place.starts_with(|first: char| first.is_ascii_digit())) {
            Some(place) if message.is_expanded => {
                format!("what `belvedere urdf {}` prints:{place}", quoted(file))
            }
            Some(place) => format!("{}:{place}", file.display()),
            None => reason.to_owned(),
        }
    }

    fn name(&self, text: &str) -> Result<Text<64>, CliError> {
        let refused =
            |error| CliError::Refused { operation: self.word(), reason: format!("'{text}': {error}") };
        Text::new(text).map_err(refused)
    }
}

/// Reads a model that is to be spawned, and reports what is worth a warning.
fn read(file: &Path, xacro_args: &[(String, String)], folders: &[PathBuf]) -> Result<Spawnable, CliError> {
    let ros_package_path = std::env::var_os("ROS_PACKAGE_PATH");
    let packages = package_path(folders.iter().cloned(), ros_package_path.as_deref());
    let mut diagnostics = Diagnostics::default();
    let read = Spawnable::load(file, &packages, xacro_args, &mut diagnostics);
    for problem in diagnostics.problems().iter().filter(|problem| problem.severity == Severity::Warning) {
        tracing::warn!("{problem}");
    }
    read.map_err(|why| CliError::Description(vec![why.into_problem()]))
}

fn set_pose(command: &mut SimulationCommand, place: Place) {
    let pose = place.pose();
    command.position = pose.translation().to_array();
    command.orientation = pose.rotation().to_array();
}
