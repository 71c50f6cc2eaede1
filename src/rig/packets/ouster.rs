//! Ouster's lidar packets: 16 columns each, little-endian, in the layouts of `udp_profile_lidar` (OS1 User Guide v1.14;
//! sensor documentation, "Lidar Data").

mod inertial;
mod metadata;

use super::{Column, Protocol, nearest};
use crate::description::model::{self, ImuProfile, PacketProfile};
use crate::rig::ouster::OusterHead;
use crc::{CRC_64_XZ, Crc, Table};
pub(in crate::rig) use inertial::ImuPackets;

/// Columns of a packet.
const COLUMNS: usize = 16;
/// The ports of lidar and IMU.
const LIDAR_PORT: u16 = 7502;
const IMU_PORT: u16 = 7503;
/// Ticks of the encoder a turn.
const TICKS: u32 = 90_112;
/// Of a packet but its last eight bytes, which are it.
static CRC: Crc<u64, Table<16>> = Crc::<u64, Table<16>>::new(&CRC_64_XZ);
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
    /// Of the column that is put in: each return of each laser, in steps of the layout, and its signal; 0 for none.
    ranges: Vec<u32>,
    signals: Vec<u32>,
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
        ranges: Vec::new(),
        signals: Vec::new(),
    }))
}

/// Puts words into the bytes of channels, little-endian.
fn put<const WORDS: usize>(place: &mut [u8], channels: impl Iterator<Item = [u32; WORDS]>) {
    for (place, words) in place.chunks_exact_mut(4 * WORDS).zip(channels) {
        place.copy_from_slice(bytemuck::cast_slice(&words.map(u32::to_le)));
    }
}

impl Ouster {
    fn is_legacy(&self) -> bool {
        self.profile == PacketProfile::Legacy
    }

    /// Puts ranges, reflectivities, signals and near infrared of a column's beams into their channels.
    fn write_channels(&mut self, place: usize, column: &Column<'_>) {
        let (head, profile, returns) = (&self.head, self.profile, column.returns);
        let (bits, step_mm) = match profile {
            PacketProfile::Legacy => (20, 1.0),
            PacketProfile::Rng19Rfl8Sig16Nir16 | PacketProfile::Rng19Rfl8Sig16Nir16Dual => (19, 1.0),
            PacketProfile::Rng15Rfl8Nir8 => (15, 8.0),
        };
        let within = |range: u32| if range < 1 << bits { range } else { 0 };
        self.ranges.clear();
        self.ranges.extend(column.ranges.iter().map(|range| within(head.told(*range, step_mm))));
        let told = |(range, intensity): (&f32, &f32)| {
            if range.is_finite() { nearest(*intensity, f32::from(u16::MAX)) } else { 0 }
        };
        self.signals.clear();
        self.signals.extend(column.ranges.iter().zip(column.intensities).map(told));

        let place = &mut self.packet[place..][..self.layout.channel * head.lasers.len()];
        let echoes = self.ranges.chunks_exact(returns).zip(self.signals.chunks_exact(returns));
        let reflectivity = |signal: u32| signal.min(255);
        match profile {
            PacketProfile::Legacy | PacketProfile::Rng19Rfl8Sig16Nir16 => put(
                place,
                echoes.map(|(ranges, signals)| [ranges[0], reflectivity(signals[0]) | signals[0] << 16, 0]),
            ),
            PacketProfile::Rng19Rfl8Sig16Nir16Dual => put(
                place,
                echoes.map(|(ranges, signals)| {
                    let echo = |number: usize| match (ranges.get(number), signals.get(number)) {
                        (Some(range), Some(signal)) => (range | reflectivity(*signal) << 24, *signal),
                        _ => (0, 0),
                    };
                    let ((first, first_signal), (second, second_signal)) = (echo(0), echo(1));
                    [first, second, first_signal | second_signal << 16, 0]
                }),
            ),
            PacketProfile::Rng15Rfl8Nir8 => {
                put(place, echoes.map(|(ranges, signals)| [ranges[0] | reflectivity(signals[0]) << 16]));
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
        let sum = CRC.checksum(&self.packet[..checked]);
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
