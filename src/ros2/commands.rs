//! [`Commands`]: velocities from ROS 2 that drive a robot.

use super::cdr::Cdr;
use super::messages::Message;
use super::{NAP, Ros2Error};
use belvedere_bridge::payload::VelocityCommand;
use belvedere_bridge::{Node, Publisher, StreamSpec};
use belvedere_rtps::{Participant, Qos, Reader, Topic};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

/// The longest message that is accepted. A `geometry_msgs/msg/Twist` has 52 bytes.
const MOST_BYTES: usize = 1024;

/// A message that is a velocity.
#[derive(Debug, Clone, Copy)]
pub(super) struct Form {
    message: Message,
    /// Reads the message in CDR; `None` if it has another form or a number is not finite.
    read: fn(&[u8]) -> Option<VelocityCommand>,
}

impl Form {
    /// The messages that drive a robot. Nodes of ROS 2 up to Jazzy send Twist, later ones `TwistStamped`.
    pub(super) const ALL: [Self; 2] = [
        Self { message: Message::TWIST, read: twist },
        Self { message: Message::TWIST_STAMPED, read: twist_stamped },
    ];
}

/// The velocities in messages of one type for one robot, received by a thread.
#[derive(Debug)]
pub(super) struct Commands {
    topic: String,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Commands {
    /// Accepts velocities of this form on the topic `name` for the stream `topic`.
    pub(super) fn new(
        participant: &Participant,
        node: &Node,
        topic: &str,
        name: &str,
        form: Form,
    ) -> Result<Self, Ros2Error> {
        let (of, hash) = (form.message.name(), form.message.hash());
        let topic_of_ros = Topic { name, message: &of, hash: &hash };
        // Best effort matches writers of both kinds, and a velocity that is late is worth nothing.
        let reader = participant.reader(topic_of_ros, Qos::best_effort(1), MOST_BYTES)?;
        let stop = Arc::new(AtomicBool::new(false));
        let (node, stopped, own) = (node.clone(), stop.clone(), topic.to_owned());
        let thread = std::thread::Builder::new()
            .name("velocities".to_owned())
            .spawn(move || pass_on(&reader, &node, &own, form, &stopped))?;
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
fn pass_on(reader: &Reader, node: &Node, topic: &str, form: Form, stop: &AtomicBool) {
    let mut publisher: Option<Publisher> = None;
    let mut was_wrong = false;
    while !stop.load(Ordering::Relaxed) {
        let Some(sample) = reader.take(NAP) else { continue };
        let command = (form.read)(&sample);
        if command.is_none() && !was_wrong {
            tracing::warn!(
                topic,
                "messages are ignored, since they are not a {} of finite numbers; correct their sender",
                form.message.name()
            );
        }
        was_wrong = command.is_none();
        let Some(command) = command else { continue };
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
