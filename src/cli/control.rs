//! `belvedere control`: pause, step, reset a running simulation, move, add and remove what is in it, and change its
//! sensors.

use super::error::CliError;
use super::follow::{DomainArgs, print_line, seconds};
use belvedere_bridge::payload::{Message, ModelState, SensorSettings, SimulationCommand, SimulationResult};
use belvedere_bridge::{Node, Operation, SimulationControl, StreamSpec, Text};
use belvedere_sensors::Pose;
use glam::DVec3;
use std::path::PathBuf;
use std::time::Duration;

/// Control a running simulation.
///
/// Commands are applied between two frames. Each prints the simulated time at which it was; one that is refused ends
/// with the reason, and with exit code 1.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "Examples:
  belvedere control pause
  belvedere control step 100
  belvedere control move crate 1.5 0 0.1 90
  belvedere control spawn crate.sdf --name second_crate --pose 2,0,0.5
  belvedere control delete second_crate
  belvedere control configure camera1 update_rate=15 exposure=0.5
  belvedere control reset --domain lab")]
pub struct ControlArgs {
    #[command(subcommand)]
    operation: What,
    #[command(flatten)]
    #[allow(missing_docs)]
    domain: GlobalArgs,
}

#[derive(Clone, Debug, clap::Args)]
struct GlobalArgs {
    #[command(flatten)]
    domain: DomainArgs,
    /// How long to wait for the simulator's answer
    #[arg(long, value_name = "SECONDS", value_parser = seconds, default_value = "5", global = true)]
    timeout: Duration,
}

#[allow(clippy::doc_markdown, reason = "the words are help text, shown as they stand")]
#[derive(Clone, Debug, clap::Subcommand)]
enum What {
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
        /// Metres
        #[arg(allow_negative_numbers = true)]
        x: f64,
        /// Metres
        #[arg(allow_negative_numbers = true)]
        y: f64,
        /// Metres
        #[arg(allow_negative_numbers = true)]
        z: f64,
        /// Degrees, counter-clockwise seen from above
        #[arg(allow_negative_numbers = true, default_value_t = 0.0)]
        yaw: f64,
        /// The frame that they are given in: a model, MODEL::LINK or world
        #[arg(long, value_name = "FRAME", default_value = "world")]
        relative_to: String,
    },
    /// Put a model into the world: a URDF file without xacro, or an SDF file with one <model>; without sensors
    Spawn {
        /// The file
        file: PathBuf,
        /// What it is to be called [default: its own name]
        #[arg(long, value_name = "NAME")]
        name: Option<String>,
        /// Where, in metres and degrees
        #[arg(long, value_name = "X,Y,Z[,YAW]", value_parser = place, allow_hyphen_values = true, default_value = "0,0,0")]
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
    /// Print the settings of every sensor, and what they may be
    Settings {
        /// Print one JSON object a line
        #[arg(long)]
        json: bool,
    },
    /// Print where every model is
    States {
        /// Every link, too
        #[arg(long)]
        links: bool,
        /// Print one JSON object a line
        #[arg(long)]
        json: bool,
    },
}

/// Metres and degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Place {
    position: [f64; 3],
    yaw_deg: f64,
}

fn place(text: &str) -> Result<Place, String> {
    let wrong = || "three or four numbers are wanted, such as 1.5,0,0.1 or 1.5,0,0.1,90".to_owned();
    let numbers: Vec<f64> = text
        .split(',')
        .map(|number| number.trim().parse().ok().filter(|number: &f64| number.is_finite()).ok_or_else(wrong))
        .collect::<Result<_, _>>()?;
    match numbers[..] {
        [x, y, z] => Ok(Place { position: [x, y, z], yaw_deg: 0.0 }),
        [x, y, z, yaw_deg] => Ok(Place { position: [x, y, z], yaw_deg }),
        _ => Err(wrong()),
    }
}

/// Runs the command.
///
/// # Errors
/// [`CliError::Refused`] with the simulator's reason, [`CliError::NoAnswer`]; a file that cannot be read; failures of
/// the bridge and of standard output.
pub fn run(args: &ControlArgs) -> Result<(), CliError> {
    let node = Node::open(&args.domain.domain.domain, "belvedere control")?;
    match args.operation {
        What::States { links, json } => return states(&node, args, links, json),
        What::Settings { json } => return settings(&node, args, json),
        _ => {}
    }
    let (operation, command, text) = command(&args.operation)?;
    let result = SimulationControl::open(&node)?.call(&command, &text, args.domain.timeout)?;
    let result: SimulationResult = result.ok_or_else(|| no_answer(args))?;
    if result.done != 1 {
        return Err(CliError::Refused { operation, reason: result.reason.as_str().to_owned() });
    }
    print_line(&format!("{operation}: done at {:.9} s", result.time_ns as f64 * 1e-9))
}

fn no_answer(args: &ControlArgs) -> CliError {
    CliError::NoAnswer { domain: args.domain.domain.domain.clone(), waited: args.domain.timeout }
}

/// What to send, and its text.
fn command(what: &What) -> Result<(&'static str, SimulationCommand, String), CliError> {
    let (operation, word) = match what {
        What::Pause => (Operation::Pause, "pause"),
        What::Resume => (Operation::Resume, "resume"),
        What::Step { .. } => (Operation::Step, "step"),
        What::Reset => (Operation::ResetSimulation, "reset"),
        What::ResetWorld => (Operation::ResetWorld, "reset-world"),
        What::Move { .. } => (Operation::SetModelState, "move"),
        What::Spawn { .. } => (Operation::Spawn, "spawn"),
        What::Configure { .. } | What::Settings { .. } => (Operation::Configure, "configure"),
        What::Delete { .. } | What::States { .. } => (Operation::Delete, "delete"),
    };
    let mut command = SimulationCommand::new(operation);
    let mut text = String::new();
    match what {
        What::Step { steps } => command.steps = *steps,
        What::Move { model, x, y, z, yaw, relative_to } => {
            command.name = name(word, model)?;
            command.reference = name(word, relative_to)?;
            (command.position, command.orientation) = ([*x, *y, *z], turned(*yaw));
        }
        What::Spawn { file, name: called, pose, relative_to } => {
            text = std::fs::read_to_string(file)
                .map_err(|source| CliError::Input { path: file.clone(), source })?;
            command.name = name(word, called.as_deref().unwrap_or_default())?;
            command.reference = name(word, relative_to)?;
            (command.position, command.orientation) = (pose.position, turned(pose.yaw_deg));
        }
        What::Delete { name: model } => command.name = name(word, model)?,
        What::Configure { sensor, settings } => {
            command.name = name(word, sensor)?;
            text = settings.join(" ");
        }
        _ => {}
    }
    Ok((word, command, text))
}

fn turned(yaw_deg: f64) -> [f64; 4] {
    Pose::from_xyz_rpy(DVec3::ZERO, DVec3::Z * yaw_deg.to_radians()).rotation().to_array()
}

fn name(operation: &'static str, text: &str) -> Result<Text<64>, CliError> {
    Text::new(text).map_err(|error| CliError::Refused { operation, reason: format!("'{text}': {error}") })
}

/// The structs of the first frame that comes, if one does in time.
pub(super) fn first<T: Message>(
    node: &Node,
    topic: &str,
    patience: Duration,
) -> Result<Option<Vec<T>>, CliError> {
    let mut subscriber = node.subscriber(topic)?;
    if !subscriber.wait(patience)? {
        return Ok(None);
    }
    let Some(frame) = subscriber.take()? else { return Ok(None) };
    let structs = frame.view().structs().map(Iterator::collect);
    Ok(Some(structs.map_err(|error| belvedere_bridge::Error::Frame { topic: topic.to_owned(), error })?))
}

/// Prints the settings of all sensors.
fn settings(node: &Node, args: &ControlArgs, json: bool) -> Result<(), CliError> {
    let sensors: Vec<SensorSettings> =
        first(node, StreamSpec::SENSOR_SETTINGS, args.domain.timeout)?.ok_or_else(|| no_answer(args))?;
    let width = sensors.iter().map(|sensor| sensor.name.as_str().len()).max().unwrap_or(0).max(6);
    if !json {
        print_line(&format!(
            "{:width$}  {:12} {:>10} {:>10} {:>10}",
            "SENSOR", "SETTING", "VALUE", "MIN", "MAX"
        ))?;
    }
    for sensor in &sensors {
        if json {
            print_line(&super::message::sensor_settings(sensor).to_json().to_string())?;
            continue;
        }
        let name = sensor.name.as_str();
        for (setting, values) in sensor.by_name() {
            if !values.value.is_nan() {
                let (value, min, max) = (values.value, values.min, values.max);
                print_line(&format!("{name:width$}  {setting:12} {value:>10} {min:>10} {max:>10}"))?;
            }
        }
    }
    Ok(())
}

/// Prints the first states that come.
fn states(node: &Node, args: &ControlArgs, links: bool, json: bool) -> Result<(), CliError> {
    let topic = if links { StreamSpec::LINK_STATES } else { StreamSpec::MODEL_STATES };
    let states: Vec<ModelState> = first(node, topic, args.domain.timeout)?.ok_or_else(|| no_answer(args))?;
    let width = states.iter().map(|state| state.name.as_str().len()).max().unwrap_or(0).max(4);
    if !json {
        print_line(&format!(
            "{:width$} {:>9} {:>9} {:>9} {:>8} {:>8} {:>8} {:>7}",
            "NAME", "X m", "Y m", "Z m", "ROLL °", "PITCH °", "YAW °", "m/s"
        ))?;
    }
    for state in &states {
        let [x, y, z] = state.position;
        let rotation = glam::DQuat::from_array(state.orientation);
        let [roll, pitch, yaw] = Pose::new(DVec3::ZERO, rotation).rpy().to_array().map(f64::to_degrees);
        let speed = DVec3::from_array(state.linear).length();
        let name = state.name.as_str();
        print_line(&if json {
            serde_json::json!({
                "name": name, "position": state.position, "orientation": state.orientation,
                "linear": state.linear, "angular": state.angular,
            })
            .to_string()
        } else {
            format!(
                "{name:width$} {x:>9.3} {y:>9.3} {z:>9.3} {roll:>8.2} {pitch:>8.2} {yaw:>8.2} {speed:>7.3}"
            )
        })?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_three_or_four_numbers() {
        assert_eq!(place("1, -2,3"), Ok(Place { position: [1.0, -2.0, 3.0], yaw_deg: 0.0 }));
        assert_eq!(place("1,2,3,90").unwrap().yaw_deg, 90.0);
        for bad in ["", "1,2", "1,2,3,4,5", "a,b,c", "1,2,nan"] {
            assert!(place(bad).is_err(), "{bad}");
        }
    }
}
