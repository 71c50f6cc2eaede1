//! The services `SpawnEntity` and `SpawnEntities`.

use super::client::Client;
use super::geometry::{Pose, read_pose_stamped, set_pose};
use super::refusal::{Refusal, result};
use super::resource::{self, RESOURCE_PARSE_ERROR};
use crate::entities::{MAX_NAME_BYTES, model_name, namespace};
use crate::ros2::cdr::{Cdr, Unreadable};
use crate::server::values;
use belvedere_bridge::payload::SimulationCommand;
use belvedere_bridge::{Operation, RosBytes, Text};
use std::time::Duration;

/// Longest wait for a model to be added. Large meshes take seconds.
const PATIENCE: Duration = Duration::from_secs(60);
/// Most requests in a list.
const MOST_REQUESTS: usize = 64;
/// Most names that are tried for a model whose name is taken.
const MOST_NAMES: usize = 1000;

/// Results of `SpawnEntity`.
const NAME_NOT_UNIQUE: u8 = 101;
const NAME_INVALID: u8 = 102;
const NAMESPACE_INVALID: u8 = 105;
const INVALID_POSE: u8 = 109;
/// A result of `SpawnEntities`.
const ENTITIES_SPAWN_FAILED: u8 = 150;

/// The request of `SpawnEntity`, or an element of that of `SpawnEntities`.
struct Wanted {
    name: String,
    allow_renaming: bool,
    uri: String,
    text: String,
    namespace: String,
    frame: String,
    pose: Pose,
}

impl Wanted {
    fn read(fields: &mut Cdr<'_>) -> Result<Self, Unreadable> {
        let name = fields.text()?.to_owned();
        let allow_renaming = fields.bool()?;
        let (uri, text) = (fields.text()?.to_owned(), fields.text()?.to_owned());
        let namespace = fields.text()?.to_owned();
        let (frame, pose) = read_pose_stamped(fields)?;
        Ok(Self { name, allow_renaming, uri, text, namespace, frame, pose })
    }
}

/// Adds a model, and answers with its name.
pub(super) fn spawn_entity(client: &mut Client<'_>, request: &[u8], reply: &mut RosBytes<'_>) {
    let wanted = Cdr::new(request).and_then(|mut fields| Wanted::read(&mut fields));
    let name = wanted.map_err(Refusal::from).and_then(|wanted| spawn(client, wanted));
    let name = result(reply, name).unwrap_or_default();
    reply.text(&name);
}

/// Adds several models. One that cannot be added does not prevent the others.
pub(super) fn spawn_entities(client: &mut Client<'_>, request: &[u8], reply: &mut RosBytes<'_>) {
    let wanted = Cdr::new(request).and_then(|mut fields| fields.list(MOST_REQUESTS, Wanted::read));
    let (outcome, results) = match wanted {
        Ok(wanted) => {
            let results: Vec<_> = wanted.into_iter().map(|wanted| spawn(client, wanted)).collect();
            let failed = results.iter().filter(|result| result.is_err()).count();
            let message =
                format!("{failed} of {} entities were not spawned; see their results", results.len());
            let outcome =
                if failed == 0 { Ok(()) } else { Err(Refusal::new(ENTITIES_SPAWN_FAILED, message)) };
            (outcome, results)
        }
        Err(reason) => (Err(reason.into()), Vec::new()),
    };
    result(reply, outcome);
    reply.count(results.len());
    for name in results {
        let name = result(reply, name).unwrap_or_default();
        reply.text(&name);
    }
}

/// Adds a model, and returns its name.
fn spawn(client: &mut Client<'_>, wanted: Wanted) -> Result<String, Refusal> {
    client.may_change_models()?;
    let Wanted { name, allow_renaming, uri, text, namespace: given, frame, pose } = wanted;
    let resource = resource::read(&uri, &text)?;
    let mut command = SimulationCommand::new(Operation::Spawn);
    set_pose(&mut command, pose);
    values::pose(&command).map_err(|why| Refusal::new(INVALID_POSE, why))?;
    let bad_namespace = |why: String| Refusal::new(NAMESPACE_INVALID, why);
    let checked = namespace(&given).map_err(bad_namespace)?;
    command.robot_namespace =
        Text::new(&checked).map_err(|why| bad_namespace(format!("'{given}': {why}")))?;
    command.reference =
        Text::new(&frame).map_err(|why| Refusal::not_found(format!("the frame '{frame}': {why}")))?;
    let name = if name.is_empty() { resource.name } else { name };
    let name = free_name(client, &name, allow_renaming)?;
    command.name = Text::cut(&name);
    client.command(&command, &resource.text, PATIENCE).map_err(|refusal| {
        // The simulator reports a problem in the text with its line, as in `crate:3: error: …`.
        let place = refusal.message.strip_prefix(&name).and_then(|rest| rest.strip_prefix(':'));
        if place.is_some_and(|rest| rest.starts_with(|first: char| first.is_ascii_digit())) {
            Refusal::new(RESOURCE_PARSE_ERROR, refusal.message)
        } else {
            refusal
        }
    })?;
    Ok(name)
}

/// Returns a name that no model has: the one that is wanted or, if it may be changed, that name with a number.
fn free_name(client: &mut Client<'_>, wanted: &str, allow_renaming: bool) -> Result<String, Refusal> {
    let valid = if wanted.is_empty() { Err("it is empty".to_owned()) } else { model_name(wanted) };
    let base = match valid {
        Ok(name) => name,
        Err(_) if allow_renaming => "entity".to_owned(),
        Err(why) => {
            return Err(Refusal::new(
                NAME_INVALID,
                format!("'{wanted}' cannot be the name of an entity: {why}"),
            ));
        }
    };
    for number in 0..MOST_NAMES {
        let suffix = if number == 0 { String::new() } else { format!("_{number}") };
        let mut end = base.len().min(MAX_NAME_BYTES - suffix.len());
        while !base.is_char_boundary(end) {
            end -= 1;
        }
        let name = format!("{}{suffix}", &base[..end]);
        match client.describe(&name) {
            Err(refusal) if refusal.code == super::refusal::code::NOT_FOUND => return Ok(name),
            Err(refusal) => return Err(refusal),
            Ok(_) if allow_renaming => {}
            Ok(_) => {
                return Err(Refusal::new(
                    NAME_NOT_UNIQUE,
                    format!("there is an entity '{name}' already; give another name, or set allow_renaming"),
                ));
            }
        }
    }
    Err(Refusal::new(NAME_NOT_UNIQUE, format!("{MOST_NAMES} names such as '{base}' are taken")))
}
