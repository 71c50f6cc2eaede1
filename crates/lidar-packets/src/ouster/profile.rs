//! The layouts of an Ouster's packets, with their names in its configuration.

/// A layout of lidar packets: `udp_profile_lidar` of the configuration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[non_exhaustive]
pub enum LidarProfile {
    /// The layout of the first firmware, 12 bytes a beam.
    Legacy,
    /// 12 bytes a beam: range in mm, reflectivity, signal, near infrared.
    #[default]
    Rng19Rfl8Sig16Nir16,
    /// 16 bytes a beam: the same of two returns, the strongest first.
    Rng19Rfl8Sig16Nir16Dual,
    /// 4 bytes a beam: range in steps of 8 mm, reflectivity, near infrared.
    Rng15Rfl8Nir8,
}

/// The sizes of the parts of a packet, in bytes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layout {
    pub(super) header: usize,
    pub(super) column_header: usize,
    pub(super) channel: usize,
    pub(super) column_footer: usize,
    pub(super) footer: usize,
}

impl Layout {
    /// Returns the size of a column with this number of beams.
    pub(super) const fn column(&self, beams: usize) -> usize {
        self.column_header + self.channel * beams + self.column_footer
    }
}

impl LidarProfile {
    /// All layouts.
    pub const ALL: [Self; 4] =
        [Self::Legacy, Self::Rng19Rfl8Sig16Nir16, Self::Rng19Rfl8Sig16Nir16Dual, Self::Rng15Rfl8Nir8];

    /// Returns Ouster's name, such as `RNG19_RFL8_SIG16_NIR16`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Legacy => "LEGACY",
            Self::Rng19Rfl8Sig16Nir16 => "RNG19_RFL8_SIG16_NIR16",
            Self::Rng19Rfl8Sig16Nir16Dual => "RNG19_RFL8_SIG16_NIR16_DUAL",
            Self::Rng15Rfl8Nir8 => "RNG15_RFL8_NIR8",
        }
    }

    pub(super) const fn layout(self) -> Layout {
        let (frame, channel) = match self {
            Self::Legacy => {
                return Layout { header: 0, column_header: 16, channel: 12, column_footer: 4, footer: 0 };
            }
            Self::Rng19Rfl8Sig16Nir16 => (32, 12),
            Self::Rng19Rfl8Sig16Nir16Dual => (32, 16),
            Self::Rng15Rfl8Nir8 => (32, 4),
        };
        Layout { header: frame, column_header: 12, channel, column_footer: 0, footer: frame }
    }
}

/// A layout of the packets of the inertial unit: `udp_profile_imu` of the configuration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[non_exhaustive]
pub enum ImuProfile {
    /// The layout of the first firmware: one sample of 48 bytes, in multiples of standard gravity and degrees per second.
    #[default]
    Legacy,
    /// Eight samples in 452 bytes, in m/s² and rad/s, and an NMEA sentence, which is left empty.
    Accel32Gyro32Nmea,
}

impl ImuProfile {
    /// All layouts.
    pub const ALL: [Self; 2] = [Self::Legacy, Self::Accel32Gyro32Nmea];

    /// Returns Ouster's name, such as `ACCEL32_GYRO32_NMEA`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Legacy => "LEGACY",
            Self::Accel32Gyro32Nmea => "ACCEL32_GYRO32_NMEA",
        }
    }
}
