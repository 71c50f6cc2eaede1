//! What a simulation can be told to do, and the command that is sent for it.

use super::model_file;
use crate::cli::error::CliError;
use crate::cli::place::{PLACE, Place};
use belvedere_bridge::payload::SimulationCommand;
use belvedere_bridge::{Operation, Text};
use std::path::PathBuf;

// Its doc comment would be shown as the help text of `belvedere control`.
#[allow(clippy::doc_markdown, reason = "the words are help text, shown as they stand")]
#[derive(Clone, Debug, clap::Subcommand)]
pub(super) enum Order {
    /// Let simulated time stand
    Pause,
    /// Let simulated time go on
    Resume,
    /// Run some steps of physics, with all that is published on the way, then pause
    Step {
        /// How many
        #[arg(default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..))]
        steps: u64,
    },
    /// Begin again at time 0: the bytes of a fresh start follow
    Reset,
    /// Put every model back to where it was at the start, at rest; time goes on
    ResetWorld,
    /// Move a model; it is at rest then
    Move {
        /// Its name, as `belvedere control states` gives it
        model: String,
        /// Where, in metres, and its heading in degrees, counter-clockwise seen from above
        #[arg(value_name = PLACE, allow_hyphen_values = true)]
        pose: Place,
        /// The frame that this is given in: a model, MODEL::LINK or world
        #[arg(long, value_name = "FRAME", default_value = "world")]
        relative_to: String,
    },
    /// Put a model into the world, with its base and its sensors: a URDF file without xacro, or an SDF file with one
    /// <model>
    Spawn {
        /// The file
        file: PathBuf,
        /// What it is to be called [default: its namespace, or else its own name]
        #[arg(long, value_name = "NAME")]
        name: Option<String>,
        /// Stands before its topics and frames, as in /NAMESPACE/scan [default: none]
        #[arg(long, value_name = "NAMESPACE")]
        namespace: Option<String>,
        /// Where, in metres, and its heading in degrees
        #[arg(long, value_name = PLACE, allow_hyphen_values = true, default_value = "0,0")]
        pose: Place,
        /// The frame that this is given in: a model, MODEL::LINK or world
        #[arg(long, value_name = "FRAME", default_value = "world")]
        relative_to: String,
    },
    /// Take a model out of the world
    Delete {
        /// Its name, as `belvedere control states` gives it
        name: String,
    },
    /// Change settings of a sensor from its next frame on; all of them, or none if one is refused
    Configure {
        /// Its name, as `belvedere control settings` gives it, or a topic that it sends
        sensor: String,
        /// What is to be changed, such as update_rate=15; noise_mean and noise_stddev are in metres for a lidar, and for
        /// a camera of colours in [0, 1]; exposure is a factor of the light
        #[arg(value_name = "SETTING=VALUE", required = true)]
        settings: Vec<String>,
    },
}

impl Order {
    /// What it is called on the command line.
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

    /// What to send, and its text.
    pub(super) fn command(&self) -> Result<(SimulationCommand, String), CliError> {
        let mut command = SimulationCommand::new(self.operation());
        let mut text = String::new();
        match self {
            Self::Pause | Self::Resume | Self::Reset | Self::ResetWorld => {}
            Self::Step { steps } => command.steps = *steps,
            Self::Move { model, pose, relative_to } => {
                command.name = self.name(model)?;
                command.reference = self.name(relative_to)?;
                set_pose(&mut command, *pose);
            }
            Self::Spawn { file, name, namespace, pose, relative_to } => {
                text = model_file::read(file)?;
                let name = name.as_deref().or(namespace.as_deref());
                command.name = self.name(name.unwrap_or_default())?;
                command.robot_namespace = self.name(namespace.as_deref().unwrap_or_default())?;
                command.reference = self.name(relative_to)?;
                set_pose(&mut command, *pose);
            }
            Self::Delete { name } => command.name = self.name(name)?,
            Self::Configure { sensor, settings } => {
                command.name = self.name(sensor)?;
                text = settings.join(" ");
            }
        }
        Ok((command, text))
    }

    /// Why the simulator refused it: what is wrong with the text of a file is told with the file's name.
    pub(super) fn refusal(&self, command: &SimulationCommand, reason: &str) -> String {
        let Self::Spawn { file, .. } = self else { return reason.to_owned() };
        // The simulator knows the text by the model's name at most.
        let known = if command.name.as_str().is_empty() { "text" } else { command.name.as_str() };
        let place = reason.strip_prefix(known).and_then(|rest| rest.strip_prefix(':'));
        match place.filter(|place| place.starts_with(|first: char| first.is_ascii_digit())) {
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

fn set_pose(command: &mut SimulationCommand, place: Place) {
    let pose = place.pose();
    command.position = pose.translation().to_array();
    command.orientation = pose.rotation().to_array();
}
