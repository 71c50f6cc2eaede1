//! [`Outgoing`]: a stream that is published as a topic of ROS 2.

use super::Ros2Error;
use super::compressed::Compressed;
use super::type_hash::type_hash;
use crate::recording::ros::RosStream;
use belvedere_bridge::{Kind, Node, Ros, StreamInfo, StreamSpec, Subscriber};
use belvedere_rtps::{Participant, Qos, Topic, Writer};

/// A stream and its topic. The stream is followed, and its sensor rendered, only while the topic has readers.
#[derive(Debug)]
pub(super) struct Outgoing {
    stream: RosStream,
    /// The stream's topic in the domain, without a leading slash.
    topic: String,
    /// The name and the type of the topic in ROS 2.
    name: String,
    message: String,
    /// True if readers that join later get the last message.
    is_latched: bool,
    writer: Writer,
    /// The topic with the same images in less memory, if it is a stream of images.
    compressed: Option<Compressed>,
    subscriber: Option<Subscriber>,
    /// True if the stream could not be read last time, which has been reported.
    has_failed: bool,
}

/// Returns the topic of ROS 2 for a stream; `None` for commands, and for streams that ROS has no message for.
pub(super) fn ros_stream(info: &StreamInfo) -> Option<RosStream> {
    let kind = info.kind?;
    let is_command = kind.is_robot_command() || info.topic == StreamSpec::SIMULATION_COMMAND;
    (!is_command).then(|| RosStream::new(Ros::Two, kind, &info.topic, info.layers)).flatten()
}

impl Outgoing {
    /// Publishes a stream under this name.
    pub(super) fn new(
        participant: &Participant,
        info: &StreamInfo,
        stream: RosStream,
        name: &str,
        qos: Qos,
        compressed: Option<Compressed>,
    ) -> Result<Self, Ros2Error> {
        let is_latched = info.kind == Some(Kind::StaticTransforms);
        let qos = if is_latched { Qos::latched() } else { qos };
        let message = Ros::Two.type_name(stream.message_type.name);
        let hash = type_hash(&message, &stream.message_type.definition(Ros::Two));
        let writer = participant.writer(Topic { name, message: &message, hash: &hash }, qos)?;
        Ok(Self {
            stream,
            topic: info.topic.clone(),
            name: name.to_owned(),
            message,
            is_latched,
            writer,
            compressed,
            subscriber: None,
            has_failed: false,
        })
    }

    pub(super) fn topic(&self) -> &str {
        &self.topic
    }

    /// Returns the type of this topic if it has that name, and another type than the messages of `stream`.
    pub(super) fn conflict(&self, name: &str, stream: &RosStream) -> Option<&str> {
        let differs = self.message != Ros::Two.type_name(stream.message_type.name);
        (self.name == name && differs).then_some(&self.message)
    }

    /// Subscribes to the stream if somebody reads the topic, and ends the subscription if nobody does. If the stream
    /// has no place for another subscriber, the next call tries again; the other topics go on.
    pub(super) fn follow(&mut self, node: &Node) {
        if let Some(compressed) = &mut self.compressed {
            compressed.follow();
        }
        let is_wanted = self.is_latched || self.writer.matched() > 0;
        if is_wanted == self.subscriber.is_some() {
            return;
        }
        self.subscriber = None;
        if is_wanted {
            match node.subscriber(&self.topic) {
                Ok(subscriber) => (self.subscriber, self.has_failed) = (Some(subscriber), false),
                Err(error) => self.report(&error),
            }
        }
    }

    /// Reports an error of the stream, but not again while it lasts.
    fn report(&mut self, error: &belvedere_bridge::Error) {
        if !std::mem::replace(&mut self.has_failed, true) {
            tracing::warn!(topic = self.topic, %error, "frames are not published in ROS 2");
        }
    }

    pub(super) fn subscriber(&mut self) -> Option<&mut Subscriber> {
        self.subscriber.as_mut()
    }

    /// Publishes the frames that have arrived.
    pub(super) fn send(&mut self) {
        let Some(subscriber) = &mut self.subscriber else { return };
        loop {
            match subscriber.take() {
                Ok(Some(frame)) => {
                    let mut message = self.writer.buffer();
                    // A frame that the message cannot represent is left out, as it is in recordings.
                    if self.stream.write(&frame.view(), &mut message).is_some() {
                        self.writer.write(message);
                    }
                    self.has_failed = false;
                }
                Ok(None) => return,
                Err(error) => return self.report(&error),
            }
        }
    }
}
