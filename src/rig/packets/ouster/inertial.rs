//! Packets of an Ouster's inertial unit, little-endian, in the layouts of `udp_profile_imu`: `LEGACY`, a sample of 48 bytes;
//! `ACCEL32_GYRO32_NMEA`, eight samples in 452 bytes (as ouster-sdk 1.0.1 reads them).

use super::{IMU_PORT, INITIALIZATION, SERIAL, checksum};
use crate::description::model::ImuProfile;
use crate::rig::packets::{PacketSink, PacketTarget};
use belvedere_sensors::imu::InertialReading;
use std::io;

/// Standard gravity, of which the first firmware's accelerations are multiples.
const G: f64 = 9.806_65;

/// Samples of a packet of the newer layout, and packets of a lidar's frame: 640 samples a second at 10 Hz.
pub(super) const SAMPLES: usize = 8;
pub(super) const PACKETS_IN_FRAME: usize = 8;
/// Bytes before its samples (header, time and sentence of NMEA), of a sample, and after them.
const BEFORE: usize = 132;
const SAMPLE: usize = 36;
const AFTER: usize = 32;
/// What kind of packet it is.
const KIND: u16 = 2;

/// A unit's packets, and everybody who gets them.
pub(in crate::rig) struct ImuPackets {
    profile: ImuProfile,
    packet: Vec<u8>,
    /// Samples so far.
    count: usize,
    sinks: Vec<PacketSink>,
}

impl ImuPackets {
    pub(in crate::rig) fn new(profile: ImuProfile) -> Self {
        Self { profile, packet: Vec::new(), count: 0, sinks: Vec::new() }
    }

    /// Sends them to somebody more.
    pub(in crate::rig) fn open(&mut self, target: &PacketTarget) -> io::Result<()> {
        if let PacketTarget::Metadata(_) = target {
            return Err(io::Error::other(
                "metadata are those of its lidar, which has <udp_profile_imu>, too",
            ));
        }
        self.sinks.extend(PacketSink::open(target)?);
        Ok(())
    }

    /// Forgets what waits.
    pub(in crate::rig) fn restart(&mut self) {
        self.count = 0;
    }

    /// Puts a sample into the packet, and sends that if it is full.
    pub(in crate::rig) fn push(&mut self, stamp_ns: u64, read: &InertialReading) {
        if self.sinks.is_empty() {
            return;
        }
        let is_full = match self.profile {
            ImuProfile::Legacy => self.write_legacy(stamp_ns, read),
            ImuProfile::Accel32Gyro32Nmea => self.write_sample(stamp_ns, read),
        };
        if is_full {
            let Self { packet, sinks, .. } = self;
            for sink in sinks {
                sink.send(packet, IMU_PORT, stamp_ns);
            }
        }
    }

    fn write_legacy(&mut self, stamp_ns: u64, read: &InertialReading) -> bool {
        self.packet.clear();
        // Of the packet, the accelerometer and the gyro.
        for _ in 0..3 {
            self.packet.extend(stamp_ns.to_le_bytes());
        }
        let turn = read.angular_velocity.to_array().map(f64::to_degrees);
        for value in read.specific_force.to_array().map(|force| force / G).into_iter().chain(turn) {
            self.packet.extend((value as f32).to_le_bytes());
        }
        true
    }

    fn write_sample(&mut self, stamp_ns: u64, read: &InertialReading) -> bool {
        let in_frame = self.count % (SAMPLES * PACKETS_IN_FRAME);
        let frame = self.count / (SAMPLES * PACKETS_IN_FRAME);
        if self.count.is_multiple_of(SAMPLES) {
            self.packet.clear();
            self.packet.extend(KIND.to_le_bytes());
            self.packet.extend((frame as u16).to_le_bytes());
            self.packet.extend(&INITIALIZATION.to_le_bytes()[..3]);
            self.packet.extend(&SERIAL.to_le_bytes()[..5]);
            self.packet.resize(BEFORE, 0);
        }
        self.count += 1;
        let start = self.packet.len();
        self.packet.extend(stamp_ns.to_le_bytes());
        self.packet.extend((in_frame as u16).to_le_bytes());
        // Valid.
        self.packet.extend(1_u16.to_le_bytes());
        for value in read.specific_force.to_array().into_iter().chain(read.angular_velocity.to_array()) {
            self.packet.extend((value as f32).to_le_bytes());
        }
        debug_assert_eq!(self.packet.len() - start, SAMPLE);
        if !self.count.is_multiple_of(SAMPLES) {
            return false;
        }
        self.packet.resize(BEFORE + SAMPLES * SAMPLE + AFTER - size_of::<u64>(), 0);
        let sum = checksum(&self.packet);
        self.packet.extend(sum.to_le_bytes());
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use std::net::UdpSocket;
    use std::time::Duration;

    /// Bytes at the places that ouster-sdk reads them from.
    #[test]
    fn readings_become_the_packets_of_an_ousters_inertial_unit() {
        let receiver = UdpSocket::bind("127.0.0.1:0").unwrap();
        receiver.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
        let reading = |number: u64| InertialReading {
            angular_velocity: DVec3::new(0.1, -0.2, 0.3) * number as f64,
            specific_force: DVec3::new(1.0, 2.0, 9.806_65) + DVec3::splat(number as f64),
        };
        let stamp = |number: u64| 1_000_000_007 + 1_562_500 * number;
        let mut packet = [0; 1000];
        for (profile, length, samples) in
            [(ImuProfile::Legacy, 48, 1), (ImuProfile::Accel32Gyro32Nmea, 452, 8)]
        {
            let mut packets = ImuPackets::new(profile);
            // What nobody gets is not counted, nor what a reset cuts off.
            packets.push(0, &reading(0));
            packets.open(&PacketTarget::Udp(receiver.local_addr().unwrap())).unwrap();
            packets.push(0, &reading(0));
            if profile == ImuProfile::Legacy {
                receiver.recv(&mut packet).unwrap();
            }
            packets.restart();
            assert!(packets.open(&PacketTarget::Metadata("m.json".into())).is_err());
            for number in 0..72 {
                packets.push(stamp(number), &reading(number));
                if !(number + 1).is_multiple_of(samples) {
                    continue;
                }
                assert_eq!(receiver.recv(&mut packet).unwrap(), length);
                let u64_at = |at: usize| u64::from_le_bytes(packet[at..at + 8].try_into().unwrap());
                let u16_at = |at: usize| u16::from_le_bytes([packet[at], packet[at + 1]]);
                let vector = |at: usize| {
                    let float = |at: usize| f32::from_le_bytes(packet[at..at + 4].try_into().unwrap());
                    DVec3::new(float(at).into(), float(at + 4).into(), float(at + 8).into())
                };
                let near = |found: DVec3, expected: DVec3| {
                    assert!(
                        (found - expected).length() < 1e-6 * (1.0 + expected.length()),
                        "{found} {expected}"
                    );
                };
                if length == 48 {
                    assert_eq!([0, 8, 16].map(u64_at), [stamp(number); 3]);
                    near(vector(24) * 9.806_65, reading(number).specific_force);
                    near(vector(36) * (std::f64::consts::PI / 180.0), reading(number).angular_velocity);
                    continue;
                }
                assert_eq!((u16_at(0), u16_at(2), packet[4], packet[7]), (2, (number / 64) as u16, 1, 1));
                assert!(packet[12..132].iter().chain(&packet[420..444]).all(|byte| *byte == 0));
                for (place, number) in (number - 7..=number).enumerate() {
                    let at = 132 + 36 * place;
                    assert_eq!(
                        (u64_at(at), u64::from(u16_at(at + 8)), u16_at(at + 10)),
                        (stamp(number), number % 64, 1)
                    );
                    near(vector(at + 12), reading(number).specific_force);
                    near(vector(at + 24), reading(number).angular_velocity);
                }
            }
        }
    }
}
