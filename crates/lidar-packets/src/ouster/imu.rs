//! [`ImuEncoder`]: packets of the inertial unit in an Ouster.

use super::checksum;
use super::device::Identity;
use super::profile::ImuProfile;

/// Standard gravity in m/s², the unit of accelerations in the `LEGACY` layout.
const G: f64 = 9.806_65;

/// The number of samples in a packet of the newer layout. It is also the number of these packets in a frame of the lidar:
/// 640 samples per second at 10 Hz.
pub(super) const SAMPLES: usize = 8;
pub(super) const PACKETS_IN_FRAME: usize = 8;
/// The bytes before its samples (header, time and sentence of NMEA), of a sample, and after the samples.
const BEFORE: usize = 132;
const SAMPLE: usize = 36;
const AFTER: usize = 32;
/// The type of packet in the header.
const KIND: u16 = 2;

/// Encodes samples of the inertial unit in packets.
#[derive(Debug, Clone)]
pub struct ImuEncoder {
    profile: ImuProfile,
    identity: Identity,
    packet: Vec<u8>,
    /// The number of samples so far.
    count: usize,
}

impl ImuEncoder {
    /// Creates an encoder with an empty packet. The lidar's [`Device`](super::Device) must have the same profile and
    /// identity, because decoders take them from its metadata.
    #[must_use]
    pub fn new(profile: ImuProfile, identity: Identity) -> Self {
        Self { profile, identity, packet: Vec::new(), count: 0 }
    }

    /// Adds a sample to the packet, and returns the packet if it is full now.
    ///
    /// The time is in nanoseconds, on the clock of the lidar's packets. The specific force, which accelerometers measure,
    /// is in m/s²: at rest +9.81 upwards. The angular velocity is in rad/s. Both are in the axes of the unit.
    pub fn push(
        &mut self,
        time_ns: u64,
        specific_force_m_s2: [f64; 3],
        angular_velocity_rad_s: [f64; 3],
    ) -> Option<&[u8]> {
        let is_full = match self.profile {
            ImuProfile::Legacy => {
                let force = specific_force_m_s2.map(|force| force / G);
                self.write_legacy(time_ns, force, angular_velocity_rad_s.map(f64::to_degrees));
                true
            }
            ImuProfile::Accel32Gyro32Nmea => {
                self.write_sample(time_ns, specific_force_m_s2, angular_velocity_rad_s)
            }
        };
        is_full.then_some(&self.packet)
    }

    /// Discards the samples of an incomplete packet, and restarts with frame 0.
    pub fn restart(&mut self) {
        self.count = 0;
    }

    fn write_legacy(&mut self, time_ns: u64, force: [f64; 3], turn: [f64; 3]) {
        self.packet.clear();
        // The times of the packet, of the accelerometer and of the gyroscope.
        for _ in 0..3 {
            self.packet.extend(time_ns.to_le_bytes());
        }
        for value in force.into_iter().chain(turn) {
            self.packet.extend((value as f32).to_le_bytes());
        }
    }

    fn write_sample(&mut self, time_ns: u64, force: [f64; 3], turn: [f64; 3]) -> bool {
        let in_frame = self.count % (SAMPLES * PACKETS_IN_FRAME);
        let frame = self.count / (SAMPLES * PACKETS_IN_FRAME);
        if self.count.is_multiple_of(SAMPLES) {
            self.packet.clear();
            self.packet.extend(KIND.to_le_bytes());
            self.packet.extend((frame as u16).to_le_bytes());
            self.packet.extend(self.identity.bytes());
            self.packet.resize(BEFORE, 0);
        }
        self.count += 1;
        let start = self.packet.len();
        self.packet.extend(time_ns.to_le_bytes());
        self.packet.extend((in_frame as u16).to_le_bytes());
        // The status of the sample: valid.
        self.packet.extend(1_u16.to_le_bytes());
        for value in force.into_iter().chain(turn) {
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
