//! Velodyne's data packets (VLP-16 User Manual 63-9243, chapter 9).
//!
//! 1206 bytes, little-endian; 12 blocks of 100 bytes (0xEEFF, azimuth in 0.01° clockwise, 32 × (distance in 2 or 4 mm,
//! reflectivity)), time of the first firing in µs after the hour, return mode, product. A block has two columns of 16
//! lasers, one of 32, or a quarter of one of 128, in the order in which they fire; the azimuth is that of its first. Packets go on from frame to
//! frame: what does not fill one waits for the next. Of dual returns, each block is followed by another of the same
//! firings: the first has the last returns, the second the strongest, or the second strongest where that is the last;
//! where there is but one return, both have it.

use super::{Column, Protocol};
use crate::description::model;
use crate::rig::whole::nearest;
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
    Some(Box::new(Velodyne { packet, model, filled: 0, returns, begun_ns: 0 }))
}

/// A return's distance and, in the third byte, reflectivity; 0 for none, and of what is farther than can be told.
#[inline]
fn echo(range_m: f32, intensity: f32, step_m: f32) -> u32 {
    let farthest = f32::from(u16::MAX);
    let steps = range_m / step_m;
    let distance = nearest(if steps <= farthest { steps } else { 0.0 }, farthest);
    if distance == 0 { 0 } else { distance | nearest(intensity, 255.0) << 16 }
}

/// Puts the echoes of four lasers into their twelve bytes.
#[inline]
fn put(place: &mut [u8; 12], [a, b, c, d]: [u32; 4]) {
    let words = [a | b << 24, b >> 8 | c << 16, c >> 16 | d << 8].map(u32::to_le_bytes);
    place.copy_from_slice(words.as_flattened());
}

impl Velodyne {
    /// Puts a column's firings into their blocks, each return into those of its own. The lasers of a block's part are so
    /// many, and so are their returns: known to the compiler, they are all converted at once.
    fn write<const PART: usize, const RETURNS: usize>(&mut self, hundredths: u16, column: &Column<'_>) {
        let parts = column.ranges.chunks_exact(PART * RETURNS);
        let banks = parts.len();
        for (bank, ranges) in parts.enumerate() {
            let mut echoes = [0; 2 * LASERS];
            let values = ranges.iter().zip(&column.intensities[bank * PART * RETURNS..][..PART * RETURNS]);
            for (told, (range, intensity)) in echoes.iter_mut().zip(values) {
                *told = echo(*range, *intensity, self.model.step_m);
            }
            let (group, place) = (self.filled / LASERS, self.filled % LASERS);
            for number in 0..RETURNS {
                let block = &mut self.packet[(group * RETURNS + number) * BLOCK..][..BLOCK];
                if place == 0 {
                    block[..2].copy_from_slice(&BANKS[group % banks].to_le_bytes());
                    block[2..4].copy_from_slice(&hundredths.to_le_bytes());
                }
                let places = block[4 + 3 * place..][..3 * PART].as_chunks_mut().0;
                for (place, echoes) in places.iter_mut().zip(echoes.chunks_exact(4 * RETURNS)) {
                    // The only return of a firing is in both blocks.
                    let told =
                        |laser: usize| match (echoes[laser * RETURNS], echoes[laser * RETURNS + number]) {
                            (only, 0) => only,
                            (_, echo) => echo,
                        };
                    put(place, [told(0), told(1), told(2), told(3)]);
                }
            }
            self.filled += PART;
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
        let hundredths = ((column.turned * 36_000.0 + 0.5) as u32 % 36_000) as u16;
        match (column.ranges.len() / self.returns < LASERS, self.returns) {
            (true, 1) => self.write::<16, 1>(hundredths, column),
            (true, _) => self.write::<16, 2>(hundredths, column),
            (false, 1) => self.write::<LASERS, 1>(hundredths, column),
            (false, _) => self.write::<LASERS, 2>(hundredths, column),
        }
        if self.filled < if self.returns == 1 { self.model.firings } else { self.model.pairs } {
            return None;
        }
        self.filled = 0;
        let micros = (self.begun_ns + 500) / 1000 % (HOUR_NS / 1000);
        self.packet[1200..1204].copy_from_slice(&(micros as u32).to_le_bytes());
        Some(&self.packet)
    }
}
