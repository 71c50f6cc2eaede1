//! [`RecordingReader`]: what is in an MCAP file, in the order in which it was written.

use super::chunk_sizes::CheckedChunks;
use super::lengths;
use super::ros1;
use super::skip::{Before, Skipping, chunks_before, summary};
use super::stream::RecordedStream;
use super::writer::{ABOUT, FRAMES, HASHES, STREAM};
use super::zstd::Zstd;
use super::{Attachment, RecordingError};
use belvedere_bridge::{FrameHeader, FrameView};
use mcap::records::Record;
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use std::collections::{BTreeMap, HashMap};
use std::io::{ErrorKind, Read, Seek, SeekFrom};
use std::sync::Arc;
use std::time::Duration;

/// The largest record or chunk that is taken into memory, bytes; larger ones are no chunks of ours.
const LARGEST: usize = 1 << 30;

/// As much is read at a time, bytes.
const PIECE: usize = 1 << 22;

/// A piece of a recording.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Item {
    /// Words on how the recording came about.
    About(BTreeMap<String, String>),
    /// A file that is kept in it.
    Attachment(Attachment),
    /// The hash of each stream, by topics without a leading slash, as `belvedere run --hash` prints it.
    Hashes(BTreeMap<String, String>),
    /// A stream; before its first frame.
    Stream(RecordedStream),
    /// A message of a type that others read. If it is of a stream of ours, its frame follows.
    Message(Message),
    /// A frame as it was.
    Frame(RecordedFrame),
}

/// A message by its channel.
#[derive(Debug, Clone, PartialEq)]
pub struct Message {
    /// As the file has it.
    pub topic: String,
    /// The name of its type; empty without a schema.
    pub type_name: String,
    /// When it was recorded, nanoseconds.
    pub log_time_ns: u64,
    /// The message.
    pub data: Arc<Vec<u8>>,
}

/// A frame of a stream.
#[derive(Debug, Clone)]
pub struct RecordedFrame {
    /// Without a leading slash.
    pub topic: String,
    /// When it was recorded: simulated time that never goes back, nanoseconds.
    pub log_time_ns: u64,
    /// As it was sent.
    pub header: Box<FrameHeader>,
    /// As it was sent.
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
    /// The message before the next frame.
    last: Option<Arc<Vec<u8>>>,
    /// Time of the first message, if chunks are left out.
    begins_ns: Option<u64>,
    ended: bool,
}

#[derive(Debug, Clone)]
struct Channel {
    topic: String,
    type_name: String,
}

impl<R: Read + Seek> RecordingReader<Skipping<R>> {
    /// Reads what there is from so long after the beginning on, and before that at least what is told once, as static
    /// transforms. By the index most of what is before is not read; a file that has none is read from its beginning.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub fn starting_at(source: R, start: Duration) -> Result<Self, RecordingError> {
        Self::without(source, start, Before::ToldOnce)
    }

    /// Reads what there is from so long after the beginning on, and before that at least the last frame of each stream.
    ///
    /// # Errors
    /// When the file cannot be read.
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
            // Their descriptions may be in what is left out.
            for channel in index.channels.values() {
                let type_name =
                    channel.schema.as_ref().map_or_else(String::new, |schema| schema.name.clone());
                reader.channels.insert(channel.id, Channel { topic: channel.topic.clone(), type_name });
            }
            reader.begins_ns = index.stats.map(|stats| stats.message_start_time);
        }
        Ok(reader)
    }
}

impl<R: Read> RecordingReader<R> {
    /// Reads from here.
    pub fn new(source: R) -> Self {
        Self::checking(source, u64::MAX, true)
    }

    /// Reads a file of at most so many bytes, with the sum over all that is before the index, or without.
    fn checking(source: R, file_len: u64, is_whole: bool) -> Self {
        // Checked before anything of a chunk is given: what is given is whole.
        let options = LinearReaderOptions::default()
            .with_prevalidate_chunk_crcs(true)
            .with_validate_data_section_crc(is_whole)
            .with_validate_summary_section_crc(true)
            .with_record_length_limit(LARGEST);
        let mut reader = LinearReader::new_with_options(options);
        // Refused would be one without a name.
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

    /// Time of the file's first message, nanoseconds, where its index told it.
    pub(super) fn begins_ns(&self) -> Option<u64> {
        self.begins_ns
    }

    /// Who wrote the file, as it says.
    pub fn library(&self) -> &str {
        &self.library
    }

    /// The next piece; none at the end of a file that is complete.
    ///
    /// # Errors
    /// [`RecordingError::Cut`] at the end of one that is not, once all that is whole has been given;
    /// [`RecordingError::NotMcap`], [`RecordingError::Broken`]. After an error there is nothing more.
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
                    // Piece by piece: what a damaged length asks for is not there.
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
                self.channels.insert(channel.id, Channel { topic: channel.topic, type_name });
                Step::Nothing
            }
            Record::Metadata(metadata) => match metadata.name.as_str() {
                ABOUT => Step::Item(Item::About(metadata.metadata)),
                HASHES => Step::Item(Item::Hashes(metadata.metadata)),
                STREAM => match RecordedStream::from_metadata(&metadata.metadata) {
                    Some(stream) => Step::Item(Item::Stream(stream)),
                    None => {
                        return Err(RecordingError::Broken(format!(
                            "a stream is described as {:?}, which this version does not understand",
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
                        "a message is of channel {}, which is nowhere described",
                        header.channel_id
                    )));
                };
                let (channel, data) = (channel.clone(), data.into_owned());
                match self.message(channel, header.log_time, data) {
                    // Of the first frame after a gap the message may be in the gap.
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
            let Channel { topic, type_name } = channel;
            return Ok(Item::Message(Message { topic, type_name, log_time_ns, data }));
        };
        let wrong = |what: &str| RecordingError::Broken(format!("a frame of /{topic} {what}"));
        let (header, offset, payload) =
            ros1::read_frame(&data).ok_or_else(|| wrong("has not the form of one"))?;
        let len = usize::try_from(header.payload_len).unwrap_or(usize::MAX);
        let payload = if payload.is_empty() && len > 0 {
            let last = self.last.take().unwrap_or_default();
            let range =
                usize::try_from(offset).ok().and_then(|offset| Some(offset..offset.checked_add(len)?));
            range
                .and_then(|range| last.get(range))
                .ok_or_else(|| wrong("has its payload in the message before, which does not have it"))?
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
