//! [`Device`]: the configuration of an Ouster, from which its metadata are written.

use super::profile::{ImuProfile, LidarProfile};
use crate::whole::nearest_below;

/// The beams of a head, which turns clockwise seen from above.
#[derive(Debug, Clone, PartialEq)]
pub struct Head {
    /// The elevation of each beam above the plane in which the head turns, in degrees, from the highest beam down.
    pub altitudes_deg: Vec<f64>,
    /// The azimuth of each beam relative to the direction of the head, clockwise seen from above, in degrees.
    pub azimuths_deg: Vec<f64>,
    /// The columns of a frame, which is a turn: 512, 1024, 2048 or 4096.
    pub columns_per_frame: u32,
    /// The distance from the axis of the head to the origins of the beams, in metres.
    pub beam_origin_m: f64,
    /// The height of the origins of the beams above the origin of the sensor, in metres.
    pub height_m: f64,
}

impl Head {
    /// Converts a range from the origin of a beam to the number in a packet: the distance from the axis of the head, in
    /// steps of `step_mm`. Returns 0 if the range is not a number, or if it needs more than `bits` bits (at most 32).
    #[inline]
    #[must_use]
    pub fn steps(&self, range_m: f32, step_mm: f64, bits: u32) -> u32 {
        let limit = (1_u64 << bits.min(32)) as f64 - 0.5;
        nearest_below((f64::from(range_m) + self.beam_origin_m) * (1000.0 / step_mm), limit)
    }

    /// Returns the number of columns by which each beam is ahead of the head: Ouster's `pixel_shift_by_row`.
    pub fn pixel_shifts(&self) -> impl Iterator<Item = i32> {
        let columns = f64::from(self.columns_per_frame);
        self.azimuths_deg.iter().map(move |azimuth| (azimuth * columns / 360.0).round() as i32)
    }
}

/// A product line of Ouster.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ProductLine {
    /// OS0, with the widest field of view.
    Os0,
    /// OS1.
    Os1,
    /// OS2, with the longest range.
    Os2,
}

impl ProductLine {
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Os0 => "OS-0",
            Self::Os1 => "OS-1",
            Self::Os2 => "OS-2",
        }
    }

    /// Returns the height of its inertial unit above the origin of the sensor, in mm. It differs because the housing of
    /// an OS2 is higher.
    pub(super) const fn imu_height_mm(self) -> f64 {
        match self {
            Self::Os0 | Self::Os1 => 7.645,
            Self::Os2 => 11.645,
        }
    }
}

/// The numbers in packets and metadata by which decoders recognise the packets of a unit. Packets of the `LEGACY` layouts
/// do not contain them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Identity {
    /// The serial number; packets contain its lowest 40 bits.
    pub serial: u64,
    /// A random number that a unit chooses when it starts; packets contain its lowest 24 bits.
    pub initialization: u32,
}

impl Default for Identity {
    fn default() -> Self {
        Self { serial: 1, initialization: 1 }
    }
}

impl Identity {
    /// Returns its eight bytes in the header of a packet.
    pub(super) fn bytes(self) -> [u8; 8] {
        (self.serial << 24 | u64::from(self.initialization & 0xFF_FFFF)).to_le_bytes()
    }
}

/// A lidar with its configuration.
#[derive(Debug, Clone, PartialEq)]
pub struct Device {
    /// Its product line.
    pub product_line: ProductLine,
    /// Its head. The number of beams must be 16, 32, 64 or 128.
    pub head: Head,
    /// Turns per second: 5, 10 or 20.
    pub rate_hz: f64,
    /// The layout of its lidar packets.
    pub lidar_profile: LidarProfile,
    /// The layout of the packets of its inertial unit.
    pub imu_profile: ImuProfile,
    /// Its numbers.
    pub identity: Identity,
}

/// The reason why Ouster's packets cannot describe a device.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DeviceError {
    /// No head of Ouster has this number of beams.
    #[error("a head has {0} beams; those of Ouster have 16, 32, 64 or 128")]
    Beams(usize),
    /// The numbers of azimuths and altitudes differ.
    #[error("a head has {azimuths} azimuths for {altitudes} altitudes")]
    Azimuths {
        /// The number of azimuths.
        azimuths: usize,
        /// The number of altitudes.
        altitudes: usize,
    },
    /// No mode of Ouster has this number of columns in a frame.
    #[error("a frame has {0} columns; those of Ouster have 512, 1024, 2048 or 4096")]
    Columns(u32),
}

impl Device {
    pub(super) fn check(&self) -> Result<(), DeviceError> {
        let (altitudes, azimuths) = (self.head.altitudes_deg.len(), self.head.azimuths_deg.len());
        if ![16, 32, 64, 128].contains(&altitudes) {
            return Err(DeviceError::Beams(altitudes));
        }
        if azimuths != altitudes {
            return Err(DeviceError::Azimuths { azimuths, altitudes });
        }
        let columns = self.head.columns_per_frame;
        if ![512, 1024, 2048, 4096].contains(&columns) {
            return Err(DeviceError::Columns(columns));
        }
        Ok(())
    }
}
