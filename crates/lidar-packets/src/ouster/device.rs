//! An Ouster as its metadata describe it.

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
    /// The distance from the axis of the head to where the beams begin, in metres.
    pub beam_origin_m: f64,
    /// The height at which the beams begin above the origin of the sensor, in metres.
    pub height_m: f64,
}

impl Head {
    /// Returns a range from where a beam begins as Ouster sends it: from the axis of the head, in whole steps of so many
    /// millimetres. Returns 0 for what is no range, and for one that takes more than so many bits (at most 32).
    #[inline]
    #[must_use]
    pub fn steps(&self, range_m: f32, step_mm: f64, bits: u32) -> u32 {
        let limit = (1_u64 << bits.min(32)) as f64 - 0.5;
        nearest_below((f64::from(range_m) + self.beam_origin_m) * (1000.0 / step_mm), limit)
    }

    /// Returns by how many columns each beam looks ahead of the head: Ouster's `pixel_shift_by_row`.
    pub fn pixel_shifts(&self) -> impl Iterator<Item = i32> {
        let columns = f64::from(self.columns_per_frame);
        self.azimuths_deg.iter().map(move |azimuth| (azimuth * columns / 360.0).round() as i32)
    }
}

/// A line of Ouster's products.
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

    /// Where its inertial unit is above the origin of the sensor, in mm. The housings are alike, but an OS2's is higher.
    pub(super) const fn imu_height_mm(self) -> f64 {
        match self {
            Self::Os0 | Self::Os1 => 7.645,
            Self::Os2 => 11.645,
        }
    }
}

/// What packets and metadata say of a unit, by which decoders recognise its packets. Packets of the layouts of the first
/// firmware do not have it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Identity {
    /// The serial number; packets have its lowest 40 bits.
    pub serial: u64,
    /// A number that a unit draws when it starts; packets have its lowest 24 bits.
    pub initialization: u32,
}

impl Default for Identity {
    fn default() -> Self {
        Self { serial: 1, initialization: 1 }
    }
}

impl Identity {
    /// The eight bytes of it in the header of a packet.
    pub(super) fn bytes(self) -> [u8; 8] {
        (self.serial << 24 | u64::from(self.initialization & 0xFF_FFFF)).to_le_bytes()
    }
}

/// A lidar and how it is configured.
#[derive(Debug, Clone, PartialEq)]
pub struct Device {
    /// The line of products that it belongs to.
    pub product_line: ProductLine,
    /// Its beams. There must be 16, 32, 64 or 128.
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

/// A device that Ouster's packets cannot describe.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DeviceError {
    /// The head has a number of beams that no head of Ouster has.
    #[error("a head has {0} beams; those of Ouster have 16, 32, 64 or 128")]
    Beams(usize),
    /// There is not an azimuth for each altitude.
    #[error("a head has {azimuths} azimuths for {altitudes} altitudes")]
    Azimuths {
        /// How many azimuths there are.
        azimuths: usize,
        /// How many altitudes there are.
        altitudes: usize,
    },
    /// A frame has a number of columns that no mode of Ouster has.
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
