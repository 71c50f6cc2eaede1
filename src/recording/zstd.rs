//! [`Zstd`]: reads chunks that other programs compressed with Zstandard. Belvedere writes LZ4.

use mcap::sans_io::decompressor::{DecompressResult, Decompressor};
use mcap::{McapError, McapResult};
use ruzstd::decoding::errors::{FrameDecoderError, ReadFrameHeaderError};
use ruzstd::decoding::{BlockDecodingStrategy, FrameDecoder};
use std::io::Read as _;

/// Longest head of a frame, and head of a skippable frame, in bytes (RFC 8878, 3.1.1 and 3.1.2).
const LONGEST_HEAD: usize = 18;
const SKIPPABLE_HEAD: usize = 8;
/// The bit of a frame's descriptor, its fifth byte, that announces a checksum at the end.
const HAS_CHECKSUM: u8 = 4;

/// Decodes one block at a time, so that a chunk that expands enormously takes no more memory than its window.
pub(super) struct Zstd {
    decoder: FrameDecoder,
    /// True between the head of a frame and its last byte.
    is_within: bool,
    has_checksum: bool,
    /// Number of bytes that are still to be skipped.
    skipped: usize,
    /// Number of bytes needed for the next piece.
    need: usize,
}

impl Zstd {
    pub(super) fn new() -> Self {
        Self { decoder: FrameDecoder::new(), is_within: false, has_checksum: false, skipped: 0, need: 0 }
    }

    /// Reads the head of a frame. Returns the number of bytes consumed, 0 if there are not enough.
    fn begin(&mut self, src: &[u8]) -> McapResult<usize> {
        let mut rest = src;
        match self.decoder.reset(&mut rest) {
            Ok(()) => {
                self.is_within = true;
                self.has_checksum = src.get(4).is_some_and(|descriptor| descriptor & HAS_CHECKSUM != 0);
                Ok(src.len() - rest.len())
            }
            Err(FrameDecoderError::ReadFrameHeaderError(ReadFrameHeaderError::SkipFrame {
                length, ..
            })) => {
                self.skipped = length as usize;
                Ok(SKIPPABLE_HEAD)
            }
            Err(_) if src.len() < LONGEST_HEAD => {
                self.need = LONGEST_HEAD;
                Ok(0)
            }
            Err(error) => Err(wrong(&error)),
        }
    }

    /// Decodes the next block. Returns the number of bytes consumed, 0 if the block is incomplete.
    fn take_block(&mut self, src: &[u8]) -> McapResult<usize> {
        let Some(&[low, middle, high]) = src.first_chunk::<3>() else {
            self.need = 3;
            return Ok(0);
        };
        let head = u32::from_le_bytes([low, middle, high, 0]);
        let (is_last, is_repeated) = (head & 1 == 1, (head >> 1) & 3 == 1);
        let content = if is_repeated { 1 } else { (head >> 3) as usize };
        let len = 3 + content + if is_last && self.has_checksum { 4 } else { 0 };
        let Some(mut block) = src.get(..len) else {
            self.need = len;
            return Ok(0);
        };
        self.decoder
            .decode_blocks(&mut block, BlockDecodingStrategy::UptoBlocks(1))
            .map_err(|error| wrong(&error))?;
        Ok(len)
    }
}

impl Decompressor for Zstd {
    fn next_read_size(&self) -> usize {
        self.need
    }

    fn decompress(&mut self, src: &[u8], dst: &mut [u8]) -> McapResult<DecompressResult> {
        self.need = 0;
        if self.skipped > 0 {
            let consumed = self.skipped.min(src.len());
            self.skipped -= consumed;
            return Ok(DecompressResult { consumed, wrote: 0 });
        }
        if !self.is_within {
            return Ok(DecompressResult { consumed: self.begin(src)?, wrote: 0 });
        }
        let consumed = if self.decoder.can_collect() == 0 { self.take_block(src)? } else { 0 };
        let wrote = self.decoder.read(dst).map_err(|error| wrong(&error))?;
        self.is_within = !self.decoder.is_finished() || self.decoder.can_collect() > 0;
        Ok(DecompressResult { consumed, wrote })
    }

    fn reset(&mut self) -> McapResult<()> {
        // The next frame uses the allocated memory again.
        (self.is_within, self.skipped, self.need) = (false, 0, 0);
        Ok(())
    }

    fn name(&self) -> &'static str {
        "zstd"
    }
}

fn wrong(error: &dyn std::fmt::Display) -> McapError {
    McapError::DecompressionError(error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use ruzstd::encoding::{CompressionLevel, compress_to_vec};

    /// Decompresses in pieces of at most `piece` bytes, and writes at most `room` bytes at a time, as the reader asks
    /// for them.
    fn decode(src: &[u8], piece: usize, room: usize, len: usize) -> McapResult<Vec<u8>> {
        let mut decoder = Zstd::new();
        let (mut out, mut at, mut have) = (Vec::new(), 0, 0);
        while out.len() < len {
            have = have.max(decoder.next_read_size()).max(piece.min(src.len() - at)).min(src.len() - at);
            let mut dst = vec![0; room.min(len - out.len())];
            let done = decoder.decompress(&src[at..at + have], &mut dst)?;
            if done.consumed == 0 && done.wrote == 0 {
                if have == src.len() - at {
                    return Err(McapError::UnexpectedEoc);
                }
                have += 1;
            }
            at += done.consumed;
            have -= done.consumed;
            out.extend_from_slice(&dst[..done.wrote]);
        }
        Ok(out)
    }

    #[test]
    fn frames_are_decoded_in_pieces_of_any_size() {
        let mut seed = 17_u32;
        let mut next = move || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            seed >> 16
        };
        let first: Vec<u8> = (0..300_000).map(|_| (next() % 5) as u8).collect();
        let second = vec![7_u8; 200_000];
        // Two frames with a skippable one between them.
        let mut src = compress_to_vec(&first[..], CompressionLevel::Fastest);
        src.extend_from_slice(&[0x50, 0x2a, 0x4d, 0x18, 5, 0, 0, 0, 1, 2, 3, 4, 5]);
        src.extend(compress_to_vec(&second[..], CompressionLevel::Uncompressed));
        let whole = [first, second].concat();
        for _ in 0..30 {
            let (piece, room) = (1 + next() as usize % 5000, 1 + next() as usize % 70_000);
            let decoded = decode(&src, piece, room, whole.len()).unwrap();
            assert!(decoded == whole, "pieces of {piece} into {room}");
        }
        // Truncated or damaged data give an error instead of a panic.
        for _ in 0..60 {
            let mut wrong = src.clone();
            let place = next() as usize % 2000;
            wrong[place] ^= 1 + (next() % 255) as u8;
            let _ = decode(&wrong, 4096, 65_536, whole.len());
            assert!(decode(&src[..src.len() - 1 - place], 4096, 65_536, whole.len()).is_err());
        }
    }
}
