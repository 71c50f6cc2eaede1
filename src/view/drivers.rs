//! [`Drivers`]: sends clients' velocity commands to robots.

use belvedere_bridge::payload::VelocityCommand;
use belvedere_bridge::{Kind, Node, Publisher, StreamInfo, StreamSpec};
use std::collections::BTreeMap;

/// Publishers of velocity commands. Each is created when its first command is sent, because a stream has few places for
/// publishers.
#[derive(Debug, Default)]
pub(super) struct Drivers(BTreeMap<String, Publisher>);

impl Drivers {
    /// Sends a velocity in m/s and rad/s.
    ///
    /// # Errors
    /// A message, if no robot accepts commands on this topic, or it accepts no more publishers.
    pub(super) fn drive(
        &mut self,
        node: &Node,
        streams: &[StreamInfo],
        topic: &str,
        linear: [f64; 3],
        angular: [f64; 3],
    ) -> Result<(), String> {
        if linear.iter().chain(&angular).any(|value| !value.is_finite()) {
            return Err("a velocity must be finite".to_owned());
        }
        let topic = topic.trim_start_matches('/');
        let is_taken =
            |stream: &StreamInfo| stream.topic == topic && stream.kind == Some(Kind::VelocityCommand);
        if !streams.iter().any(is_taken) {
            self.0.remove(topic);
            return Err(format!("no robot accepts velocities on /{topic}"));
        }
        let publisher = match self.0.entry(topic.to_owned()) {
            std::collections::btree_map::Entry::Occupied(publisher) => publisher.into_mut(),
            std::collections::btree_map::Entry::Vacant(place) => {
                let publisher = node.publisher(&StreamSpec::velocity_command(topic));
                place.insert(publisher.map_err(|error| error.to_string())?)
            }
        };
        let sent = publisher.send_structs(0, &[VelocityCommand { linear, angular }]);
        sent.map(|_| ()).map_err(|error| error.to_string())
    }
}
