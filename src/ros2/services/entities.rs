//! The services `GetEntities`, `GetEntitiesStates`, `GetEntityState`, `SetEntityState`, `GetEntityInfo` and
//! `DeleteEntity`.

use super::client::{Client, Description, PATIENCE, States};
use super::filters::Filters;
use super::geometry::{EntityState, set_pose, set_twist, write_state};
use super::refusal::{Refusal, result};
use crate::ros2::cdr::Cdr;
use crate::server::values;
use belvedere_bridge::payload::{ModelState, SimulationCommand};
use belvedere_bridge::{Operation, RosBytes, Text};

/// A result of `SetEntityState`.
const INVALID_POSE: u8 = 101;

/// Answers with the names of the entities that match.
pub(super) fn get_entities(client: &mut Client<'_>, request: &[u8], reply: &mut RosBytes<'_>) {
    let states = filtered(client, request);
    let models = result(reply, states).map(|states| states.models).unwrap_or_default();
    write_names(reply, &models);
}

/// Answers with the names and states of the entities that match.
pub(super) fn get_entities_states(client: &mut Client<'_>, request: &[u8], reply: &mut RosBytes<'_>) {
    let states = filtered(client, request);
    let none = States { stamp_ns: 0, models: Vec::new() };
    let States { stamp_ns, models } = result(reply, states).unwrap_or(none);
    write_names(reply, &models);
    reply.count(models.len());
    for model in &models {
        write_state(reply, stamp_ns, Some(model));
    }
}

fn filtered(client: &mut Client<'_>, request: &[u8]) -> Result<States, Refusal> {
    let filters = Filters::read(&mut Cdr::new(request)?)?;
    let States { stamp_ns, models } = client.states()?;
    Ok(States { stamp_ns, models: filters.select(models, client) })
}

fn write_names(reply: &mut RosBytes<'_>, models: &[ModelState]) {
    reply.count(models.len());
    for model in models {
        reply.text(model.name.as_str());
    }
}

/// Answers with the state of an entity.
pub(super) fn get_entity_state(client: &mut Client<'_>, request: &[u8], reply: &mut RosBytes<'_>) {
    let found = name_in(request).and_then(|name| state_of(client, &name));
    let found = result(reply, found);
    let (stamp_ns, model) = found.as_ref().map_or((0, None), |(stamp_ns, model)| (*stamp_ns, Some(model)));
    write_state(reply, stamp_ns, model);
}

fn name_in(request: &[u8]) -> Result<String, Refusal> {
    Ok(Cdr::new(request)?.text()?.to_owned())
}

fn state_of(client: &mut Client<'_>, name: &str) -> Result<(u64, ModelState), Refusal> {
    let States { stamp_ns, models } = client.states()?;
    match models.into_iter().find(|model| model.name.as_str() == name) {
        Some(model) => Ok((stamp_ns, model)),
        None => {
            Err(Refusal::not_found(format!("there is no entity '{name}'; GetEntities lists their names")))
        }
    }
}

/// Answers with the category of an entity.
pub(super) fn get_entity_info(client: &mut Client<'_>, request: &[u8], reply: &mut RosBytes<'_>) {
    let described = name_in(request).and_then(|name| describe(client, &name));
    let described = result(reply, described);
    reply.u8(described.as_ref().map_or(0, Description::category));
    let is_spawned = described.is_some_and(|model| model.is("spawned"));
    reply.text(if is_spawned { "spawned while the simulation ran" } else { "" });
    // No tags.
    reply.count(0);
}

/// Describes an entity. An empty name, which means the whole simulation elsewhere, is that of no entity.
fn describe(client: &mut Client<'_>, name: &str) -> Result<Description, Refusal> {
    if name.is_empty() {
        return Err(Refusal::not_found("the name of the entity is empty; GetEntities lists their names"));
    }
    client.describe(name)
}

/// Removes an entity.
pub(super) fn delete_entity(client: &mut Client<'_>, request: &[u8], reply: &mut RosBytes<'_>) {
    let outcome = delete(client, request);
    result(reply, outcome);
}

fn delete(client: &mut Client<'_>, request: &[u8]) -> Result<(), Refusal> {
    let name = name_in(request)?;
    client.may_change_models()?;
    describe(client, &name)?;
    client.command(&named(Operation::Delete, &name), "", PATIENCE)
}

/// Returns a command for a model that exists, whose name therefore fits.
fn named(operation: Operation, name: &str) -> SimulationCommand {
    let mut command = SimulationCommand::new(operation);
    command.name = Text::cut(name);
    command
}

/// Moves an entity, or changes its velocity.
pub(super) fn set_entity_state(client: &mut Client<'_>, request: &[u8], reply: &mut RosBytes<'_>) {
    let outcome = read_new_state(request).and_then(|new| set_state(client, &new));
    result(reply, outcome);
}

/// A request of `SetEntityState`.
struct NewState {
    name: String,
    state: EntityState,
    sets_pose: bool,
    sets_twist: bool,
}

fn read_new_state(request: &[u8]) -> Result<NewState, Refusal> {
    let mut fields = Cdr::new(request)?;
    let (name, state) = (fields.text()?.to_owned(), EntityState::read(&mut fields)?);
    // Until version 2.1 of the interfaces, a request ended here and set everything.
    let (sets_pose, sets_twist) = match fields.bool() {
        Ok(sets_pose) => (sets_pose, fields.bool()?),
        Err(_) => (true, true),
    };
    Ok(NewState { name, state, sets_pose, sets_twist })
}

fn set_state(client: &mut Client<'_>, new: &NewState) -> Result<(), Refusal> {
    let NewState { name, state, sets_pose, sets_twist } = new;
    client.may_change_models()?;
    let is_static = describe(client, name)?.is("static");
    let is_zero = |(linear, angular): ([f64; 3], [f64; 3])| linear == [0.0; 3] && angular == [0.0; 3];
    if is_static && !((is_zero(state.twist) || !sets_twist) && is_zero(state.acceleration)) {
        return Err(Refusal::failed(format!(
            "'{name}' is static, so it can have no velocity; only its pose can be set"
        )));
    }
    let mut command = named(Operation::SetModelState, name);
    command.reference = Text::new(&state.frame)
        .map_err(|why| Refusal::not_found(format!("the frame '{}': {why}", state.frame)))?;
    set_pose(&mut command, state.pose);
    set_twist(&mut command, state.twist);
    if *sets_pose {
        values::pose(&command).map_err(|why| Refusal::new(INVALID_POSE, why))?;
    }
    match (sets_pose, sets_twist) {
        (false, false) => return Ok(()),
        (true, true) => {}
        _ if !["", "world", "map"].contains(&state.frame.as_str()) => {
            return Err(Refusal::unsupported(format!(
                "in the frame '{}' pose and twist are set together; set one of them alone in the frame of the world",
                state.frame
            )));
        }
        _ => {
            let (_, now) = state_of(client, name)?;
            if *sets_pose {
                set_twist(&mut command, (now.linear, now.angular));
            } else {
                set_pose(&mut command, (now.position, now.orientation));
            }
        }
    }
    client.command(&command, "", PATIENCE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ros2::cdr::message;

    /// Version 2.1 of the interfaces has added three flags at the end.
    #[test]
    fn flags_say_what_is_set_and_everything_is_without_them() {
        let of = |flags: &[u8]| {
            let request = message(|bytes| {
                bytes.text("box");
                bytes.time(0);
                bytes.text("");
                (0..19).for_each(|number| bytes.f64(f64::from(number)));
                for flag in flags {
                    bytes.u8(*flag);
                }
            });
            let NewState { name, state, sets_pose, sets_twist } = read_new_state(&request).unwrap();
            assert_eq!((name.as_str(), state.pose), ("box", ([0.0, 1.0, 2.0], [3.0, 4.0, 5.0, 6.0])));
            assert_eq!(state.acceleration, ([13.0, 14.0, 15.0], [16.0, 17.0, 18.0]));
            (sets_pose, sets_twist)
        };
        assert_eq!(of(&[]), (true, true));
        assert_eq!(of(&[1, 0, 0]), (true, false));
        assert_eq!(of(&[0, 1, 1]), (false, true));
        assert_eq!(of(&[0, 0, 0]), (false, false));
    }
}
