//! [`Commands`]: velocities from ROS 2 that drive a robot.

use super::Ros2Error;
use super::cdr::Cdr;
use super::messages::Message;
use belvedere_bridge::payload::VelocityCommand;
use belvedere_bridge::{Node, Publisher, StreamSpec};
use belvedere_rtps::{Participant, Qos, Reader, Topic};
use std::sync::{Arc, Mutex, PoisonError};

/// The longest message that is accepted. A `geometry_msgs/msg/Twist` has 52 bytes.
const MOST_BYTES: usize = 1024;

/// A message that is a velocity.
#[derive(Debug, Clone, Copy)]
struct Form {
    message: Message,
    /// Reads the message in CDR; `None` if it has another form or a number is not finite.
    read: fn(&[u8]) -> Option<VelocityCommand>,
}

impl Form {
    /// The messages that drive a robot. Nodes of ROS 2 up to Jazzy send Twist, later ones `TwistStamped`.
    const ALL: [Self; 2] = [
        Self { message: Message::TWIST, read: twist },
        Self { message: Message::TWIST_STAMPED, read: twist_stamped },
    ];
}

/// The velocities for one robot.
///
/// They are handed to the simulator before they are acknowledged. So a node that steps a paused simulation knows that a
/// velocity holds from the next step on, once rclpy's `wait_for_all_acked` has returned.
#[derive(Debug)]
pub(super) struct Commands {
    topic: String,
    /// For each form, one for reliable writers and one for those that are best effort. Dropping them ends the
    /// subscription.
    _readers: Vec<Reader>,
}

impl Commands {
    /// Accepts velocities on the topic `name` for the stream `topic`.
    pub(super) fn new(
        participant: &Participant,
        node: &Node,
        topic: &str,
        name: &str,
    ) -> Result<Self, Ros2Error> {
        let velocities = Arc::new(Mutex::new(Velocities::new(node, topic)));
        let mut readers = Vec::new();
        for form in Form::ALL {
            let (of, hash) = (form.message.name(), form.message.hash());
            for qos in [Qos::volatile(1), Qos::best_effort(1)] {
                let velocities = velocities.clone();
                let pass_on = move |sample: &[u8]| {
                    velocities.lock().unwrap_or_else(PoisonError::into_inner).pass_on(form, sample);
                };
                let topic_of_ros = Topic { name, message: &of, hash: &hash };
                readers.push(participant.watched_reader(topic_of_ros, qos, MOST_BYTES, pass_on)?);
            }
        }
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
    /// True if the last message was wrong, which has been reported.
    was_wrong: bool,
}

impl Velocities {
    fn new(node: &Node, topic: &str) -> Self {
        Self { node: node.clone(), topic: topic.to_owned(), publisher: None, was_wrong: false }
    }

    fn pass_on(&mut self, form: Form, sample: &[u8]) {
        let command = (form.read)(sample);
        let was_wrong = std::mem::replace(&mut self.was_wrong, command.is_none());
        let Some(command) = command else {
            if !was_wrong {
                tracing::warn!(
                    topic = self.topic,
                    "messages are ignored, since they are not a {} of finite numbers; correct their sender",
                    form.message.name()
                );
            }
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

/// Reads a `geometry_msgs/msg/Twist`.
fn twist(sample: &[u8]) -> Option<VelocityCommand> {
    velocity(&mut Cdr::new(sample).ok()?)
}

/// Reads a `geometry_msgs/msg/TwistStamped`. Its time and frame do not matter: a robot obeys the velocity that came last,
/// in its own frame.
fn twist_stamped(sample: &[u8]) -> Option<VelocityCommand> {
    let mut fields = Cdr::new(sample).ok()?;
    let _stamp = (fields.i32().ok()?, fields.u32().ok()?);
    let _frame = fields.text().ok()?;
    velocity(&mut fields)
}

fn velocity(fields: &mut Cdr<'_>) -> Option<VelocityCommand> {
    let mut vector = || Some([fields.f64().ok()?, fields.f64().ok()?, fields.f64().ok()?]);
    let (linear, angular) = (vector()?, vector()?);
    let is_finite = [linear, angular].as_flattened().iter().all(|value| value.is_finite());
    is_finite.then_some(VelocityCommand { linear, angular })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn velocities_are_read_in_both_byte_orders() {
        type Write = (fn(u32) -> [u8; 4], fn(f64) -> [u8; 8]);
        type Read = fn(&[u8]) -> Option<VelocityCommand>;
        let values = [0.5, -1.0, 0.0, 0.0, 0.25, 2.0];
        let orders: [(u8, Write); 2] =
            [(0, (u32::to_be_bytes, f64::to_be_bytes)), (1, (u32::to_le_bytes, f64::to_le_bytes))];
        for (order, (whole, real)) in orders {
            let plain = [0, order, 0, 0].into_iter().chain(values.into_iter().flat_map(real));
            let plain: Vec<u8> = plain.collect();
            // A name of five bytes with its 0 ends at 17, so seven bytes follow that align the numbers.
            let header = [whole(3), whole(4), whole(5), *b"base"].concat();
            let stamped = [&plain[..4], &header, &[0; 8], &plain[4..]].concat();
            for (read, sample) in [(twist as Read, &plain), (twist_stamped, &stamped)] {
                let command = read(sample).unwrap();
                assert_eq!((command.linear, command.angular), ([0.5, -1.0, 0.0], [0.0, 0.25, 2.0]));
                for length in 0..sample.len() {
                    assert!(read(&sample[..length]).is_none(), "{length} bytes");
                }
                let mut wrong = sample.clone();
                let last = sample.len() - 8;
                wrong[last..].copy_from_slice(&real(f64::NAN));
                assert!(read(&wrong).is_none());
            }
        }
        assert!(twist(&[0, 7, 0, 0]).is_none());
        let long = [&[0, 1, 0, 0][..], &[0; 8], &[0xff; 4], &[0; 60]].concat();
        assert!(twist_stamped(&long).is_none());
    }
}
