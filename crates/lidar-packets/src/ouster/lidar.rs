//! [`LidarEncoder`]: lidar packets of an Ouster, in all layouts.

use super::checksum;
use super::device::{Device, DeviceError, Head, Identity};
use super::profile::{Layout, LidarProfile};
use crate::whole::nearest;
use crate::{Column, ColumnError};

/// The number of columns of a packet.
pub(super) const COLUMNS: usize = 16;
/// The number of encoder ticks in a turn.
const TICKS: u32 = 90_112;
/// The number of beams that are converted together. Heads have 16, 32, 64 or 128.
const LASERS: usize = 16;
/// The type of packet in the header.
const KIND: u16 = 1;

/// Encodes columns in packets.
#[derive(Debug, Clone)]
pub struct LidarEncoder {
    profile: LidarProfile,
    layout: Layout,
    head: Head,
    identity: Identity,
    packet: Vec<u8>,
    /// Frame and number of the next column of the packet.
    next: Option<(u64, usize)>,
}

/// The ranges, in steps of a layout, and the signals of one return of each laser; 0 for no return.
type Echoes = ([u32; LASERS], [u32; LASERS]);

/// Writes words to channels, little-endian.
#[inline]
fn put<const WORDS: usize>(place: &mut [u8], words: impl Fn(usize) -> [u32; WORDS]) {
    for (laser, place) in place.chunks_exact_mut(4 * WORDS).enumerate() {
        place.copy_from_slice(words(laser % LASERS).map(u32::to_le_bytes).as_flattened());
    }
}

impl LidarEncoder {
    /// Creates an encoder with an empty packet.
    ///
    /// # Errors
    /// If no head of Ouster has this number of beams or columns.
    pub fn new(device: &Device) -> Result<Self, DeviceError> {
        device.check()?;
        let (profile, layout) = (device.lidar_profile, device.lidar_profile.layout());
        let column = layout.column(device.head.altitudes_deg.len());
        let packet = vec![0; layout.header + COLUMNS * column + layout.footer];
        Ok(Self { profile, layout, head: device.head.clone(), identity: device.identity, packet, next: None })
    }

    /// Adds a column to the packet, and returns the packet if it is full now.
    ///
    /// A packet has 16 consecutive columns; the number of the first is a multiple of 16. If one of them is missing, the
    /// packet is not returned.
    ///
    /// Each laser may have any number of returns, the strongest first. Layouts with one return use the first of them, those
    /// with two the first two. The intensity is written both as signal and as reflectivity. Near infrared is 0.
    ///
    /// # Errors
    /// If the number of ranges is not a multiple of the number of lasers, or if a frame has no column with this number. The
    /// packet is then unchanged.
    pub fn push(&mut self, column: &Column<'_>) -> Result<Option<&[u8]>, ColumnError> {
        let beams = self.head.altitudes_deg.len();
        let returns = (column.ranges_m.len() / beams).max(1);
        column.check(beams, returns)?;
        let columns = self.head.columns_per_frame;
        if column.number >= columns as usize {
            return Err(ColumnError::Number { number: column.number, columns });
        }
        let place = column.number % COLUMNS;
        if place > 0 && self.next != Some((column.frame, column.number)) {
            return Ok(None);
        }
        self.next = Some((column.frame, column.number + 1));
        let Layout { header, column_header, column_footer, .. } = self.layout;
        let length = self.layout.column(beams);
        let begin = header + place * length;
        let bytes = &mut self.packet[begin..][..length];
        bytes[..8].copy_from_slice(&column.time_ns.to_le_bytes());
        bytes[8..10].copy_from_slice(&(column.number as u16).to_le_bytes());
        if self.profile == LidarProfile::Legacy {
            let ticks = column.number as u32 * (TICKS / columns);
            bytes[10..12].copy_from_slice(&(column.frame as u16).to_le_bytes());
            bytes[12..16].copy_from_slice(&ticks.to_le_bytes());
            bytes[length - column_footer..].fill(0xFF);
        } else {
            // The status of the column: valid.
            bytes[10..12].copy_from_slice(&1_u16.to_le_bytes());
        }
        // For the usual numbers of returns, the number is a constant for the compiler.
        match returns {
            1 => self.write_returns(begin + column_header, column, 1),
            2 => self.write_returns(begin + column_header, column, 2),
            returns => self.write_returns(begin + column_header, column, returns),
        }
        if place + 1 < COLUMNS {
            return Ok(None);
        }
        self.finish(column.frame);
        Ok(Some(&self.packet))
    }

    /// Discards the columns of an incomplete packet.
    pub fn restart(&mut self) {
        self.next = None;
    }

    /// Writes ranges, reflectivities and signals of a column's beams to their channels.
    #[expect(clippy::inline_always, reason = "so that the number of returns is a constant in it")]
    #[inline(always)]
    fn write_returns(&mut self, place: usize, column: &Column<'_>, returns: usize) {
        let head = &self.head;
        let length = self.layout.channel * LASERS;
        let places = self.packet[place..].chunks_exact_mut(length).take(head.altitudes_deg.len() / LASERS);
        let values = column.ranges_m.chunks_exact(LASERS * returns);
        let values = values.zip(column.intensities.chunks_exact(LASERS * returns));
        let reflectivity = |signal: u32| signal.min(255);
        for (place, (ranges, intensities)) in places.zip(values) {
            let converted = |number: usize, step_mm: f64, bits: u32| {
                let (mut steps, mut signals) = ([0; LASERS], [0; LASERS]);
                let ranges = ranges.chunks_exact(returns).map(|returns| returns[number]);
                let intensities = intensities.chunks_exact(returns).map(|returns| returns[number]);
                let places = steps.iter_mut().zip(&mut signals);
                for ((steps, signal), (range, intensity)) in places.zip(ranges.zip(intensities)) {
                    *steps = head.steps(range, step_mm, bits);
                    *signal = if range.is_finite() { nearest(intensity, f32::from(u16::MAX)) } else { 0 };
                }
                (steps, signals)
            };
            let echo = |(ranges, signals): &Echoes, laser: usize| (ranges[laser], signals[laser]);
            match self.profile {
                profile @ (LidarProfile::Legacy | LidarProfile::Rng19Rfl8Sig16Nir16) => {
                    let only = converted(0, 1.0, if profile == LidarProfile::Legacy { 20 } else { 19 });
                    put(place, |laser| {
                        let (range, signal) = echo(&only, laser);
                        [range, reflectivity(signal) | signal << 16, 0]
                    });
                }
                LidarProfile::Rng19Rfl8Sig16Nir16Dual => {
                    let none = ([0; LASERS], [0; LASERS]);
                    let second = if returns > 1 { converted(1, 1.0, 19) } else { none };
                    let echoes = [converted(0, 1.0, 19), second];
                    put(place, |laser| {
                        let [(first, signal), (second, second_signal)] =
                            [echo(&echoes[0], laser), echo(&echoes[1], laser)];
                        [
                            first | reflectivity(signal) << 24,
                            second | reflectivity(second_signal) << 24,
                            signal | second_signal << 16,
                            0,
                        ]
                    });
                }
                LidarProfile::Rng15Rfl8Nir8 => {
                    let only = converted(0, 8.0, 15);
                    put(place, |laser| {
                        let (range, signal) = echo(&only, laser);
                        [range | reflectivity(signal) << 16]
                    });
                }
            }
        }
    }

    /// Writes the header and the footer of a packet.
    fn finish(&mut self, frame: u64) {
        let length = self.packet.len();
        let (text, footer) = self.packet.split_at_mut(length - self.layout.footer);
        if footer.is_empty() {
            return;
        }
        text[..2].copy_from_slice(&KIND.to_le_bytes());
        text[2..4].copy_from_slice(&(frame as u16).to_le_bytes());
        text[4..12].copy_from_slice(&self.identity.bytes());
        let checked = length - size_of::<u64>();
        let sum = checksum(&self.packet[..checked]);
        self.packet[checked..].copy_from_slice(&sum.to_le_bytes());
    }
}
