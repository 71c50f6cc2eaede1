//! [`Descriptions`]: robots' URDFs, each on the topic `robot_description` of its namespace.

use super::messages::Message;
use super::names::Naming;
use super::{Ros2Error, cdr};
use belvedere_rtps::{Participant, Qos, Topic, Writer};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The plain URDFs of robots by their namespaces. Clones are the same collection, so the owner of a node of ROS 2 can
/// change it while the node runs.
#[derive(Debug, Clone, Default)]
pub struct Descriptions(Arc<Mutex<BTreeMap<String, String>>>);

impl Descriptions {
    /// Adds the description of the robot in a namespace, or replaces it.
    pub fn set(&self, namespace: &str, urdf: &str) {
        self.all().insert(namespace.to_owned(), urdf.to_owned());
    }

    /// Removes the description of a deleted robot.
    pub fn remove(&self, namespace: &str) {
        self.all().remove(namespace);
    }

    fn all(&self) -> MutexGuard<'_, BTreeMap<String, String>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Publishes descriptions as `robot_state_publisher` does: latched, so that nodes that start later get them.
#[derive(Debug, Default)]
pub(super) struct Described(BTreeMap<String, Robot>);

/// The description of one robot.
#[derive(Debug)]
struct Robot {
    urdf: String,
    /// `None` if ROS 2 forbids the topic, which has been reported.
    writer: Option<Writer>,
}

impl Described {
    /// Publishes what is new, and removes the topics of robots that are gone.
    pub(super) fn update(&mut self, descriptions: &Descriptions, participant: &Participant, naming: &Naming) {
        let now = descriptions.all();
        self.0.retain(|namespace, _| now.contains_key(namespace));
        for (namespace, urdf) in &*now {
            let known = self.0.get(namespace);
            if known.is_some_and(|robot| robot.urdf == *urdf) {
                continue;
            }
            let writer = self
                .0
                .remove(namespace)
                .map_or_else(|| open(participant, naming, namespace), |robot| robot.writer);
            if let Some(writer) = &writer {
                writer.write(cdr::message(|message| message.text(urdf)));
            }
            self.0.insert(namespace.clone(), Robot { urdf: urdf.clone(), writer });
        }
    }
}

/// Opens the topic of a namespace.
fn open(participant: &Participant, naming: &Naming, namespace: &str) -> Option<Writer> {
    let scope = if namespace.is_empty() { String::new() } else { format!("/{namespace}") };
    let topic = format!("{scope}/robot_description");
    let message = Message::STRING;
    let writer = |name: &str| -> Result<Writer, Ros2Error> {
        let topic = Topic { name, message: &message.name(), hash: &message.hash() };
        Ok(participant.writer(topic, Qos::latched())?)
    };
    let opened = naming.name(&topic).and_then(|name| writer(&name).map_err(|error| error.to_string()));
    opened
        .inspect_err(|reason| {
            tracing::warn!(topic, "{reason}, so it is left out; --remap gives it another name");
        })
        .ok()
}
