//! Ouster's lidar packets: 16 columns each, little-endian, in the layouts of `udp_profile_lidar` (OS1 User Guide v1.14;
//! sensor documentation, "Lidar Data").

mod inertial;
mod metadata;

use super::{Column, Protocol};
use crate::description::model::{self, ImuProfile, PacketProfile};
use crate::rig::ouster::OusterHead;
use crate::rig::whole::nearest;
pub(in crate::rig) use inertial::ImuPackets;

/// Columns of a packet.
const COLUMNS: usize = 16;
/// The ports of lidar and IMU.
const LIDAR_PORT: u16 = 7502;
const IMU_PORT: u16 = 7503;
/// Ticks of the encoder a turn.
const TICKS: u32 = 90_112;
/// Lasers that are converted at once: heads have 32, 64 or 128.
const LASERS: usize = 32;
/// Of the device, and of its start: all packets have them, but for the first firmware's.
const SERIAL: u64 = 1;
const INITIALIZATION: u32 = 1;

/// Bytes of the parts of a packet.
struct Layout {
    header: usize,
    column_header: usize,
    channel: usize,
    column_footer: usize,
    footer: usize,
}

const fn layout(profile: PacketProfile) -> Layout {
    match profile {
        PacketProfile::Legacy => {
            Layout { header: 0, column_header: 16, channel: 12, column_footer: 4, footer: 0 }
        }
        PacketProfile::Rng19Rfl8Sig16Nir16 => {
            Layout { header: 32, column_header: 12, channel: 12, column_footer: 0, footer: 32 }
        }
        PacketProfile::Rng19Rfl8Sig16Nir16Dual => {
            Layout { header: 32, column_header: 12, channel: 16, column_footer: 0, footer: 32 }
        }
        PacketProfile::Rng15Rfl8Nir8 => {
            Layout { header: 32, column_header: 12, channel: 4, column_footer: 0, footer: 32 }
        }
    }
}

struct Ouster {
    profile: PacketProfile,
    imu_profile: ImuProfile,
    layout: Layout,
    head: OusterHead,
    rate_hz: f64,
    name: &'static str,
    packet: Vec<u8>,
    /// Columns that are in it.
    filled: usize,
}

/// Those of a lidar.
pub(super) fn of(lidar: &model::Lidar) -> Option<Box<dyn Protocol>> {
    let preset = lidar.preset?;
    let head = OusterHead::of(&preset);
    let layout = layout(lidar.profile);
    let column = layout.column_header + layout.channel * head.lasers.len() + layout.column_footer;
    let packet = vec![0; layout.header + COLUMNS * column + layout.footer];
    let (name, rate_hz) = (preset.name, preset.rate_hz);
    Some(Box::new(Ouster {
        profile: lidar.profile,
        imu_profile: lidar.imu_profile,
        layout,
        head,
        rate_hz,
        name,
        packet,
        filled: 0,
    }))
}

/// CRC-64/XZ: of a packet but its last eight bytes, which are it.
fn checksum(text: &[u8]) -> u64 {
    let mut digest = crc64fast::Digest::new();
    digest.write(text);
    digest.sum64()
}

/// Ranges in steps of a layout, and signals, of a return of each laser; 0 for none.
type Told = ([u32; LASERS], [u32; LASERS]);

/// Puts words into the bytes of channels, little-endian.
#[inline]
fn put<const WORDS: usize>(place: &mut [u8], words: impl Fn(usize) -> [u32; WORDS]) {
    for (laser, place) in place.chunks_exact_mut(4 * WORDS).enumerate() {
        place.copy_from_slice(words(laser % LASERS).map(u32::to_le_bytes).as_flattened());
    }
}

impl Ouster {
    fn is_legacy(&self) -> bool {
        self.profile == PacketProfile::Legacy
    }

    /// Puts ranges, reflectivities, signals and near infrared of a column's beams into their channels.
    fn write_channels(&mut self, place: usize, column: &Column<'_>) {
        // Their number is known to the compiler where it is one of the usual ones.
        match column.returns {
            1 => self.write_returns(place, column, 1),
            2 => self.write_returns(place, column, 2),
            returns => self.write_returns(place, column, returns),
        }
    }

    #[expect(clippy::inline_always, reason = "so that the number of returns is a constant in it")]
    #[inline(always)]
    fn write_returns(&mut self, place: usize, column: &Column<'_>, returns: usize) {
        let head = &self.head;
        let length = self.layout.channel * LASERS;
        let places = self.packet[place..].chunks_exact_mut(length).take(head.lasers.len() / LASERS);
        let values = column.ranges.chunks_exact(LASERS * returns);
        let values = values.zip(column.intensities.chunks_exact(LASERS * returns));
        let reflectivity = |signal: u32| signal.min(255);
        for (place, (ranges, intensities)) in places.zip(values) {
            let told = |number: usize, step_mm: f64, bits: u32| {
                let (mut steps, mut signals) = ([0; LASERS], [0; LASERS]);
                let ranges = ranges.chunks_exact(returns).map(|returns| returns[number]);
                let intensities = intensities.chunks_exact(returns).map(|returns| returns[number]);
                let places = steps.iter_mut().zip(&mut signals);
                for ((steps, signal), (range, intensity)) in places.zip(ranges.zip(intensities)) {
                    *steps = head.told(range, step_mm, bits);
                    *signal = if range.is_finite() { nearest(intensity, f32::from(u16::MAX)) } else { 0 };
                }
                (steps, signals)
            };
            let echo = |(ranges, signals): &Told, laser: usize| (ranges[laser], signals[laser]);
            match self.profile {
                profile @ (PacketProfile::Legacy | PacketProfile::Rng19Rfl8Sig16Nir16) => {
                    let only = told(0, 1.0, if profile == PacketProfile::Legacy { 20 } else { 19 });
                    put(place, |laser| {
                        let (range, signal) = echo(&only, laser);
                        [range, reflectivity(signal) | signal << 16, 0]
                    });
                }
                PacketProfile::Rng19Rfl8Sig16Nir16Dual => {
                    let none = ([0; LASERS], [0; LASERS]);
                    let echoes = [told(0, 1.0, 19), if returns > 1 { told(1, 1.0, 19) } else { none }];
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
                PacketProfile::Rng15Rfl8Nir8 => {
                    let only = told(0, 8.0, 15);
                    put(place, |laser| {
                        let (range, signal) = echo(&only, laser);
                        [range | reflectivity(signal) << 16]
                    });
                }
            }
        }
    }

    /// Before the columns of a packet, and after them.
    fn finish(&mut self, frame: u64) {
        let length = self.packet.len();
        let (text, footer) = self.packet.split_at_mut(length - self.layout.footer);
        if footer.is_empty() {
            return;
        }
        text[..2].copy_from_slice(&1_u16.to_le_bytes());
        text[2..4].copy_from_slice(&(frame as u16).to_le_bytes());
        text[4..7].copy_from_slice(&INITIALIZATION.to_le_bytes()[..3]);
        text[7..12].copy_from_slice(&SERIAL.to_le_bytes()[..5]);
        let checked = length - size_of::<u64>();
        let sum = checksum(&self.packet[..checked]);
        self.packet[checked..].copy_from_slice(&sum.to_le_bytes());
    }
}

impl Protocol for Ouster {
    fn port(&self) -> u16 {
        LIDAR_PORT
    }

    fn push(&mut self, column: &Column<'_>) -> Option<&[u8]> {
        if column.number.is_multiple_of(COLUMNS) {
            self.filled = 0;
        }
        let Layout { header, column_header, channel, column_footer, .. } = self.layout;
        let length = column_header + channel * self.head.lasers.len() + column_footer;
        let begin = header + self.filled * length;
        let is_legacy = self.is_legacy();
        let place = &mut self.packet[begin..][..length];
        place[..8].copy_from_slice(&column.time_ns.to_le_bytes());
        place[8..10].copy_from_slice(&(column.number as u16).to_le_bytes());
        if is_legacy {
            let ticks = column.number as u32 * (TICKS / self.head.columns);
            place[10..12].copy_from_slice(&(column.frame as u16).to_le_bytes());
            place[12..16].copy_from_slice(&ticks.to_le_bytes());
            place[length - column_footer..].fill(0xFF);
        } else {
            // Valid.
            place[10..12].copy_from_slice(&1_u16.to_le_bytes());
        }
        self.write_channels(begin + column_header, column);
        self.filled += 1;
        if self.filled < COLUMNS {
            return None;
        }
        self.filled = 0;
        self.finish(column.frame);
        Some(&self.packet)
    }

    fn restart(&mut self) {
        self.filled = 0;
    }

    fn metadata(&self) -> Option<String> {
        Some(metadata::of(self))
    }
}
