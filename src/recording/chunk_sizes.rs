//! Checks whether the sizes that the chunks of an MCAP file state are possible. The reader reserves memory for the content
//! of a chunk before it reads it, and a damaged size may ask for any amount.

use mcap::records::op;
use std::io::{Error, ErrorKind, Read, Result};

/// Bytes of a record's opcode and length.
const RECORD_HEAD: usize = 9;
/// Bytes of a chunk before the name of its compression: two times, its size, its checksum, and the name's length.
const BEFORE_NAME: usize = 32;
/// Longest name of a compression that is read; all known ones have at most four letters.
const LONGEST_NAME: usize = 32;

/// Highest compression ratio of LZ4.
const LZ4_RATIO: u64 = 255;
/// Highest compression ratio of Zstandard: a block of 128 KiB that repeats one byte takes four bytes.
const ZSTD_RATIO: u64 = 32 << 10;
/// Size that every chunk may have, in bytes.
const SLACK: u64 = 64 << 10;

/// Reads records of an MCAP file and fails at a chunk that cannot have the size that it states.
#[derive(Debug)]
pub(super) struct CheckedChunks<R> {
    source: R,
    /// Size of all records, in bytes.
    file_len: u64,
    /// Number of bytes before the next record's head.
    skip: u64,
    /// The needed part of a record's beginning.
    head: Vec<u8>,
}

impl<R> CheckedChunks<R> {
    /// Checks records, of at most `len` bytes together.
    pub(super) fn of_record(source: R, len: u64) -> Self {
        Self { source, file_len: len, skip: 0, head: Vec::new() }
    }

    /// Finds and checks the records in these bytes.
    fn follow(&mut self, mut bytes: &[u8]) -> Result<()> {
        while !bytes.is_empty() {
            if self.skip > 0 {
                let skipped = bytes.len().min(usize::try_from(self.skip).unwrap_or(usize::MAX));
                self.skip -= skipped as u64;
                bytes = &bytes[skipped..];
                continue;
            }
            let missing = self.wanted() - self.head.len();
            let (taken, rest) = bytes.split_at(missing.min(bytes.len()));
            self.head.extend_from_slice(taken);
            bytes = rest;
            if self.head.len() == self.wanted() {
                self.check()?;
                let record = number(&self.head, 1).saturating_add(RECORD_HEAD as u64);
                self.skip = record.saturating_sub(self.head.len() as u64);
                self.head.clear();
            }
        }
        Ok(())
    }

    /// Returns the number of the record's bytes that are needed, given those already read.
    fn wanted(&self) -> usize {
        let is_chunk = self.head.first() == Some(&op::CHUNK);
        if self.head.len() < RECORD_HEAD || !is_chunk || number(&self.head, 1) < BEFORE_NAME as u64 {
            return RECORD_HEAD;
        }
        let before_name = RECORD_HEAD + BEFORE_NAME;
        match self.name_len() {
            // A name that is too long is refused by the reader before it reserves memory.
            Some(len) if len <= LONGEST_NAME && self.has(before_name + len + 8) => before_name + len + 8,
            _ => before_name,
        }
    }

    /// Returns true if the record has this many bytes, including its head.
    fn has(&self, len: usize) -> bool {
        number(&self.head, 1) >= (len - RECORD_HEAD) as u64
    }

    /// Returns the length of the name of a chunk's compression, once it has been read.
    fn name_len(&self) -> Option<usize> {
        let len = self.head.get(RECORD_HEAD + BEFORE_NAME - 4..)?.first_chunk()?;
        Some(u32::from_le_bytes(*len) as usize)
    }

    /// Checks a chunk whose sizes have been read.
    fn check(&self) -> Result<()> {
        let after_name = self.head.get(RECORD_HEAD + BEFORE_NAME..).unwrap_or_default();
        let Some((name, compressed)) = after_name.split_last_chunk::<8>() else { return Ok(()) };
        let uncompressed = number(&self.head, RECORD_HEAD + 16);
        let ratio = match name {
            b"" => 1,
            b"lz4" => LZ4_RATIO,
            _ => ZSTD_RATIO,
        };
        let compressed = u64::from_le_bytes(*compressed).min(self.file_len);
        if uncompressed > compressed.saturating_mul(ratio).saturating_add(SLACK) {
            return Err(Error::new(
                ErrorKind::InvalidData,
                format!(
                    "a chunk states a size of {uncompressed} bytes, which its {compressed} bytes cannot hold"
                ),
            ));
        }
        Ok(())
    }
}

/// Returns the number at this place, or 0 if it is cut off.
fn number(bytes: &[u8], at: usize) -> u64 {
    bytes.get(at..).and_then(<[u8]>::first_chunk).map_or(0, |bytes| u64::from_le_bytes(*bytes))
}

impl<R: Read> Read for CheckedChunks<R> {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        let read = self.source.read(buffer)?;
        self.follow(&buffer[..read])?;
        Ok(read)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{Cursor, copy, sink};

    fn record(opcode: u8, body: &[u8]) -> Vec<u8> {
        [&[opcode][..], &(body.len() as u64).to_le_bytes(), body].concat()
    }

    fn chunk(uncompressed: u64, compression: &str, content: &[u8]) -> Vec<u8> {
        let name = compression.as_bytes();
        let body = [
            &[0; 16][..],
            &uncompressed.to_le_bytes(),
            &[0; 4],
            &(name.len() as u32).to_le_bytes(),
            name,
            &(content.len() as u64).to_le_bytes(),
            content,
        ];
        record(op::CHUNK, &body.concat())
    }

    /// Reads a file of these records in pieces of this many bytes.
    fn read(records: &[Vec<u8>], piece: usize) -> Result<()> {
        let mut checked = CheckedChunks::of_record(Cursor::new(records.concat()), u64::MAX);
        let mut buffer = vec![0; piece];
        while checked.read(&mut buffer)? > 0 {}
        Ok(())
    }

    #[test]
    fn a_size_that_a_chunk_cannot_hold_is_found_in_pieces_of_any_length() {
        let before =
            [record(op::HEADER, &[1; 50]), chunk(60_000, "lz4", &[7; 1000]), record(op::CHANNEL, &[])];
        let after = record(op::DATA_END, &[0; 4]);
        for piece in [1, 2, 7, 64, 10_000] {
            let with = |last: Vec<u8>| read(&[&before[..], &[last, after.clone()]].concat(), piece);
            with(chunk(300_000, "lz4", &[7; 1000])).unwrap();
            with(chunk(30 << 20, "zstd", &[7; 1000])).unwrap();
            with(chunk(1000, "", &[7; 1000])).unwrap();
            for (size, compression) in [(1 << 29, "lz4"), (1 << 29, ""), (u64::MAX, "zstd")] {
                let error = with(chunk(size, compression, &[7; 1000])).unwrap_err();
                assert!(error.to_string().contains("which its 1000 bytes cannot hold"), "{error}");
            }
        }
    }

    #[test]
    fn a_size_of_the_compressed_content_is_bounded_by_the_file() {
        let mut lies = chunk(1 << 29, "lz4", &[7; 1000]);
        let at = RECORD_HEAD + BEFORE_NAME + 3;
        lies[at..at + 8].copy_from_slice(&(1_u64 << 29).to_le_bytes());
        let len = lies.len() as u64;
        let mut checked = CheckedChunks::of_record(Cursor::new(lies), len);
        assert_eq!(copy(&mut checked, &mut sink()).unwrap_err().kind(), ErrorKind::InvalidData);
    }
}
