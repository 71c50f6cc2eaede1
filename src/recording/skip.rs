//! Skips the chunks of a recording that end before a given time, using its index.

use super::lengths;
use super::writer::FRAMES;
use mcap::Summary;
use mcap::sans_io::summary_reader::{SummaryReadEvent, SummaryReader};
use std::collections::{HashMap, VecDeque};
use std::io::{Read, Result, Seek, SeekFrom};
use std::ops::Range;
use std::time::Duration;

/// Bytes of the footer and the magic bytes at the end of a file: opcode, length, three numbers, the magic.
const FOOTER: u64 = 1 + 8 + 20 + 8;

/// Largest index that is read, bytes: that of a recording of some terabytes. A damaged place of the index may be that of
/// the first chunk.
const LARGEST_INDEX: u64 = 1 << 28;

/// Reads a file without some ranges.
#[derive(Debug)]
pub struct Skipping<R> {
    source: R,
    at: u64,
    /// The ranges of bytes that are skipped, in ascending order.
    left_out: VecDeque<Range<u64>>,
}

impl<R: Seek> Skipping<R> {
    /// Reads from the beginning, without these ranges.
    pub(super) fn new(mut source: R, left_out: Vec<Range<u64>>) -> Result<Self> {
        source.rewind()?;
        Ok(Self { source, at: 0, left_out: left_out.into() })
    }
}

impl<R: Read + Seek> Read for Skipping<R> {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        while let Some(next) = self.left_out.front()
            && next.start <= self.at
        {
            self.at = next.end.max(self.at);
            self.left_out.pop_front();
            self.source.seek(SeekFrom::Start(self.at))?;
        }
        let left = self.left_out.front().map_or(u64::MAX, |next| next.start - self.at);
        let most = buffer.len().min(usize::try_from(left).unwrap_or(usize::MAX));
        let read = self.source.read(&mut buffer[..most])?;
        self.at += read as u64;
        Ok(read)
    }
}

/// Returns the index at the end of a file, or `None` if the file is incomplete.
pub(super) fn summary(source: &mut (impl Read + Seek)) -> Option<Summary> {
    check_lengths(source)?;
    let mut reader = SummaryReader::new();
    while let Some(event) = reader.next_event() {
        match event.ok()? {
            SummaryReadEvent::ReadRequest(need) => {
                let read = source.read(reader.insert(need)).ok()?;
                reader.notify_read(read);
            }
            SummaryReadEvent::SeekRequest(to) => reader.notify_seeked(source.seek(to).ok()?),
        }
    }
    reader.finish()
}

/// Checks the lengths of all texts in the index, before the library reserves memory for them. Returns `None` if one is
/// wrong.
fn check_lengths(source: &mut (impl Read + Seek)) -> Option<()> {
    let size = source.seek(SeekFrom::End(0)).ok()?;
    let footer = size.checked_sub(FOOTER)?;
    source.seek(SeekFrom::Start(footer)).ok()?;
    let mut bytes = [0; FOOTER as usize];
    source.read_exact(&mut bytes).ok()?;
    let begin = u64::from_le_bytes(*bytes[9..].first_chunk()?);
    if begin == 0 {
        return Some(());
    }
    let len = footer.checked_sub(begin).filter(|len| *len <= LARGEST_INDEX)?;
    source.seek(SeekFrom::Start(begin)).ok()?;
    let mut index = Vec::new();
    source.take(len).read_to_end(&mut index).ok()?;
    let mut rest = &index[..];
    while let Some((opcode, after)) = rest.split_first() {
        let (len, after) = after.split_first_chunk::<8>()?;
        let (body, after) = after.split_at_checked(usize::try_from(u64::from_le_bytes(*len)).ok()?)?;
        lengths::check(*opcode, body).ok()?;
        rest = after;
    }
    source.rewind().ok()
}

/// The frames from before a reader's start that are needed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Before {
    /// Latched messages, such as static transforms.
    Latched,
    /// The last frame of each stream as well, which a consumer would have seen last if everything had been played.
    LastOfEach,
}

/// Returns the chunks that can be skipped if reading starts `start` after the first message: all that end before,
/// except the last of them, because a frame's payload may be in the previous message, and except those with needed
/// frames.
pub(super) fn chunks_before(summary: &Summary, start: Duration, wanted: Before) -> Vec<Range<u64>> {
    let Some(stats) = &summary.stats else { return Vec::new() };
    let start_ns =
        u64::try_from(start.as_nanos()).unwrap_or(u64::MAX).saturating_add(stats.message_start_time);
    let topic = |id: &u16| summary.channels.get(id).map_or("", |channel| channel.topic.as_str());
    let mut chunks: Vec<_> = summary.chunk_indexes.iter().collect();
    chunks.sort_unstable_by_key(|chunk| chunk.chunk_start_offset);
    let before = chunks.partition_point(|chunk| chunk.message_end_time < start_ns);
    let mut is_kept = vec![false; before];
    let mut last_of_each = HashMap::new();
    for (number, chunk) in chunks[..before].iter().enumerate() {
        for channel in chunk.message_index_offsets.keys() {
            is_kept[number] |= is_latched(topic(channel));
            last_of_each.insert(channel, number);
        }
    }
    if let Some(last) = is_kept.last_mut() {
        *last = true;
    }
    if wanted == Before::LastOfEach {
        for (_, number) in last_of_each.into_iter().filter(|(channel, _)| topic(channel).starts_with(FRAMES))
        {
            // The frame's payload may be in the previous chunk.
            is_kept[number.saturating_sub(1)..=number].fill(true);
        }
    }
    let left_out = chunks.iter().zip(is_kept).filter(|(_, is_kept)| !is_kept);
    left_out
        .map(|(chunk, _)| {
            let end = chunk.chunk_start_offset + chunk.chunk_length + chunk.message_index_length;
            chunk.chunk_start_offset..end
        })
        .collect()
}

/// Returns true if a channel's frames are latched, so that they are needed by later readers: static transforms and
/// sensor settings.
fn is_latched(topic: &str) -> bool {
    let stream = topic.strip_prefix(FRAMES).and_then(|topic| topic.rsplit('/').next());
    matches!(stream, Some("tf_static" | "sensor_settings"))
}
