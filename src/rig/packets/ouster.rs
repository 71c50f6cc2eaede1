//! Ouster's lidar packets: 16 columns each, little-endian, in the layouts of `udp_profile_lidar` (OS1 User Guide v1.14;
//! sensor documentation, "Lidar Data").

mod crc;
mod inertial;
mod metadata;

use super::{Column, Protocol};
use crate::description::model::{self, ImuProfile, PacketProfile};
use crate::rig::ouster::OusterHead;
use crc::crc64;
pub(in crate::rig) use inertial::ImuPackets;

/// Columns of a packet.
const COLUMNS: usize = 16;
/// The ports of lidar and IMU.
const LIDAR_PORT: u16 = 7502;
const IMU_PORT: u16 = 7503;
/// Ticks of the encoder a turn.
const TICKS: u32 = 90_112;
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

impl Ouster {
    fn is_legacy(&self) -> bool {
        self.profile == PacketProfile::Legacy
    }

    /// Range in steps, reflectivity, signal and near infrared of a beam's returns, as far as the layout has them.
    fn write_channel(profile: PacketProfile, place: &mut [u8], echoes: impl Iterator<Item = (u32, f32)>) {
        place.fill(0);
        let returns = if profile == PacketProfile::Rng19Rfl8Sig16Nir16Dual { 2 } else { 1 };
        for (number, (range, intensity)) in echoes.take(returns).enumerate() {
            let (reflectivity, signal) = (intensity.round() as u8, intensity.round() as u16);
            let within = |bits: u32| if range < 1 << bits { range } else { 0 };
            match profile {
                PacketProfile::Legacy | PacketProfile::Rng19Rfl8Sig16Nir16 => {
                    let range = within(if profile == PacketProfile::Legacy { 20 } else { 19 });
                    place[..4].copy_from_slice(&range.to_le_bytes());
                    place[4] = reflectivity;
                    place[6..8].copy_from_slice(&signal.to_le_bytes());
                }
                PacketProfile::Rng19Rfl8Sig16Nir16Dual => {
                    let (first, second) = (4 * number, 8 + 2 * number);
                    place[first..first + 3].copy_from_slice(&within(19).to_le_bytes()[..3]);
                    place[first + 3] = reflectivity;
                    place[second..second + 2].copy_from_slice(&signal.to_le_bytes());
                }
                PacketProfile::Rng15Rfl8Nir8 => {
                    place[..2].copy_from_slice(&(within(15) as u16).to_le_bytes());
                    place[2] = reflectivity;
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
        let sum = crc64(&self.packet[..checked]);
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
        let beams = self.head.lasers.len();
        let length = column_header + channel * beams + column_footer;
        let (is_legacy, profile) = (self.is_legacy(), self.profile);
        let place = &mut self.packet[header + self.filled * length..][..length];
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
        let step_mm = if profile == PacketProfile::Rng15Rfl8Nir8 { 8.0 } else { 1.0 };
        let channels = place[column_header..].chunks_exact_mut(channel);
        for (place, (ranges, intensities)) in channels.zip(column.lasers()) {
            let told = |(range, intensity): (&f32, &f32)| {
                (self.head.told(*range, step_mm), if range.is_finite() { *intensity } else { 0.0 })
            };
            Self::write_channel(profile, place, ranges.iter().zip(intensities).map(told));
        }
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
