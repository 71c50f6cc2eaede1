//! Reports, which change nothing.

use super::GlobalArgs;
use crate::cli::error::CliError;
use crate::cli::follow::{first, print_line};
use crate::cli::message;
use belvedere_bridge::payload::{ModelState, SensorSettings, SimulationCommand};
use belvedere_bridge::{Node, Operation, SimulationControl, StreamSpec, Text};
use belvedere_sensors::Pose;
use glam::DVec3;

// A doc comment here would appear as the help text of `belvedere control`.
#[derive(Clone, Debug, clap::Subcommand)]
pub(super) enum Report {
    /// Print whether simulated time advances (playing, paused or stepping), whether it is a replay, and what a model is
    /// (robot, actor, static or object, and spawned)
    Query {
        /// Name of a model
        #[arg(default_value = "", hide_default_value = true)]
        model: String,
        /// Print a JSON object
        #[arg(long)]
        json: bool,
    },
    /// Print the settings of every sensor, and their limits
    Settings {
        /// Print one JSON object per line
        #[arg(long)]
        json: bool,
    },
    /// Print the pose and speed of every model
    States {
        /// Print every link as well
        #[arg(long)]
        links: bool,
        /// Print one JSON object per line
        #[arg(long)]
        json: bool,
    },
}

impl Report {
    /// Prints the report.
    pub(super) fn print(&self, node: &Node, global: &GlobalArgs) -> Result<(), CliError> {
        match self {
            Self::Query { model, json } => query(node, global, model, *json),
            Self::Settings { json } => settings(node, global, *json),
            Self::States { links, json } => states(node, global, *links, *json),
        }
    }
}

/// Asks the simulator what it is doing, and what a model is if it has a name.
fn query(node: &Node, global: &GlobalArgs, model: &str, json: bool) -> Result<(), CliError> {
    let refused = |reason: String| CliError::Refused { operation: "query", reason };
    let mut command = SimulationCommand::new(Operation::Query);
    command.name = Text::new(model).map_err(|error| refused(format!("'{model}': {error}")))?;
    let result = SimulationControl::open(node)?.call(&command, "", global.timeout)?;
    let result = result.ok_or_else(|| global.no_answer())?;
    let answer = result.reason.as_str();
    if result.done != 1 {
        return Err(refused(answer.to_owned()));
    }
    let words: Vec<&str> = answer.split_whitespace().collect();
    print_line(&if json {
        serde_json::json!({ "time_ns": result.time_ns, "words": words }).to_string()
    } else {
        format!("query: {} at {:.9} s", words.join(", "), result.time_ns as f64 * 1e-9)
    })
}

/// Prints the settings of all sensors.
fn settings(node: &Node, global: &GlobalArgs, json: bool) -> Result<(), CliError> {
    let sensors: Vec<SensorSettings> =
        first(node, StreamSpec::SENSOR_SETTINGS, global.timeout)?.ok_or_else(|| global.no_answer())?;
    let width = sensors.iter().map(|sensor| sensor.name.as_str().len()).max().unwrap_or(0).max(6);
    if !json {
        print_line(&format!(
            "{:width$}  {:12} {:>10} {:>10} {:>10}",
            "SENSOR", "SETTING", "VALUE", "MIN", "MAX"
        ))?;
    }
    for sensor in &sensors {
        if json {
            print_line(&message::sensor_settings(sensor).to_json().to_string())?;
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

/// Prints the first states that arrive.
fn states(node: &Node, global: &GlobalArgs, links: bool, json: bool) -> Result<(), CliError> {
    let topic = if links { StreamSpec::LINK_STATES } else { StreamSpec::MODEL_STATES };
    let states: Vec<ModelState> = first(node, topic, global.timeout)?.ok_or_else(|| global.no_answer())?;
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
