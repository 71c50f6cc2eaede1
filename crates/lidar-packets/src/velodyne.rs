//! Velodyne's data packets, according to the VLP-16 User Manual (63-9243 Rev D, chapter 9) and the VLS-128 User Manual
//! (63-9483).
//!
//! A packet has 1206 bytes, little-endian:
//!
//! | bytes | contents |
//! |---|---|
//! | 0 to 1199 | 12 blocks of 100 bytes |
//! | 1200 to 1203 | the time of the first firing in µs after the full hour |
//! | 1204 | the return mode: 0x37 strongest, 0x38 last, 0x39 dual |
//! | 1205 | the model: 0x21 HDL-32E, 0x22 VLP-16, 0xA1 VLS-128 |
//!
//! A block has a flag of two bytes (FF EE), an azimuth in steps of 0.01°, clockwise, and 32 channels. A channel is a
//! distance in steps of 2 or 4 mm (two bytes) and a reflectivity (one byte). A block holds two columns of 16 lasers, one
//! of 32, or a quarter of one of 128, in the order in which the lasers fire. Its azimuth is that of its first column. The
//! four quarters of 128 lasers have different flags. Packets do not end with a frame: an incomplete packet is continued
//! with the columns of the next frame.
//!
//! With dual returns, each block is followed by a second one of the same firings. The first block has the last returns,
//! the second one the strongest. If the strongest return is also the last, the second block has the second strongest; if
//! there is only one return, both blocks have it.

use crate::whole::nearest;
use crate::{Column, ColumnError};

/// The UDP port to which the packets are sent.
pub const PORT: u16 = 2368;
/// The size of a packet, in bytes.
pub const PACKET_LEN: usize = 1206;
/// The size of a block in bytes, and the number of its channels.
const BLOCK: usize = 100;
const LASERS: usize = 32;
/// The flags of blocks with the first, second, third and fourth 32 lasers.
const BANKS: [u16; 4] = [0xEEFF, 0xDDFF, 0xCCFF, 0xBBFF];
/// The nanoseconds of an hour, after which the timestamps of packets restart at 0.
const HOUR_NS: u64 = 3_600_000_000_000;

/// A model of Velodyne's lidars.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Model {
    /// 16 lasers, distances in steps of 2 mm, up to 131.07 m.
    Vlp16,
    /// 32 lasers, distances in steps of 2 mm, up to 131.07 m.
    Hdl32e,
    /// 128 lasers, distances in steps of 4 mm, up to 262.14 m.
    Vls128,
}

impl Model {
    /// Returns the number of its lasers.
    pub const fn lasers(self) -> usize {
        match self {
            Self::Vlp16 => 16,
            Self::Hdl32e => 32,
            Self::Vls128 => 128,
        }
    }

    /// Returns the last byte of its packets.
    const fn product(self) -> u8 {
        match self {
            Self::Hdl32e => 0x21,
            Self::Vlp16 => 0x22,
            // The manuals say 0x63, but the devices send 0xA1, and decoders expect it.
            Self::Vls128 => 0xA1,
        }
    }

    /// Returns the unit of distances in metres.
    const fn step_m(self) -> f32 {
        match self {
            Self::Vlp16 | Self::Hdl32e => 0.002,
            Self::Vls128 => 0.004,
        }
    }

    /// Returns the number of firings in a packet.
    const fn firings(self, mode: ReturnMode) -> usize {
        match (self, mode) {
            (_, ReturnMode::Strongest | ReturnMode::Last) => 384,
            (Self::Vlp16 | Self::Hdl32e, ReturnMode::Dual) => 192,
            // A column is eight blocks; the last four blocks of a packet are empty.
            (Self::Vls128, ReturnMode::Dual) => 128,
        }
    }

    /// Returns the time from the first firing of a packet to the firing whose time is the packet's timestamp, in
    /// nanoseconds.
    const fn ahead_ns(self) -> u64 {
        match self {
            Self::Vlp16 | Self::Hdl32e => 0,
            // This is the value of velodyne-decoder 3.1.0. ROS's driver uses 8.7 µs.
            Self::Vls128 => 6400,
        }
    }
}

/// The returns of a laser that the lidar sends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ReturnMode {
    /// The strongest.
    Strongest,
    /// The last.
    Last,
    /// The last and the strongest.
    Dual,
}

impl ReturnMode {
    /// Returns the number of returns of each laser in a [`Column`].
    pub const fn returns(self) -> usize {
        match self {
            Self::Strongest | Self::Last => 1,
            Self::Dual => 2,
        }
    }

    const fn byte(self) -> u8 {
        match self {
            Self::Strongest => 0x37,
            Self::Last => 0x38,
            Self::Dual => 0x39,
        }
    }
}

/// Encodes columns in packets.
#[derive(Debug, Clone)]
pub struct Encoder {
    packet: [u8; PACKET_LEN],
    model: Model,
    mode: ReturnMode,
    /// The number of firings in the packet.
    filled: usize,
    /// The timestamp of the packet.
    begun_ns: u64,
}
/// Returns the distance and, in the third byte, the reflectivity of a return. Returns 0 for no return, and for a distance
/// that is too large for the layout.
#[inline]
fn echo(range_m: f32, intensity: f32, step_m: f32) -> u32 {
    let farthest = f32::from(u16::MAX);
    let steps = range_m / step_m;
    let distance = nearest(if steps <= farthest { steps } else { 0.0 }, farthest);
    if distance == 0 { 0 } else { distance | nearest(intensity, 255.0) << 16 }
}

/// Writes the echoes of four lasers to their twelve bytes.
#[inline]
fn put(place: &mut [u8; 12], [a, b, c, d]: [u32; 4]) {
    let words = [a | b << 24, b >> 8 | c << 16, c >> 16 | d << 8].map(u32::to_le_bytes);
    place.copy_from_slice(words.as_flattened());
}

impl Encoder {
    /// Creates an encoder with an empty packet.
    #[must_use]
    pub fn new(model: Model, mode: ReturnMode) -> Self {
        let mut packet = [0; PACKET_LEN];
        packet[1204..].copy_from_slice(&[mode.byte(), model.product()]);
        Self { packet, model, mode, filled: 0, begun_ns: 0 }
    }

    /// Adds a column to the packet, and returns the packet if it is full now.
    ///
    /// With [`ReturnMode::Dual`], the first return of a laser is the last one, and its second return is the strongest or
    /// second strongest. If there is no second return, its range is not finite.
    ///
    /// # Errors
    /// If the column does not have the number of lasers of the model, each with the number of returns of the mode. The
    /// packet is then unchanged.
    pub fn push(&mut self, column: &Column<'_>) -> Result<Option<&[u8; PACKET_LEN]>, ColumnError> {
        let returns = self.mode.returns();
        column.check(self.model.lasers(), returns)?;
        if self.filled == 0 {
            self.begun_ns = column.time_ns.wrapping_add(self.model.ahead_ns());
        }
        let hundredths = ((column.turned * 36_000.0 + 0.5) as u64 % 36_000) as u16;
        match (self.model.lasers() < LASERS, returns) {
            (true, 1) => self.write::<16, 1>(hundredths, column),
            (true, _) => self.write::<16, 2>(hundredths, column),
            (false, 1) => self.write::<LASERS, 1>(hundredths, column),
            (false, _) => self.write::<LASERS, 2>(hundredths, column),
        }
        if self.filled < self.model.firings(self.mode) {
            return Ok(None);
        }
        self.filled = 0;
        let micros = self.begun_ns.saturating_add(500) / 1000 % (HOUR_NS / 1000);
        self.packet[1200..1204].copy_from_slice(&(micros as u32).to_le_bytes());
        Ok(Some(&self.packet))
    }

    /// Discards the columns of an incomplete packet.
    pub fn restart(&mut self) {
        self.filled = 0;
    }

    /// Writes a column's firings to their blocks; each return has its own blocks. The numbers of lasers and of returns are
    /// constants for the compiler, so that it converts the values of a block together.
    fn write<const PART: usize, const RETURNS: usize>(&mut self, hundredths: u16, column: &Column<'_>) {
        let parts = column.ranges_m.chunks_exact(PART * RETURNS);
        let (banks, step_m) = (parts.len(), self.model.step_m());
        for (bank, ranges) in parts.enumerate() {
            let mut echoes = [0; 2 * LASERS];
            let values = ranges.iter().zip(&column.intensities[bank * PART * RETURNS..][..PART * RETURNS]);
            for (place, (range, intensity)) in echoes.iter_mut().zip(values) {
                *place = echo(*range, *intensity, step_m);
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
                    let of_laser =
                        |laser: usize| match (echoes[laser * RETURNS], echoes[laser * RETURNS + number]) {
                            (only, 0) => only,
                            (_, echo) => echo,
                        };
                    put(place, [of_laser(0), of_laser(1), of_laser(2), of_laser(3)]);
                }
            }
            self.filled += PART;
        }
    }
}
