//! [`StreamSpec`]: the specification of a stream.

mod lossless;

pub use lossless::Lossless;

use crate::{Encoding, Error, FrameHeader, Kind, Text, topic::canonical_topic};

/// The specification that a stream is created with.
///
/// Its pool of `max_subscribers · (buffer + borrowed) + history + loaned` frames must fit into the free space of
/// `/dev/shm`. The part that one subscriber needs is allocated at once, the rest as more subscribers connect.
#[derive(Clone, Debug, PartialEq)]
pub struct StreamSpec {
    /// The ROS topic name, with or without a leading slash.
    pub topic: String,
    /// The kind of its frames.
    pub kind: Kind,
    /// The encoding of its payload.
    pub encoding: Encoding,
    /// The coordinate frame of the data; at most 63 bytes.
    pub frame_id: String,
    /// Intended frames per second; `None` for a stream without a fixed rate.
    pub rate_hz: Option<f64>,
    /// Layers of a lidar; `None` for other streams.
    pub layers: Option<u32>,
    /// Largest payload in bytes.
    pub max_payload_len: usize,
    /// Publishers at a time: 1 for data from the robot, more for commands to it.
    pub max_publishers: usize,
    /// Subscribers at a time.
    pub max_subscribers: usize,
    /// Frames that are queued for a subscriber; a new one replaces the oldest.
    pub buffer: usize,
    /// Frames that a subscriber may hold at a time.
    pub borrowed: usize,
    /// Frames that may be loaned and unsent at a time.
    pub loaned: usize,
    /// Frames that a late subscriber receives when it connects.
    pub history: usize,
    /// The consumers that the publisher waits for. `None`: it waits for none, and a slow one loses the oldest of its
    /// queued frames.
    pub lossless: Option<Lossless>,
}

impl StreamSpec {
    /// Returns the specification of a stream from the robot: one publisher, 8 subscribers, buffer 2, 2 held, 2 loaned,
    /// history 1, overflow.
    #[must_use]
    pub fn new(topic: impl Into<String>, kind: Kind, encoding: Encoding, max_payload_len: usize) -> Self {
        Self {
            topic: topic.into(),
            kind,
            encoding,
            frame_id: String::new(),
            rate_hz: None,
            layers: None,
            max_payload_len,
            max_publishers: 1,
            max_subscribers: 8,
            buffer: 2,
            borrowed: 2,
            loaned: 2,
            history: 1,
            lossless: None,
        }
    }

    /// Returns the specification of a stream of up to `max_count` structs of this kind. Its buffer is deeper than that
    /// of images: structs are small, every one counts (transforms, odometry), and after an image that takes long to
    /// render, several arrive at once.
    #[must_use]
    pub fn structs(topic: impl Into<String>, kind: Kind, max_count: usize) -> Self {
        let elem_size = kind.struct_size().unwrap_or(1);
        Self { buffer: 16, ..Self::new(topic, kind, Encoding::Struct, elem_size * max_count.max(1)) }
    }

    /// Returns the specification of a stream of velocity commands to the robot: up to 8 senders, no history, a deeper
    /// buffer.
    #[must_use]
    pub fn velocity_command(topic: impl Into<String>) -> Self {
        Self::command(topic, Kind::VelocityCommand)
    }

    /// Returns the specification of a stream of single structs of this kind to the robot, with the settings of velocity
    /// commands.
    #[must_use]
    pub fn command(topic: impl Into<String>, kind: Kind) -> Self {
        Self { max_publishers: 8, history: 0, ..Self::structs(topic, kind, 1) }
    }

    /// Returns the specification of the stream by which other processes control a simulation. The simulator creates the
    /// receiving end. The stream carries [`SimulationCommand`](crate::payload::SimulationCommand)s from up to 8
    /// senders, each followed by at most `text_len` bytes of text. A sender opens it with the length of the longest
    /// text that it will send.
    #[must_use]
    pub fn simulation_command(text_len: usize) -> Self {
        let command = Self::structs(Self::SIMULATION_COMMAND, Kind::SimulationCommand, 1);
        let max_payload_len = command.max_payload_len + text_len;
        Self { max_publishers: 8, max_subscribers: 2, history: 0, max_payload_len, ..command }
    }

    /// Returns the specification of the stream of results of those commands.
    #[must_use]
    pub fn simulation_result() -> Self {
        Self { history: 0, ..Self::structs(Self::SIMULATION_RESULT, Kind::SimulationResult, 1) }
    }

    /// Topic of the commands to a simulation.
    pub const SIMULATION_COMMAND: &'static str = "simulation/command";
    /// Topic of the results of commands.
    pub const SIMULATION_RESULT: &'static str = "simulation/result";
    /// Topic of the settings of sensors.
    pub const SENSOR_SETTINGS: &'static str = "simulation/sensor_settings";
    /// Topic of the poses and velocities of all models.
    pub const MODEL_STATES: &'static str = "simulation/model_states";
    /// Topic of the poses and velocities of all links.
    pub const LINK_STATES: &'static str = "simulation/link_states";

    /// Returns the specification of the stream of the settings of this many sensors. It is sent at the start and after
    /// each change, and latched: consumers that connect later receive it, too.
    #[must_use]
    pub fn sensor_settings(sensors: usize) -> Self {
        Self { buffer: 4, ..Self::structs(Self::SENSOR_SETTINGS, Kind::SensorSettings, sensors) }
    }

    /// Sets the coordinate frame.
    #[must_use]
    pub fn frame_id(mut self, frame_id: impl Into<String>) -> Self {
        self.frame_id = frame_id.into();
        self
    }

    /// Sets the intended rate.
    #[must_use]
    pub fn rate_hz(mut self, rate_hz: f64) -> Self {
        self.rate_hz = Some(rate_hz);
        self
    }

    /// Sets the number of layers.
    #[must_use]
    pub fn layers(mut self, layers: u32) -> Self {
        self.layers = Some(layers);
        self
    }

    /// Returns the bytes of shared memory that one publisher's pool takes once all of its frames have been used.
    #[must_use]
    pub fn pool_bytes(&self) -> u64 {
        // The payload, Belvedere's header, and room for iceoryx2's header and alignment.
        let frame_bytes = (self.max_payload_len + size_of::<FrameHeader>() + 64).next_multiple_of(64);
        self.pool_frames() * frame_bytes as u64
    }

    /// Returns this specification with a pool of at most `bytes`, or as near to that as a stream for one subscriber can
    /// be.
    ///
    /// It reduces, in this order: subscribers, down to one; loaned frames, down to one; queued frames, down to one.
    /// History and held frames stay.
    #[must_use]
    pub fn within(&self, bytes: u64) -> Self {
        let mut spec = self.clone();
        while spec.pool_bytes() > bytes {
            if spec.max_subscribers > 1 {
                spec.max_subscribers -= 1;
            } else if spec.loaned > 1 {
                spec.loaned -= 1;
            } else if spec.buffer > 1.max(spec.history) {
                spec.buffer -= 1;
            } else {
                break;
            }
        }
        spec
    }

    /// Returns the number of frames in one publisher's pool.
    pub(crate) fn pool_frames(&self) -> u64 {
        (self.max_subscribers * (self.buffer + self.borrowed) + self.history + self.loaned) as u64
    }

    /// Returns the topic without a leading slash, which is the stream's name.
    ///
    /// # Errors
    /// [`Error::InvalidTopic`].
    pub fn name(&self) -> Result<&str, Error> {
        canonical_topic(&self.topic)
    }

    /// Returns the header that every frame of the stream begins with.
    ///
    /// # Errors
    /// If the name of the coordinate frame is too long.
    pub fn header(&self) -> Result<FrameHeader, Error> {
        Ok(FrameHeader { frame_id: Text::new(&self.frame_id)?, ..FrameHeader::new(self.kind, self.encoding) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pool_is_cut_to_what_one_subscriber_needs_and_no_further() {
        let cloud = StreamSpec::new("points", Kind::PointCloud, Encoding::XyzRgbF32, 10_000_000);
        let of = |bytes| {
            let spec = cloud.within(bytes);
            assert!(spec.pool_bytes() <= bytes.max(50_100_000), "{bytes}");
            [spec.max_subscribers, spec.buffer, spec.borrowed, spec.loaned, spec.history]
        };
        assert_eq!(cloud.within(u64::MAX), cloud);
        assert_eq!(of(400_000_000), [8, 2, 2, 2, 1]);
        assert_eq!(of(340_000_000), [7, 2, 2, 2, 1]);
        assert_eq!(of(71_000_000), [1, 2, 2, 2, 1]);
        assert_eq!(of(61_000_000), [1, 2, 2, 1, 1]);
        assert_eq!(of(51_000_000), [1, 1, 2, 1, 1]);
        assert_eq!(of(0), [1, 1, 2, 1, 1]);
        // A specification that is small enough stays as it is.
        let clock = StreamSpec::structs("clock", Kind::Clock, 1);
        assert_eq!(clock.within(1 << 20), clock);
    }
}
