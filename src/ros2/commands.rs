//! [`Commands`]: velocities from ROS 2 that drive a robot.

use super::Ros2Error;
use super::cdr::Cdr;
use super::type_hash::type_hash;
use belvedere_bridge::payload::VelocityCommand;
use belvedere_bridge::{Kind, Node, Publisher, Ros, RosMessage, StreamSpec};
use belvedere_rtps::{Participant, Qos, Reader, Topic};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

/// The longest message that is accepted. A `geometry_msgs/msg/Twist` has 52 bytes.
const MOST_BYTES: usize = 1024;
/// Longest wait for a message before looking whether to stop.
const NAP: Duration = Duration::from_millis(100);

/// The velocities for one robot, received by a thread.
#[derive(Debug)]
pub(super) struct Commands {
    topic: String,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
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
        // Best effort matches writers of both kinds, and a velocity that is late is worth nothing.
        let reader = participant.reader(topic_of_ros, Qos::best_effort(1), MOST_BYTES)?;
        let stop = Arc::new(AtomicBool::new(false));
        let (node, stopped, own) = (node.clone(), stop.clone(), topic.to_owned());
        let thread = std::thread::Builder::new()
            .name("velocities".to_owned())
            .spawn(move || pass_on(&reader, &node, &own, &stopped))?;
        Ok(Self { topic: topic.to_owned(), stop, thread: Some(thread) })
    }

    pub(super) fn topic(&self) -> &str {
        &self.topic
    }
}

impl Drop for Commands {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has reported it.
            let _ = thread.join();
        }
    }
}

/// Passes velocities on until `stop` is set. The publisher is made at the first one, as a stream has few places for them.
fn pass_on(reader: &Reader, node: &Node, topic: &str, stop: &AtomicBool) {
    let mut publisher: Option<Publisher> = None;
    while !stop.load(Ordering::Relaxed) {
        let Some(sample) = reader.take(NAP) else { continue };
        let Some(command) = twist(&sample) else {
            tracing::warn!(topic, "a message is ignored, since it is not a Twist of finite numbers");
            continue;
        };
        if publisher.is_none() {
            publisher = node
                .publisher(&StreamSpec::velocity_command(topic))
                .inspect_err(|error| tracing::warn!(topic, %error, "a velocity is ignored"))
                .ok();
        }
        if let Some(Err(error)) = publisher.as_mut().map(|open| open.send_structs(0, &[command])) {
            tracing::warn!(topic, %error, "a velocity is ignored");
            publisher = None;
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
