//! Velodyne's data packets (VLP-16 User Manual 63-9243, chapter 9).
//!
//! 1206 bytes, little-endian; 12 blocks of 100 bytes (0xEEFF, azimuth in 0.01° clockwise, 32 × (distance in 2 or 4 mm,
//! reflectivity)), time of the first firing in µs after the hour, return mode, product. A block has two columns of 16
//! lasers, one of 32, or a quarter of one of 128, in the order in which they fire; the azimuth is that of its first. Packets go on from frame to
//! frame: what does not fill one waits for the next. Of dual returns, each block is followed by another of the same
//! firings: the first has the last returns, the second the strongest, or the second strongest where that is the last;
//! where there is but one return, both have it.

use super::{Column, Protocol, nearest};
use crate::description::model;
use belvedere_sensors::scanner::Returns;

/// Bytes of a packet.
const LEN: usize = 1206;
/// Bytes of a block, and lasers in it.
const BLOCK: usize = 100;
const LASERS: usize = 32;
/// Marks of a block of the first, second, third and fourth 32 lasers.
const BANKS: [u16; 4] = [0xEEFF, 0xDDFF, 0xCCFF, 0xBBFF];
/// Return modes.
const STRONGEST: u8 = 0x37;
const LAST: u8 = 0x38;
const DUAL: u8 = 0x39;
/// Nanoseconds of an hour, after which the time of packets begins again.
pub(super) const HOUR_NS: u64 = 3_600_000_000_000;

/// What is different of each model.
struct Model {
    name: &'static str,
    product: u8,
    /// Metres of a distance of 1.
    step_m: f32,
    /// Firings of a packet.
    firings: usize,
    /// The same if each has two returns.
    pairs: usize,
    /// From the first of a packet to the firing that the packet has the time of.
    ahead_ns: u64,
}

const MODELS: [Model; 3] = [
    Model { name: "hdl32e", product: 0x21, step_m: 0.002, firings: 384, pairs: 192, ahead_ns: 0 },
    Model { name: "vlp16", product: 0x22, step_m: 0.002, firings: 384, pairs: 192, ahead_ns: 0 },
    // A column is four blocks, of pairs eight: the rest of the packet is empty. Its time is later than the first firing's by 6.4 µs
    // as velodyne-decoder 3.1.0 has it, by 8.7 µs as ROS's driver does.
    Model { name: "vls128", product: 0xA1, step_m: 0.004, firings: 384, pairs: 128, ahead_ns: 6400 },
];

struct Velodyne {
    packet: [u8; LEN],
    model: &'static Model,
    /// Firings that are in it.
    filled: usize,
    /// Blocks of the same firings.
    returns: usize,
    begun_ns: u64,
    /// Of the column that is put in: each return of each laser, 0 for none.
    distances: Vec<u16>,
    reflectivities: Vec<u8>,
}

/// Those of a lidar; none if its packets are not known.
pub(super) fn of(lidar: &model::Lidar) -> Option<Box<dyn Protocol>> {
    let name = lidar.preset?.name;
    let model = MODELS.iter().find(|model| model.name == name)?;
    let (mode, returns) = match lidar.physics.returns {
        Returns::Strongest => (STRONGEST, 1),
        Returns::Last => (LAST, 1),
        Returns::Dual => (DUAL, 2),
        _ => return None,
    };
    let mut packet = [0; LEN];
    packet[1204..].copy_from_slice(&[mode, model.product]);
    let (distances, reflectivities) = (Vec::new(), Vec::new());
    Some(Box::new(Velodyne { packet, model, filled: 0, returns, begun_ns: 0, distances, reflectivities }))
}

impl Velodyne {
    /// Puts a column's firings into their blocks, each return into those of its own.
    fn write(&mut self, hundredths: u16, column: &Column<'_>) {
        let (returns, step_m) = (self.returns, self.model.step_m);
        self.distances.clear();
        // What is farther than can be told is no return.
        let farthest = f32::from(u16::MAX);
        let told = |steps: f32| if steps <= farthest { nearest(steps, farthest) as u16 } else { 0 };
        let distance = |range: &f32| told(range / step_m);
        self.distances.extend(column.ranges.iter().map(distance));
        self.reflectivities.clear();
        self.reflectivities.extend(column.intensities.iter().map(|told| nearest(*told, 255.0) as u8));
        let lasers = column.ranges.len() / returns;
        let mut laser = 0;
        while laser < lasers {
            let (group, place) = ((self.filled + laser) / LASERS, (self.filled + laser) % LASERS);
            let end = lasers.min(laser + LASERS - place);
            let blocks = self.packet[group * returns * BLOCK..].chunks_exact_mut(BLOCK);
            for (number, block) in blocks.take(returns).enumerate() {
                if place == 0 {
                    let bank = BANKS[group % lasers.div_ceil(LASERS)];
                    block[..2].copy_from_slice(&bank.to_le_bytes());
                    block[2..4].copy_from_slice(&hundredths.to_le_bytes());
                }
                for (place, laser) in block[4 + 3 * place..].chunks_exact_mut(3).zip(laser..end) {
                    let echo = laser * returns + number;
                    let echo = if number > 0 && self.distances[echo] == 0 { laser * returns } else { echo };
                    let distance = self.distances[echo];
                    let reflectivity = if distance == 0 { 0 } else { self.reflectivities[echo] };
                    let [low, high] = distance.to_le_bytes();
                    place.copy_from_slice(&[low, high, reflectivity]);
                }
            }
            laser = end;
        }
    }
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
            self.begun_ns = column.time_ns + self.model.ahead_ns;
        }
        let hundredths = (column.turned * 36_000.0).round().rem_euclid(36_000.0) as u16;
        self.write(hundredths, column);
        self.filled += column.ranges.len() / self.returns;
        if self.filled < if self.returns == 1 { self.model.firings } else { self.model.pairs } {
            return None;
        }
        self.filled = 0;
        let micros = (self.begun_ns + 500) / 1000 % (HOUR_NS / 1000);
        self.packet[1200..1204].copy_from_slice(&(micros as u32).to_le_bytes());
        Some(&self.packet)
    }
}
