//! Velodyne's data packets (VLP-16 User Manual 63-9243, chapter 9).
//!
//! 1206 bytes, little-endian; 12 blocks of 100 bytes (0xEEFF, azimuth in 0.01° clockwise, 32 × (distance in 2 mm,
//! reflectivity)), time of the first firing in µs after the hour, return mode, product. A block has two columns of 16
//! lasers, or one of 32, in the order in which they fire; the azimuth is that of its first. Packets go on from frame to
//! frame: what does not fill one waits for the next.

use super::{Column, Protocol};
use crate::description::model;

/// Bytes of a packet.
const LEN: usize = 1206;
/// Blocks of a packet, bytes of one, and lasers in it.
const BLOCKS: usize = 12;
const BLOCK: usize = 100;
const LASERS: usize = 32;
/// Metres of a distance of 1.
const STEP_M: f32 = 0.002;
/// Return mode: the strongest.
const STRONGEST: u8 = 0x37;
/// Nanoseconds of an hour, after which the time of packets begins again.
pub(super) const HOUR_NS: u64 = 3_600_000_000_000;

struct Velodyne {
    packet: [u8; LEN],
    /// Lasers that are in it.
    filled: usize,
    begun_ns: u64,
}

/// Those of a lidar; none if its packets are not known.
pub(super) fn of(lidar: &model::Lidar) -> Option<Box<dyn Protocol>> {
    let product = match lidar.preset?.name {
        "hdl32e" => 0x21,
        "vlp16" => 0x22,
        _ => return None,
    };
    let mut packet = [0; LEN];
    packet[1204..].copy_from_slice(&[STRONGEST, product]);
    Some(Box::new(Velodyne { packet, filled: 0, begun_ns: 0 }))
}

impl Protocol for Velodyne {
    fn port(&self) -> u16 {
        2368
    }

    fn restart(&mut self) {
        self.filled = 0;
    }

    fn push(&mut self, column: &Column<'_>) -> Option<&[u8]> {
        if self.filled == 0 {
            self.begun_ns = column.time_ns;
        }
        let block = &mut self.packet[self.filled / LASERS * BLOCK..][..BLOCK];
        let first = self.filled % LASERS;
        if first == 0 {
            let hundredths = (column.turned * 36_000.0).round().rem_euclid(36_000.0) as u16;
            block[..2].copy_from_slice(&[0xFF, 0xEE]);
            block[2..4].copy_from_slice(&hundredths.to_le_bytes());
        }
        let places = block[4 + 3 * first..].chunks_exact_mut(3);
        for ((place, range), intensity) in places.zip(column.ranges).zip(column.intensities) {
            let distance = if range.is_finite() { (range / STEP_M).round() as u16 } else { 0 };
            place[..2].copy_from_slice(&distance.to_le_bytes());
            place[2] = if distance == 0 { 0 } else { intensity.round() as u8 };
        }
        self.filled += column.ranges.len();
        if self.filled < BLOCKS * LASERS {
            return None;
        }
        self.filled = 0;
        let micros = (self.begun_ns + 500) / 1000 % (HOUR_NS / 1000);
        self.packet[1200..1204].copy_from_slice(&(micros as u32).to_le_bytes());
        Some(&self.packet)
    }
}
