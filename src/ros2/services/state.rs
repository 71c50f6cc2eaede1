//! The services `GetSimulatorFeatures`, `GetSimulationState`, `SetSimulationState` and `ResetSimulation`.

use super::client::{Client, Description, PATIENCE};
use super::refusal::{Refusal, result};
use crate::ros2::cdr::Cdr;
use belvedere_bridge::payload::SimulationCommand;
use belvedere_bridge::{Operation, RosBytes, Text};

/// The numbers of features that are served even if nothing may be changed.
const READING: [u16; 4] = [
    8,  // categories of entities
    10, // states of entities
    12, // information about entities
    24, // state of the simulation
];
/// The numbers of features that change a simulation, or a replay.
const TIME: [u16; 4] = [
    25, // state of the simulation
    26, // pause
    31, // one step
    32, // many steps
];
/// The numbers of features that change a simulation.
const CHANGING: [u16; 8] = [
    0,  // spawn
    1,  // delete
    9,  // spawn from a text
    11, // states of entities
    20, // reset
    22, // reset of states
    23, // reset of spawned entities
    50, // spawn several
];

/// The states of `simulation_interfaces/msg/SimulationState` that are served.
const STOPPED: u8 = 0;
const PLAYING: u8 = 1;
const PAUSED: u8 = 2;
const QUITTING: u8 = 3;
/// Answered if there is no simulation.
const NO_WORLD: u8 = 4;
/// A result of `SetSimulationState`.
const ALREADY_IN_TARGET_STATE: u8 = 101;

/// The scopes of `ResetSimulation`, which are bits.
const SCOPE_TIME: u8 = 1;
const SCOPE_STATE: u8 = 2;
const SCOPE_SPAWNED: u8 = 4;
const SCOPE_ALL: u8 = 255;

/// Answers with the features of the simulation that runs now.
pub(super) fn get_simulator_features(client: &mut Client<'_>, _: &[u8], reply: &mut RosBytes<'_>) {
    let mut features = Vec::new();
    let mut info = format!("belvedere {}", env!("CARGO_PKG_VERSION"));
    match client.describe("") {
        Ok(description) => {
            features.extend(READING);
            let is_replay = description.is("replay");
            if client.only_reads() {
                info += ", started with --no-commands, so nothing can be changed";
            } else {
                features.extend(TIME);
                features.extend(CHANGING.iter().filter(|_| !is_replay));
            }
            if is_replay {
                info += ", which replays a recording";
            }
        }
        Err(refusal) => info = format!("{info}: {}", refusal.message),
    }
    let formats: &[&str] = if features.contains(&0) { &["urdf", "xacro", "sdf"] } else { &[] };
    reply.count(features.len());
    for feature in &features {
        reply.u16(*feature);
    }
    reply.count(formats.len());
    for format in formats {
        reply.text(format);
    }
    reply.text(&info);
}

/// Answers with the state of the simulation.
pub(super) fn get_simulation_state(client: &mut Client<'_>, _: &[u8], reply: &mut RosBytes<'_>) {
    let state = client.describe("").map(|description| state_of(client, &description));
    // The state comes before the result here.
    reply.u8(*state.as_ref().unwrap_or(&NO_WORLD));
    result(reply, state);
}

/// A paused simulation that stands at its start is stopped, unless a client wanted it to be paused there.
fn state_of(client: &Client<'_>, description: &Description) -> u8 {
    if !description.is("paused") {
        PLAYING
    } else if description.time_ns == 0 && !*client.is_paused_at_start {
        STOPPED
    } else {
        PAUSED
    }
}

/// Plays, pauses or stops the simulation.
pub(super) fn set_simulation_state(client: &mut Client<'_>, request: &[u8], reply: &mut RosBytes<'_>) {
    let outcome = set_state(client, request);
    result(reply, outcome);
}

fn set_state(client: &mut Client<'_>, request: &[u8]) -> Result<(), Refusal> {
    let wanted = Cdr::new(request)?.u8()?;
    let description = client.may_change()?;
    let state = state_of(client, &description);
    // While it runs steps, a simulation plays until they are done.
    let is_stepping = description.is("stepping");
    if state == wanted && !is_stepping {
        return Err(Refusal::new(ALREADY_IN_TARGET_STATE, "the simulation is in this state already"));
    }
    match wanted {
        PLAYING => client.command(&SimulationCommand::new(Operation::Resume), "", PATIENCE)?,
        PAUSED if state == PLAYING => {
            client.command(&SimulationCommand::new(Operation::Pause), "", PATIENCE)?;
        }
        PAUSED => {}
        STOPPED => {
            client.may_change_models()?;
            client.command(&SimulationCommand::new(Operation::Pause), "", PATIENCE)?;
            reset_to_start(client)?;
        }
        QUITTING => {
            return Err(Refusal::unsupported(
                "a service cannot end the simulator; it ends with Ctrl-C, SIGTERM or after --duration",
            ));
        }
        other => {
            return Err(Refusal::unsupported(format!(
                "state {other} cannot be set; set 0 (stopped), 1 (playing) or 2 (paused)"
            )));
        }
    }
    *client.is_paused_at_start = wanted == PAUSED;
    Ok(())
}

/// Puts the simulation back to its start, or a part of it.
pub(super) fn reset_simulation(client: &mut Client<'_>, request: &[u8], reply: &mut RosBytes<'_>) {
    let outcome = reset(client, request);
    result(reply, outcome);
}

fn reset(client: &mut Client<'_>, request: &[u8]) -> Result<(), Refusal> {
    let scope = match Cdr::new(request)?.u8()? {
        0 => SCOPE_ALL,
        scope => scope,
    };
    let known = SCOPE_TIME | SCOPE_STATE | SCOPE_SPAWNED;
    if scope != SCOPE_ALL && scope & !known != 0 {
        return Err(Refusal::unsupported(format!(
            "scope {scope} has parts that are not known; combine 1 (time), 2 (state) and 4 (spawned)"
        )));
    }
    client.may_change_models()?;
    let has = |part: u8| scope & part != 0;
    if has(SCOPE_TIME) && !has(SCOPE_STATE) {
        return Err(Refusal::unsupported(
            "time is reset only together with the state: give scope 3 (time and state), or 0 for everything",
        ));
    }
    if scope == SCOPE_ALL {
        return reset_to_start(client);
    }
    if has(SCOPE_SPAWNED) {
        delete_spawned(client)?;
    }
    if has(SCOPE_TIME) {
        client.command(&SimulationCommand::new(Operation::ResetSimulation), "", PATIENCE)?;
    } else if has(SCOPE_STATE) {
        client.command(&SimulationCommand::new(Operation::ResetWorld), "", PATIENCE)?;
    }
    Ok(())
}

/// Removes spawned models, and restarts at time 0.
fn reset_to_start(client: &mut Client<'_>) -> Result<(), Refusal> {
    delete_spawned(client)?;
    client.command(&SimulationCommand::new(Operation::ResetSimulation), "", PATIENCE)
}

/// Removes the models that were added while the simulation ran.
fn delete_spawned(client: &mut Client<'_>) -> Result<(), Refusal> {
    for model in client.states()?.models {
        // A model that was deleted by somebody else meanwhile is gone, as it should be.
        let Ok(description) = client.describe(model.name.as_str()) else { continue };
        if description.is("spawned") {
            let mut command = SimulationCommand::new(Operation::Delete);
            command.name = Text::cut(model.name.as_str());
            client.command(&command, "", PATIENCE)?;
        }
    }
    Ok(())
}
