//! Messages that control a simulation: commands, results, states of models, settings of sensors.

use super::parts::{Entries, pose, seconds, text, twist};
use super::tree::Tree::{self, Flag, List, Map, Number, Whole};
use belvedere_bridge::Operation;
use belvedere_bridge::payload::{ModelState, SensorSettings, Setting, SimulationCommand, SimulationResult};

pub(super) fn command(command: &SimulationCommand) -> Entries {
    vec![
        ("id", Whole(command.id)),
        ("operation", operation(command.operation)),
        ("steps", Whole(command.steps)),
        ("name", text(command.name.as_str())),
        ("reference_frame", text(command.reference.as_str())),
        ("pose", pose(command.position, command.orientation)),
        ("twist", twist(command.linear, command.angular)),
        ("text_len", Whole(command.text_len.into())),
    ]
}

pub(super) fn result(result: &SimulationResult) -> Entries {
    vec![
        ("id", Whole(result.id)),
        ("operation", operation(result.operation)),
        ("done", Flag(result.done == 1)),
        ("reason", text(result.reason.as_str())),
        ("time", seconds(result.time_ns)),
    ]
}

fn operation(number: u16) -> Tree {
    Operation::from_wire(number).map_or(Whole(number.into()), |operation| text(operation.as_str()))
}

pub(super) fn model_state(state: &ModelState) -> Tree {
    Map(vec![
        ("name", text(state.name.as_str())),
        ("pose", pose(state.position, state.orientation)),
        ("twist", twist(state.linear, state.angular)),
    ])
}

/// Settings that a sensor does not have are omitted.
pub(in crate::cli) fn sensor_settings(sensor: &SensorSettings) -> Tree {
    let topics = sensor.topics().map(text).collect();
    let entries = [("name", text(sensor.name.as_str())), ("topics", List(topics, 0))];
    let number = |Setting { value, min, max }| {
        Map(vec![("value", Number(value)), ("min", Number(min)), ("max", Number(max))])
    };
    let settings = sensor.by_name().into_iter().filter(|(_, setting)| !setting.value.is_nan());
    Map(entries.into_iter().chain(settings.map(|(name, setting)| (name, number(setting)))).collect())
}
