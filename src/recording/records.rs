//! [`Records`]: the records of an MCAP file in their order, without those that are damaged.

use super::RecordingError;
use super::chunk_sizes::CheckedChunks;
use super::lengths;
use super::zstd::Zstd;
use mcap::McapError;
use mcap::records::{Record, op};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use std::io::{Cursor, ErrorKind, Read};

/// The largest record or chunk that is loaded into memory, bytes. Belvedere writes no larger ones.
const LARGEST: usize = 1 << 30;

/// Most bytes that are read at a time.
const PIECE: usize = 1 << 22;

/// A record, or what is in the place of a damaged one.
pub(super) enum Part {
    /// A record whose checksum is right, if it has one.
    Record(Record<'static>),
    /// A damaged part: what was left out and why, in a sentence.
    LeftOut(String),
}

/// Reads the records of a file, also those inside chunks. The length of a record says where the next one begins, so what
/// follows a damaged record can be read.
pub(super) struct Records<R> {
    source: R,
    reader: LinearReader,
    /// The chunk whose records are being read.
    chunk: Option<Chunk>,
    is_damaged: bool,
    has_ended: bool,
}

impl<R: Read> Records<R> {
    /// Reads from the source's current position. If `is_whole`, verifies the checksum of everything before the index.
    pub(super) fn new(source: R, is_whole: bool) -> Self {
        let options = LinearReaderOptions::default()
            .with_emit_chunks(true)
            .with_validate_data_section_crc(is_whole)
            .with_validate_summary_section_crc(true)
            .with_record_length_limit(LARGEST);
        let reader = LinearReader::new_with_options(options);
        Self { source, reader, chunk: None, is_damaged: false, has_ended: false }
    }

    /// Returns true if a part was left out so far.
    pub(super) fn is_damaged(&self) -> bool {
        self.is_damaged
    }

    /// Declares that a part cannot be used, although its bytes can be read.
    pub(super) fn be_damaged(&mut self) {
        self.is_damaged = true;
    }

    /// Returns the next part, or `None` at the end of the file.
    ///
    /// # Errors
    /// [`RecordingError::Cut`] at the end of an incomplete file; [`RecordingError::NotMcap`]; [`RecordingError::Broken`] if
    /// the place of the next record is not known.
    pub(super) fn next(&mut self) -> Result<Option<Part>, RecordingError> {
        let part = self.part()?;
        self.is_damaged |= matches!(part, Some(Part::LeftOut(_)));
        Ok(part)
    }

    fn part(&mut self) -> Result<Option<Part>, RecordingError> {
        while !self.has_ended {
            if let Some(chunk) = &mut self.chunk {
                match chunk.next() {
                    Some(part) => return Ok(Some(part)),
                    None => self.chunk = None,
                }
                continue;
            }
            match self.reader.next_event() {
                None => break,
                // All data have been read by now; the rest of the file repeats some of them.
                Some(Err(McapError::BadDataCrc { .. })) => {
                    self.has_ended = true;
                    // The damage that was found explains the wrong checksum.
                    let what =
                        "the file's checksum does not match its data, and no damaged part of them is known";
                    return Ok((!self.is_damaged).then(|| Part::LeftOut(what.into())));
                }
                Some(Err(McapError::BadSummaryCrc { .. })) => {
                    self.has_ended = true;
                    let what = "the index at the end of the file is not read: its checksum does not match";
                    return Ok(Some(Part::LeftOut(what.into())));
                }
                Some(Err(error)) => return Err(error.into()),
                Some(Ok(LinearReadEvent::ReadRequest(need))) => {
                    fill(&mut self.source, &mut self.reader, need)?;
                }
                Some(Ok(LinearReadEvent::Record { opcode: op::CHUNK, data })) => {
                    self.chunk = Some(Chunk::new(data));
                }
                Some(Ok(LinearReadEvent::Record { opcode, data })) => return Ok(Some(parsed(opcode, data))),
            }
        }
        Ok(None)
    }
}

/// The records of a chunk, which is checked before any of them is returned.
struct Chunk {
    record: CheckedChunks<Cursor<Vec<u8>>>,
    reader: LinearReader,
    /// Times of its first and last message, nanoseconds.
    times_ns: Option<[u64; 2]>,
    is_over: bool,
}

impl Chunk {
    /// Reads the content of a chunk's record.
    fn new(data: &[u8]) -> Self {
        let data = without_padding(data);
        let record = [&[op::CHUNK][..], &(data.len() as u64).to_le_bytes(), data].concat();
        let number = |at: usize| Some(u64::from_le_bytes(*data.get(at..)?.first_chunk()?));
        // Nothing in the chunk is larger than its content, whose stated size `CheckedChunks` checks.
        let content = number(16).and_then(|len| usize::try_from(len).ok()).unwrap_or(LARGEST);
        let options = LinearReaderOptions::default()
            .with_skip_start_magic(true)
            .with_skip_end_magic(true)
            .with_prevalidate_chunk_crcs(true)
            .with_record_length_limit(content.max(record.len()).min(LARGEST));
        let mut reader = LinearReader::new_with_options(options);
        // This fails only for a decompressor without a name.
        let _ = reader.add_decompressor(Zstd::new());
        let times_ns = number(0).zip(number(8)).map(|(first, last)| [first, last]);
        let len = record.len() as u64;
        Self { record: CheckedChunks::of_record(Cursor::new(record), len), reader, times_ns, is_over: false }
    }

    /// Returns the next of its records, or that the rest of it is left out.
    fn next(&mut self) -> Option<Part> {
        while !self.is_over {
            let why = match self.reader.next_event() {
                None => break,
                Some(Ok(LinearReadEvent::ReadRequest(need))) => {
                    match fill(&mut self.record, &mut self.reader, need) {
                        Ok(()) => continue,
                        Err(RecordingError::Broken(why)) => why,
                        Err(error) => error.to_string(),
                    }
                }
                Some(Ok(LinearReadEvent::Record { opcode, data })) => return Some(parsed(opcode, data)),
                Some(Err(error)) => why(&error),
            };
            self.is_over = true;
            let [first, last] = self.times_ns.unwrap_or_default().map(|time_ns| time_ns as f64 * 1e-9);
            return Some(Part::LeftOut(format!(
                "a chunk, with all messages from {first:.3} s to {last:.3} s, is left out: {why}"
            )));
        }
        None
    }
}

/// Returns the content of a chunk without what follows its records. If a damaged record reaches into that, the library's
/// count of the bytes that remain overflows.
fn without_padding(data: &[u8]) -> &[u8] {
    let end = || {
        let compression = lengths::text(data, 28)?;
        let records = 32 + compression.len();
        let len = u64::from_le_bytes(*data.get(records..)?.first_chunk()?);
        usize::try_from(len).ok()?.checked_add(records + 8)
    };
    end().and_then(|end| data.get(..end)).unwrap_or(data)
}

/// Gives a reader the bytes that it asks for, or fewer.
fn fill(source: &mut impl Read, reader: &mut LinearReader, need: usize) -> Result<(), RecordingError> {
    let read = loop {
        // Read in pieces, because a damaged length may ask for more than there is.
        match source.read(reader.insert(need.min(PIECE))) {
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) if error.kind() == ErrorKind::InvalidData => {
                return Err(RecordingError::Broken(error.to_string()));
            }
            read => break read?,
        }
    };
    reader.notify_read(read);
    Ok(())
}

/// Returns a record, or that it is left out because it cannot be read.
fn parsed(opcode: u8, data: &[u8]) -> Part {
    let is_whole = lengths::check(opcode, data);
    let record = is_whole
        .map_err(|error| error.to_string())
        .and_then(|()| mcap::parse_record(opcode, data).map(Record::into_owned).map_err(|error| why(&error)));
    match record {
        Ok(record) => Part::Record(record),
        Err(why) => Part::LeftOut(format!("{} is left out: {why}", name(opcode, data))),
    }
}

/// Returns the reason for an error, which the library gives with both checksums.
fn why(error: &McapError) -> String {
    match error {
        McapError::BadAttachmentCrc { .. } | McapError::BadChunkCrc { .. } => {
            "its checksum does not match".into()
        }
        McapError::UnexpectedEof | McapError::UnexpectedEoc => {
            "a record in it is longer than the chunk".into()
        }
        error => error.to_string(),
    }
}

/// Returns a name of a record for messages.
fn name(opcode: u8, data: &[u8]) -> String {
    let named = |what: &str, at: usize| match lengths::text(data, at) {
        Some(name) => format!("{what} '{name}'"),
        None => format!("{what} whose name cannot be read"),
    };
    match opcode {
        op::HEADER => "the header of the file".into(),
        op::SCHEMA => named("the message type", 2),
        op::CHANNEL => named("the description of topic", 4),
        op::MESSAGE => "a message".into(),
        op::ATTACHMENT => named("the attachment", 16),
        op::METADATA => named("the metadata record", 0),
        op::STATISTICS => "the statistics record".into(),
        _ => "a record of the index".into(),
    }
}
