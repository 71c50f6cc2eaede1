//! [`RecordingReader`]: reads the contents of an MCAP file in the order in which they were written.

use super::records::{Part, Records};
use super::ros;
use super::skip::{Before, Skipping, chunks_before, summary};
use super::stream::RecordedStream;
use super::writer::{ABOUT, FRAMES, HASHES, STREAM};
use super::{Attachment, RecordingError};
use belvedere_bridge::{FrameHeader, FrameView, Ros};
use mcap::Summary;
use mcap::records::{Metadata, Record};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::io::{Read, Seek};
use std::sync::Arc;
use std::time::Duration;

/// An item of a recording.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Item {
    /// Describes how the recording was made.
    About(BTreeMap<String, String>),
    /// A file that is stored in it.
    Attachment(Attachment),
    /// The hash of each stream, by topics without a leading slash, as `belvedere run --hash` prints it.
    Hashes(BTreeMap<String, String>),
    /// The description of a stream, before its first frame.
    Stream(RecordedStream),
    /// A message of a standard type. If it belongs to a stream of Belvedere, its frame follows.
    Message(Message),
    /// A frame as it was sent.
    Frame(RecordedFrame),
    /// A damaged part, of which nothing else is returned: what was left out and why, in a sentence.
    LeftOut(String),
}

/// A message of a channel.
#[derive(Debug, Clone, PartialEq)]
pub struct Message {
    /// The topic as in the file.
    pub topic: String,
    /// Name of its type; empty without a schema.
    pub type_name: String,
    /// Time of recording, nanoseconds.
    pub log_time_ns: u64,
    /// The message.
    pub data: Arc<Vec<u8>>,
}

/// A frame of a stream.
#[derive(Debug, Clone)]
pub struct RecordedFrame {
    /// The topic, without a leading slash.
    pub topic: String,
    /// Time of recording: simulated time that never goes back, nanoseconds.
    pub log_time_ns: u64,
    /// The header as it was sent.
    pub header: Box<FrameHeader>,
    /// The payload as it was sent.
    pub payload: Vec<u8>,
}

impl PartialEq for RecordedFrame {
    fn eq(&self, other: &Self) -> bool {
        (&self.topic, self.log_time_ns, &self.payload) == (&other.topic, other.log_time_ns, &other.payload)
            && bytemuck::bytes_of(&*self.header) == bytemuck::bytes_of(&*other.header)
    }
}

/// Reads a recording from its beginning, a chunk at a time.
pub struct RecordingReader<R: Read> {
    records: Records<R>,
    library: String,
    schemas: HashMap<u16, String>,
    channels: HashMap<u16, Channel>,
    /// The streams that were described.
    streams: HashSet<String>,
    /// The streams and channels whose frames and messages are left out, because a damaged part described them.
    unknown: HashSet<String>,
    /// The last message, which may contain the payload of the next frame.
    last: Option<Arc<Vec<u8>>>,
    /// Time of the first message, if chunks are skipped.
    begins_ns: Option<u64>,
    ended: bool,
}

#[derive(Debug, Clone)]
struct Channel {
    topic: String,
    type_name: String,
    /// The encoding of its messages, if they are frames.
    ros: Ros,
}

impl Channel {
    fn new(topic: String, type_name: String, message_encoding: &str) -> Self {
        Self { topic, type_name, ros: if message_encoding == "cdr" { Ros::Two } else { Ros::One } }
    }
}

impl<R: Read + Seek> RecordingReader<Skipping<R>> {
    /// Reads everything from `start` after the beginning, and of the time before it at least latched messages such as
    /// static transforms. The index is used to skip most of the earlier chunks; a file without an index is read from
    /// its beginning.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn starting_at(source: R, start: Duration) -> Result<Self, RecordingError> {
        Self::without(source, start, Before::Latched)
    }

    /// Reads everything from `start` after the beginning, and of the time before it at least the last frame of each
    /// stream.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub(super) fn resuming_at(source: R, start: Duration) -> Result<Self, RecordingError> {
        Self::without(source, start, Before::LastOfEach)
    }

    fn without(mut source: R, start: Duration, wanted: Before) -> Result<Self, RecordingError> {
        let index = summary(&mut source);
        let skips = index.as_ref().filter(|_| start > Duration::ZERO);
        let left_out = skips.map_or_else(Vec::new, |index| chunks_before(index, start, wanted));
        let is_whole = left_out.is_empty();
        let mut reader = Self::checking(Skipping::new(source, left_out)?, is_whole);
        if let Some(index) = index {
            reader.learn(&index);
            reader.begins_ns = index.stats.filter(|_| !is_whole).map(|stats| stats.message_start_time);
        }
        Ok(reader)
    }
}

impl<R: Read> RecordingReader<R> {
    /// Reads from the source's current position.
    pub fn new(source: R) -> Self {
        Self::checking(source, true)
    }

    /// Reads a file. If `is_whole`, verifies the checksum of everything before the index.
    fn checking(source: R, is_whole: bool) -> Self {
        Self {
            records: Records::new(source, is_whole),
            library: String::new(),
            schemas: HashMap::new(),
            channels: HashMap::new(),
            streams: HashSet::new(),
            unknown: HashSet::new(),
            last: None,
            begins_ns: None,
            ended: false,
        }
    }

    /// Takes the descriptions of channels from the index: they may be in chunks that are skipped or damaged.
    fn learn(&mut self, index: &Summary) {
        for channel in index.channels.values() {
            let type_name = channel.schema.as_ref().map_or_else(String::new, |schema| schema.name.clone());
            let described = Channel::new(channel.topic.clone(), type_name, &channel.message_encoding);
            self.channels.insert(channel.id, described);
        }
    }

    /// Returns the time of the file's first message in nanoseconds, if it was read from the index.
    pub(super) fn begins_ns(&self) -> Option<u64> {
        self.begins_ns
    }

    /// Returns the program that wrote the file, according to its header.
    pub fn library(&self) -> &str {
        &self.library
    }

    /// Returns the next item, or `None` at the end of a complete file. In the place of a damaged part there is an
    /// [`Item::LeftOut`].
    ///
    /// # Errors
    /// [`RecordingError::Cut`] at the end of an incomplete file, once all complete items have been returned;
    /// [`RecordingError::NotMcap`], [`RecordingError::Broken`]. After an error there are no more items.
    pub fn next_item(&mut self) -> Result<Option<Item>, RecordingError> {
        while !self.ended {
            match self.step() {
                Ok(Step::Item(item)) => return Ok(Some(item)),
                Ok(Step::Nothing) => {}
                Ok(Step::End) => self.ended = true,
                Err(error) => {
                    self.ended = true;
                    return Err(error);
                }
            }
        }
        Ok(None)
    }

    fn step(&mut self) -> Result<Step, RecordingError> {
        let record = match self.records.next()? {
            None => return Ok(Step::End),
            Some(Part::LeftOut(what)) => {
                // A frame after it may be the end of a message in it.
                self.last = None;
                return Ok(Step::Item(Item::LeftOut(what)));
            }
            Some(Part::Record(record)) => record,
        };
        Ok(match record {
            Record::Header(header) => {
                self.library = header.library;
                Step::Nothing
            }
            Record::Schema { header, .. } => {
                self.schemas.insert(header.id, header.name);
                Step::Nothing
            }
            Record::Channel(channel) => {
                let type_name = self.schemas.get(&channel.schema_id).cloned().unwrap_or_default();
                let described = Channel::new(channel.topic, type_name, &channel.message_encoding);
                self.channels.insert(channel.id, described);
                Step::Nothing
            }
            Record::Metadata(metadata) => self.metadata(metadata),
            Record::Attachment { header, data, .. } => Step::Item(Item::Attachment(Attachment {
                name: header.name,
                media_type: header.media_type,
                data: data.into_owned(),
            })),
            Record::Message { header, data } => {
                let Some(channel) = self.channels.get(&header.channel_id).cloned() else {
                    let channel = format!("channel {}", header.channel_id);
                    return self.not_described(&channel, "a message");
                };
                if let Some(topic) = channel.topic.strip_prefix(FRAMES)
                    && !self.streams.contains(topic)
                    && self.records.is_damaged()
                {
                    let topic = format!("/{topic}");
                    return self.not_described(&topic, "a frame");
                }
                match self.message(channel, header.log_time, data.into_owned()) {
                    // The message of the first frame after skipped chunks may be in them.
                    Err(RecordingError::Broken(_)) if self.begins_ns.is_some() => Step::Nothing,
                    Err(RecordingError::Broken(why)) if self.records.is_damaged() => {
                        Step::Item(Item::LeftOut(format!("{why}; it is left out")))
                    }
                    item => Step::Item(item?),
                }
            }
            _ => Step::Nothing,
        })
    }

    fn metadata(&mut self, metadata: Metadata) -> Step {
        match metadata.name.as_str() {
            ABOUT => Step::Item(Item::About(metadata.metadata)),
            HASHES => Step::Item(Item::Hashes(metadata.metadata)),
            STREAM => {
                let Some(stream) = RecordedStream::from_metadata(&metadata.metadata) else {
                    self.records.be_damaged();
                    return Step::Item(Item::LeftOut(format!(
                        "a stream is left out: this version does not understand its description {:?}",
                        metadata.metadata
                    )));
                };
                self.streams.insert(stream.topic.clone());
                Step::Item(Item::Stream(stream))
            }
            _ => Step::Nothing,
        }
    }

    /// Says once that the frames or messages of a stream or channel are left out, if a damaged part described it.
    ///
    /// # Errors
    /// [`RecordingError::Broken`] if no part is damaged.
    fn not_described(&mut self, of: &str, what: &str) -> Result<Step, RecordingError> {
        if !self.records.is_damaged() {
            let why = format!("{what} belongs to {of}, which the recording does not describe");
            return Err(RecordingError::Broken(why));
        }
        if !self.unknown.insert(of.to_owned()) {
            return Ok(Step::Nothing);
        }
        Ok(Step::Item(Item::LeftOut(format!("all of {of} is left out: a damaged part described it"))))
    }

    fn message(&mut self, channel: Channel, log_time_ns: u64, data: Vec<u8>) -> Result<Item, RecordingError> {
        let Some(topic) = channel.topic.strip_prefix(FRAMES) else {
            let data = Arc::new(data);
            self.last = Some(data.clone());
            let Channel { topic, type_name, .. } = channel;
            return Ok(Item::Message(Message { topic, type_name, log_time_ns, data }));
        };
        let wrong = |what: &str| RecordingError::Broken(format!("a frame of /{topic} {what}"));
        let (header, offset, payload) =
            ros::read_frame(channel.ros, &data).ok_or_else(|| wrong("has an invalid form"))?;
        let len = usize::try_from(header.payload_len).unwrap_or(usize::MAX);
        let payload = if payload.is_empty() && len > 0 {
            let last = self.last.take().unwrap_or_default();
            let range =
                usize::try_from(offset).ok().and_then(|offset| Some(offset..offset.checked_add(len)?));
            range
                .and_then(|range| last.get(range))
                .ok_or_else(|| wrong("has its payload in the previous message, which does not contain it"))?
                .to_vec()
        } else {
            payload.to_vec()
        };
        FrameView::new(&header, &payload)
            .map_err(|error| RecordingError::Frame { topic: topic.to_owned(), error })?;
        let header = Box::new(header);
        Ok(Item::Frame(RecordedFrame { topic: topic.to_owned(), log_time_ns, header, payload }))
    }
}

enum Step {
    Item(Item),
    Nothing,
    End,
}
