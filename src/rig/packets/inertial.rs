//! Sends the packets of an Ouster's inertial unit.

use super::imu_profile;
use super::sink::{PacketSink, PacketTarget};
use crate::description::model::ImuProfile;
use belvedere_sensors::imu::InertialReading;
use lidar_packets::ouster::{IMU_PORT, Identity, ImuEncoder};
use std::io;

/// The packets of an inertial unit, with all their targets.
pub(in crate::rig) struct ImuPackets {
    encoder: ImuEncoder,
    sinks: Vec<PacketSink>,
}

impl ImuPackets {
    pub(in crate::rig) fn new(profile: ImuProfile) -> Self {
        let encoder = ImuEncoder::new(imu_profile(profile), Identity::default());
        Self { encoder, sinks: Vec::new() }
    }

    /// Adds a target.
    pub(in crate::rig) fn check(target: &PacketTarget) -> io::Result<()> {
        match target {
            PacketTarget::Metadata(_) => Err(io::Error::other(
                "an inertial unit has no metadata of its own; write those of its lidar, which include it",
            )),
            PacketTarget::Pcap(_) | PacketTarget::Udp(_) => Ok(()),
        }
    }

    /// Adds a target that was checked.
    pub(in crate::rig) fn open(&mut self, target: &PacketTarget) -> io::Result<()> {
        self.sinks.extend(PacketSink::open(target)?);
        Ok(())
    }

    /// Discards the samples of an incomplete packet.
    pub(in crate::rig) fn restart(&mut self) {
        self.encoder.restart();
    }

    /// Adds a sample to the packet, and sends the packet if it is full. Without targets, samples are not counted.
    pub(in crate::rig) fn push(&mut self, stamp_ns: u64, read: &InertialReading) {
        if self.sinks.is_empty() {
            return;
        }
        let (force, turn) = (read.specific_force.to_array(), read.angular_velocity.to_array());
        if let Some(packet) = self.encoder.push(stamp_ns, force, turn) {
            self.sinks.iter_mut().for_each(|sink| sink.send(packet, IMU_PORT, stamp_ns));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::net::UdpSocket;
    use std::time::Duration;

    #[test]
    fn samples_without_a_target_are_not_counted() {
        let receiver = UdpSocket::bind("127.0.0.1:0").unwrap();
        receiver.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
        let reading = InertialReading {
            angular_velocity: glam::DVec3::Z,
            specific_force: glam::DVec3::new(0.0, 0.0, 9.806_65),
        };
        let mut packets = ImuPackets::new(ImuProfile::Accel32Gyro32Nmea);
        packets.push(0, &reading);
        assert!(ImuPackets::check(&PacketTarget::Metadata("m.json".into())).is_err());
        packets.open(&PacketTarget::Udp(receiver.local_addr().unwrap())).unwrap();
        (1..=8).for_each(|number| packets.push(number, &reading));
        let mut packet = [0; 1000];
        assert_eq!(receiver.recv(&mut packet).unwrap(), 452);
        assert_eq!(packet[132], 1);
    }
}
