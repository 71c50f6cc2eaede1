//! [`RecordingWriter`]: writes frames to MCAP.

use super::log_time::LogTime;
use super::ros::{self, MessageType, Payload, RosStream};
use super::stream::RecordedStream;
use super::{Attachment, RecordingError};
use belvedere_bridge::{FrameHeader, FrameView, Ros};
use mcap::WriteOptions;
use mcap::records::{MessageHeader, Metadata};
use mcap::write::NoSeek;
use std::collections::BTreeMap;
use std::io::Write;
use xxhash_rust::xxh3::Xxh3;

/// Size of a chunk in bytes, which a reader has to load at once.
const CHUNK_BYTES: u64 = 4 << 20;

/// Prefix of the topics of frames, in addition to those of ROS messages.
pub(super) const FRAMES: &str = "/belvedere/frames/";

/// Name of the metadata record that describes the recording.
pub(super) const ABOUT: &str = "belvedere";
/// Name of the metadata records that describe one stream each.
pub(super) const STREAM: &str = "belvedere.stream";
/// Name of the metadata record with the hash of each stream, at the end.
pub(super) const HASHES: &str = "belvedere.hashes";

/// Compression of chunks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Compression {
    /// No compression, which needs the least work.
    None,
    /// LZ4: a third of the size, for some milliseconds per image.
    #[default]
    Lz4,
}

/// The version of ROS whose messages a recording has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Profile {
    /// Messages of ROS 1.
    #[default]
    Ros1,
    /// Messages of ROS 2, for ros2 bag.
    Ros2,
}

impl Profile {
    fn ros(self) -> Ros {
        match self {
            Self::Ros1 => Ros::One,
            Self::Ros2 => Ros::Two,
        }
    }
}

/// Identifies a stream in a [`RecordingWriter`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StreamId(usize);

/// Counts the recorded frames of a stream.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StreamTally {
    /// The topic, without a leading slash.
    pub topic: String,
    /// Number of frames.
    pub frames: u64,
    /// Hash of their timestamps and payloads. It equals that of `belvedere run --hash` if no frame is missing.
    pub hash: u128,
}

/// Writes a recording.
///
/// Each frame of a stream that has a ROS message is written as that message on its ROS topic. The data that the message
/// lacks are written in addition on a separate topic, so that a replay has every byte. A recording that is not
/// [finished](Self::finish) has no index; it can be read up to the last [`flush`](Self::flush).
pub struct RecordingWriter<W: Write> {
    ros: Ros,
    file: mcap::Writer<NoSeek<W>>,
    streams: Vec<Stream>,
    time: LogTime,
    message: Vec<u8>,
    frame: Vec<u8>,
    bytes: u64,
}

struct Stream {
    topic: String,
    ros: Option<RosStream>,
    /// The channels of ROS messages and of frames, created at the first frame.
    channels: Option<(Option<u16>, u16)>,
    frames: u64,
    hash: Xxh3,
}

impl<W: Write> RecordingWriter<W> {
    /// Starts a recording; `about` describes how it was made.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn new(
        output: W,
        profile: Profile,
        compression: Compression,
        about: &BTreeMap<String, String>,
    ) -> Result<Self, RecordingError> {
        let compression = match compression {
            Compression::None => None,
            Compression::Lz4 => Some(mcap::Compression::Lz4),
        };
        // Without seeking, a chunk is written only when it is complete, so that a kill does not leave part of one.
        let options = WriteOptions::new()
            .profile(match profile {
                Profile::Ros1 => "ros1",
                Profile::Ros2 => "ros2",
            })
            .library(format!("belvedere {}", env!("CARGO_PKG_VERSION")))
            .compression(compression)
            .chunk_size(Some(CHUNK_BYTES))
            .disable_seeking(true);
        let mut file = options.create(NoSeek::new(output))?;
        file.write_metadata(&Metadata { name: ABOUT.into(), metadata: about.clone() })?;
        if profile == Profile::Ros2 {
            let [name, key, value] = ros::OLD_METADATA;
            let metadata = BTreeMap::from([(key.to_owned(), value.to_owned())]);
            file.write_metadata(&Metadata { name: name.to_owned(), metadata })?;
        }
        Ok(Self {
            ros: profile.ros(),
            file,
            streams: Vec::new(),
            time: LogTime::default(),
            message: Vec::new(),
            frame: Vec::new(),
            bytes: 0,
        })
    }

    /// Stores a file in the recording.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn attach(&mut self, attachment: &Attachment) -> Result<(), RecordingError> {
        let Attachment { name, media_type, data } = attachment;
        Ok(self.file.attach(&mcap::Attachment {
            log_time: 0,
            create_time: 0,
            name: name.clone(),
            media_type: media_type.clone(),
            data: data.into(),
        })?)
    }

    /// Adds a stream.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn add(&mut self, stream: &RecordedStream) -> Result<StreamId, RecordingError> {
        self.file.write_metadata(&Metadata { name: STREAM.into(), metadata: stream.to_metadata() })?;
        self.streams.push(Stream {
            topic: stream.topic.clone(),
            ros: RosStream::new(self.ros, stream.kind, &stream.topic, stream.layers),
            channels: None,
            frames: 0,
            hash: Xxh3::new(),
        });
        Ok(StreamId(self.streams.len() - 1))
    }

    /// Records a frame.
    ///
    /// # Errors
    /// If its header is invalid, or the file cannot be written.
    pub fn write(
        &mut self,
        stream: StreamId,
        header: &FrameHeader,
        payload: &[u8],
    ) -> Result<(), RecordingError> {
        let stream = &mut self.streams[stream.0];
        let view = FrameView::new(header, payload)
            .map_err(|error| RecordingError::Frame { topic: stream.topic.clone(), error })?;
        let within = match &stream.ros {
            Some(ros) => ros.write(&view, &mut self.message),
            None => None,
        };
        ros::write_frame(self.ros, header, payload, within.unwrap_or(Payload::Elsewhere), &mut self.frame);
        let (ros_channel, frame_channel) = match stream.channels {
            Some(channels) => channels,
            None => *stream.channels.insert(open_channels(&mut self.file, self.ros, stream)?),
        };
        let log_time = self.time.next(header.kind(), header.stamp_ns);
        let of = |channel_id| MessageHeader {
            channel_id,
            sequence: header.seq as u32,
            log_time,
            publish_time: header.stamp_ns,
        };
        if let (Some(channel), Some(_)) = (ros_channel, within) {
            self.file.write_to_known_channel(&of(channel), &self.message)?;
            self.bytes += self.message.len() as u64;
        }
        self.file.write_to_known_channel(&of(frame_channel), &self.frame)?;
        self.bytes += self.frame.len() as u64;
        stream.frames += 1;
        let mut hash = Xxh3::with_seed(header.stamp_ns);
        hash.update(payload);
        stream.hash.update(&hash.digest128().to_le_bytes());
        Ok(())
    }

    /// Returns the bytes of messages so far, before compression.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Returns the counts of what has been recorded so far.
    pub fn tallies(&self) -> Vec<StreamTally> {
        let tally = |stream: &Stream| StreamTally {
            topic: stream.topic.clone(),
            frames: stream.frames,
            hash: stream.hash.digest128(),
        };
        self.streams.iter().map(tally).collect()
    }

    /// Writes all buffered data, which can then be read even if this process is killed.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn flush(&mut self) -> Result<(), RecordingError> {
        Ok(self.file.flush()?)
    }

    /// Completes the recording with its hashes and its index.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn finish(mut self) -> Result<Vec<StreamTally>, RecordingError> {
        let tallies = self.tallies();
        let metadata =
            tallies.iter().map(|tally| (tally.topic.clone(), format!("{:032x}", tally.hash))).collect();
        self.file.write_metadata(&Metadata { name: HASHES.into(), metadata })?;
        self.file.finish()?;
        Ok(tallies)
    }
}

fn open_channels<W: Write>(
    file: &mut mcap::Writer<NoSeek<W>>,
    version: Ros,
    stream: &Stream,
) -> Result<(Option<u16>, u16), RecordingError> {
    let mut open = |topic: &str, message_type: MessageType| {
        let (schema_encoding, encoding) = match version {
            Ros::One => ("ros1msg", "ros1"),
            Ros::Two => ("ros2msg", "cdr"),
        };
        let name = version.type_name(message_type.name);
        let schema = file.add_schema(&name, schema_encoding, message_type.definition(version).as_bytes())?;
        let metadata = match version {
            Ros::One => BTreeMap::from([
                ("callerid".to_owned(), "/belvedere".to_owned()),
                ("latching".to_owned(), (topic == "/tf_static").to_string()),
            ]),
            Ros::Two => {
                BTreeMap::from([("offered_qos_profiles".to_owned(), ros::offered_qos_profiles(topic))])
            }
        };
        file.add_channel(schema, topic, encoding, &metadata)
    };
    let ros = match &stream.ros {
        Some(ros) => Some(open(&ros.topic, ros.message_type)?),
        None => None,
    };
    Ok((ros, open(&format!("{FRAMES}{}", stream.topic), ros::frame_type())?))
}
