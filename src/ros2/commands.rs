//! [`Commands`]: velocities from ROS 2 that drive a robot.

use super::Ros2Error;
use super::cdr::Cdr;
use super::type_hash::type_hash;
use belvedere_bridge::payload::VelocityCommand;
use belvedere_bridge::{Kind, Node, Publisher, Ros, RosMessage, StreamSpec};
use belvedere_rtps::{Participant, Qos, Reader, Topic};
use std::sync::{Arc, Mutex, PoisonError};

/// The longest message that is accepted. A `geometry_msgs/msg/Twist` has 52 bytes.
const MOST_BYTES: usize = 1024;

/// The velocities for one robot.
///
/// They are handed to the simulator before they are acknowledged. So a node that steps a paused simulation knows that a
/// velocity holds from the next step on, once rclpy's `wait_for_all_acked` has returned.
#[derive(Debug)]
pub(super) struct Commands {
    topic: String,
    /// One for reliable writers and one for those that are best effort. Dropping them ends the subscription.
    _readers: [Reader; 2],
}

impl Commands {
    /// Accepts velocities on the topic `name` for the stream `topic`.
    pub(super) fn new(
        participant: &Participant,
        node: &Node,
        topic: &str,
        name: &str,
    ) -> Result<Self, Ros2Error> {
        let message = RosMessage::of(Kind::VelocityCommand, topic).ok_or(Ros2Error::NoTwist)?;
        let of = Ros::Two.type_name(message.ros.name);
        let hash = type_hash(&of, &message.definition(Ros::Two));
        let topic_of_ros = Topic { name, message: &of, hash: &hash };
        let velocities = Arc::new(Mutex::new(Velocities::new(node, topic)));
        let reader = |qos| {
            let velocities = velocities.clone();
            let pass_on = move |sample: &[u8]| {
                velocities.lock().unwrap_or_else(PoisonError::into_inner).pass_on(sample);
            };
            participant.watched_reader(topic_of_ros, qos, MOST_BYTES, pass_on)
        };
        let readers = [reader(Qos::volatile(1))?, reader(Qos::best_effort(1))?];
        Ok(Self { topic: topic.to_owned(), _readers: readers })
    }

    pub(super) fn topic(&self) -> &str {
        &self.topic
    }
}

/// Hands velocities to the simulator.
struct Velocities {
    node: Node,
    topic: String,
    /// Made at the first velocity, as a stream has few places for publishers.
    publisher: Option<Publisher>,
}

impl Velocities {
    fn new(node: &Node, topic: &str) -> Self {
        Self { node: node.clone(), topic: topic.to_owned(), publisher: None }
    }

    fn pass_on(&mut self, sample: &[u8]) {
        let Some(command) = twist(sample) else {
            tracing::warn!(
                topic = self.topic,
                "a message is ignored, since it is not a Twist of finite numbers"
            );
            return;
        };
        let ignored = |error: &belvedere_bridge::Error| tracing::warn!(topic = self.topic, %error, "a velocity is ignored");
        if self.publisher.is_none() {
            let opened = self.node.publisher(&StreamSpec::velocity_command(&self.topic));
            self.publisher = opened.inspect_err(ignored).ok();
        }
        let sent = self.publisher.as_mut().map(|open| open.send_structs(0, &[command]));
        if let Some(Err(error)) = sent {
            ignored(&error);
            self.publisher = None;
        }
    }
}

/// Reads a `geometry_msgs/msg/Twist`; `None` if it has another form or a number is not finite.
fn twist(sample: &[u8]) -> Option<VelocityCommand> {
    let mut fields = Cdr::new(sample).ok()?;
    let mut vector = || Some([fields.f64().ok()?, fields.f64().ok()?, fields.f64().ok()?]);
    let (linear, angular) = (vector()?, vector()?);
    let is_finite = [linear, angular].as_flattened().iter().all(|value| value.is_finite());
    is_finite.then_some(VelocityCommand { linear, angular })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_twist_is_read_in_both_byte_orders() {
        let values = [0.5, -1.0, 0.0, 0.0, 0.25, 2.0];
        let bytes = |header: [u8; 4], to: fn(f64) -> [u8; 8]| {
            header.into_iter().chain(values.into_iter().flat_map(to)).collect::<Vec<u8>>()
        };
        for sample in [bytes([0, 1, 0, 0], f64::to_le_bytes), bytes([0, 0, 0, 0], f64::to_be_bytes)] {
            let command = twist(&sample).unwrap();
            assert_eq!((command.linear, command.angular), ([0.5, -1.0, 0.0], [0.0, 0.25, 2.0]));
            assert!(twist(&sample[..51]).is_none());
        }
        assert!(twist(&[]).is_none() && twist(&[0, 7, 0, 0]).is_none());
        let mut sample = bytes([0, 1, 0, 0], f64::to_le_bytes);
        sample[4..12].copy_from_slice(&f64::NAN.to_le_bytes());
        assert!(twist(&sample).is_none());
    }
}
