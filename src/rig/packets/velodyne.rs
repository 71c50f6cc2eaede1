//! Velodyne's data packets (VLP-16 User Manual 63-9243, chapter 9).
//!
//! 1206 bytes, little-endian; 12 blocks of 100 bytes (0xEEFF, azimuth in 0.01° clockwise, 32 × (distance in 2 mm,
//! reflectivity)), time of the first firing in µs after the hour, return mode, product. A block has two columns of 16
//! lasers, or one of 32, in the order in which they fire; the azimuth is that of its first. Packets go on from frame to
//! frame: what does not fill one waits for the next. Of dual returns, each block is followed by another of the same
//! firings: the first has the last returns, the second the strongest, or the second strongest where that is the last;
//! where there is but one return, both have it.

use super::{Column, Protocol};
use crate::description::model;
use belvedere_sensors::scanner::Returns;

/// Bytes of a packet.
const LEN: usize = 1206;
/// Blocks of a packet, bytes of one, and lasers in it.
const BLOCKS: usize = 12;
const BLOCK: usize = 100;
const LASERS: usize = 32;
/// Metres of a distance of 1.
const STEP_M: f32 = 0.002;
/// Return modes.
const STRONGEST: u8 = 0x37;
const LAST: u8 = 0x38;
const DUAL: u8 = 0x39;
/// Nanoseconds of an hour, after which the time of packets begins again.
pub(super) const HOUR_NS: u64 = 3_600_000_000_000;

struct Velodyne {
    packet: [u8; LEN],
    /// Firings that are in it.
    filled: usize,
    /// Blocks of the same firings.
    returns: usize,
    begun_ns: u64,
}

/// Those of a lidar; none if its packets are not known.
pub(super) fn of(lidar: &model::Lidar) -> Option<Box<dyn Protocol>> {
    let product = match lidar.preset?.name {
        "hdl32e" => 0x21,
        "vlp16" => 0x22,
        _ => return None,
    };
    let (mode, returns) = match lidar.physics.returns {
        Returns::Strongest => (STRONGEST, 1),
        Returns::Last => (LAST, 1),
        Returns::Dual => (DUAL, 2),
        _ => return None,
    };
    let mut packet = [0; LEN];
    packet[1204..].copy_from_slice(&[mode, product]);
    Some(Box::new(Velodyne { packet, filled: 0, returns, begun_ns: 0 }))
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
        let first = self.filled % LASERS;
        let hundredths = (column.turned * 36_000.0).round().rem_euclid(36_000.0) as u16;
        let blocks = &mut self.packet[self.filled / LASERS * self.returns * BLOCK..];
        for (number, block) in blocks.chunks_exact_mut(BLOCK).take(self.returns).enumerate() {
            if first == 0 {
                block[..2].copy_from_slice(&[0xFF, 0xEE]);
                block[2..4].copy_from_slice(&hundredths.to_le_bytes());
            }
            let places = block[4 + 3 * first..].chunks_exact_mut(3);
            for (place, (ranges, intensities)) in places.zip(column.lasers()) {
                let number = if ranges[number].is_finite() { number } else { 0 };
                let range = ranges[number];
                let distance = if range.is_finite() { (range / STEP_M).round() as u16 } else { 0 };
                place[..2].copy_from_slice(&distance.to_le_bytes());
                place[2] = if distance == 0 { 0 } else { intensities[number].round() as u8 };
            }
        }
        self.filled += column.ranges.len() / self.returns;
        if self.filled * self.returns < BLOCKS * LASERS {
            return None;
        }
        self.filled = 0;
        let micros = (self.begun_ns + 500) / 1000 % (HOUR_NS / 1000);
        self.packet[1200..1204].copy_from_slice(&(micros as u32).to_le_bytes());
        Some(&self.packet)
    }
}
