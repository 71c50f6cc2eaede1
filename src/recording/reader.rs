//! [`RecordingReader`]: reads the contents of an MCAP file in the order in which they were written.

use super::chunk_sizes::CheckedChunks;
use super::lengths;
use super::ros;
use super::skip::{Before, Skipping, chunks_before, summary};
use super::stream::RecordedStream;
use super::writer::{ABOUT, FRAMES, HASHES, STREAM};
use super::zstd::Zstd;
use super::{Attachment, RecordingError};
use belvedere_bridge::{FrameHeader, FrameView, Ros};
use mcap::records::Record;
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use std::collections::{BTreeMap, HashMap};
use std::io::{ErrorKind, Read, Seek, SeekFrom};
use std::sync::Arc;
use std::time::Duration;

/// The largest record or chunk that is loaded into memory, bytes. Belvedere writes no larger ones.
const LARGEST: usize = 1 << 30;

/// Most bytes that are read at a time.
const PIECE: usize = 1 << 22;

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
    source: CheckedChunks<R>,
    reader: LinearReader,
    library: String,
    schemas: HashMap<u16, String>,
    channels: HashMap<u16, Channel>,
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
        let index = (start > Duration::ZERO).then(|| summary(&mut source)).flatten();
        let left_out = index.as_ref().map_or_else(Vec::new, |index| chunks_before(index, start, wanted));
        let is_whole = left_out.is_empty();
        let file_len = source.seek(SeekFrom::End(0))?;
        let mut reader = Self::checking(Skipping::new(source, left_out)?, file_len, is_whole);
        if let Some(index) = index.filter(|_| !is_whole) {
            // The descriptions of channels may be in the skipped chunks.
            for channel in index.channels.values() {
                let type_name =
                    channel.schema.as_ref().map_or_else(String::new, |schema| schema.name.clone());
                let described = Channel::new(channel.topic.clone(), type_name, &channel.message_encoding);
                reader.channels.insert(channel.id, described);
            }
            reader.begins_ns = index.stats.map(|stats| stats.message_start_time);
        }
        Ok(reader)
    }
}

impl<R: Read> RecordingReader<R> {
    /// Reads from the source's current position.
    pub fn new(source: R) -> Self {
        Self::checking(source, u64::MAX, true)
    }

    /// Reads a file of at most `file_len` bytes. If `is_whole`, verifies the checksum of everything before the index.
    fn checking(source: R, file_len: u64, is_whole: bool) -> Self {
        // Chunks are checked before any of their contents are returned.
        let options = LinearReaderOptions::default()
            .with_prevalidate_chunk_crcs(true)
            .with_validate_data_section_crc(is_whole)
            .with_validate_summary_section_crc(true)
            .with_record_length_limit(LARGEST);
        let mut reader = LinearReader::new_with_options(options);
        // This fails only for a decompressor without a name.
        let _ = reader.add_decompressor(Zstd::new());
        Self {
            source: CheckedChunks::new(source, file_len),
            reader,
            library: String::new(),
            schemas: HashMap::new(),
            channels: HashMap::new(),
            last: None,
            begins_ns: None,
            ended: false,
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

    /// Returns the next item, or `None` at the end of a complete file.
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
        let record = match self.reader.next_event() {
            None => return Ok(Step::End),
            Some(Err(error)) => return Err(error.into()),
            Some(Ok(LinearReadEvent::ReadRequest(need))) => {
                let read = loop {
                    // Read in pieces, because a damaged length may ask for more than there is.
                    match self.source.read(self.reader.insert(need.min(PIECE))) {
                        Err(error) if error.kind() == ErrorKind::Interrupted => {}
                        Err(error) if error.kind() == ErrorKind::InvalidData => {
                            return Err(RecordingError::Broken(error.to_string()));
                        }
                        read => break read?,
                    }
                };
                self.reader.notify_read(read);
                return Ok(Step::Nothing);
            }
            Some(Ok(LinearReadEvent::Record { opcode, data })) => {
                lengths::check(opcode, data)?;
                mcap::parse_record(opcode, data)?.into_owned()
            }
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
            Record::Metadata(metadata) => match metadata.name.as_str() {
                ABOUT => Step::Item(Item::About(metadata.metadata)),
                HASHES => Step::Item(Item::Hashes(metadata.metadata)),
                STREAM => match RecordedStream::from_metadata(&metadata.metadata) {
                    Some(stream) => Step::Item(Item::Stream(stream)),
                    None => {
                        return Err(RecordingError::Broken(format!(
                            "a stream has the description {:?}, which this version does not understand",
                            metadata.metadata
                        )));
                    }
                },
                _ => Step::Nothing,
            },
            Record::Attachment { header, data, .. } => Step::Item(Item::Attachment(Attachment {
                name: header.name,
                media_type: header.media_type,
                data: data.into_owned(),
            })),
            Record::Message { header, data } => {
                let Some(channel) = self.channels.get(&header.channel_id) else {
                    return Err(RecordingError::Broken(format!(
                        "a message belongs to channel {}, which the recording does not describe",
                        header.channel_id
                    )));
                };
                let (channel, data) = (channel.clone(), data.into_owned());
                match self.message(channel, header.log_time, data) {
                    // The message of the first frame after skipped chunks may be in them.
                    Err(RecordingError::Broken(_)) if self.begins_ns.is_some() => Step::Nothing,
                    item => Step::Item(item?),
                }
            }
            _ => Step::Nothing,
        })
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
