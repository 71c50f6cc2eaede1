//! Columns of random values, and encoders of all layouts, for the tests and the benchmark of their speed.

use lidar_packets::ouster::{self, Device, Head, Identity, ImuProfile, LidarProfile, ProductLine};
use lidar_packets::velodyne::{self, Model, ReturnMode};
use lidar_packets::{Column, ColumnError};

/// All layouts of Velodyne's packets.
pub(crate) const VELODYNE: [(Model, ReturnMode); 6] = [
    (Model::Vlp16, ReturnMode::Strongest),
    (Model::Vlp16, ReturnMode::Dual),
    (Model::Hdl32e, ReturnMode::Last),
    (Model::Hdl32e, ReturnMode::Dual),
    (Model::Vls128, ReturnMode::Strongest),
    (Model::Vls128, ReturnMode::Dual),
];
/// All layouts of Ouster's packets, each with its number of returns.
pub(crate) const OUSTER: [(LidarProfile, usize); 4] = [
    (LidarProfile::Legacy, 1),
    (LidarProfile::Rng19Rfl8Sig16Nir16, 1),
    (LidarProfile::Rng15Rfl8Nir8, 1),
    (LidarProfile::Rng19Rfl8Sig16Nir16Dual, 2),
];

/// The distance of the origins of an OS1's beams from the axis, in metres.
pub(crate) const BEAM_ORIGIN_M: f64 = 0.015_806;

/// Returns an OS1 with this number of beams, in the mode 1024x10.
pub(crate) fn os1(beams: usize, lidar_profile: LidarProfile) -> Device {
    Device {
        product_line: ProductLine::Os1,
        head: Head {
            altitudes_deg: (0..beams).map(|row| 22.5 - 45.0 * row as f64 / beams as f64).collect(),
            azimuths_deg: (0..beams).map(|row| [4.25, 1.42, -1.42, -4.25][row % 4]).collect(),
            columns_per_frame: 1024,
            beam_origin_m: BEAM_ORIGIN_M,
            height_m: 0.036_18,
        },
        rate_hz: 10.0,
        lidar_profile,
        imu_profile: ImuProfile::Legacy,
        identity: Identity { serial: 0x01_2345_6789, initialization: 0xAB_CDEF },
    }
}

/// An encoder of either maker.
pub(crate) enum Encoder {
    Velodyne(Box<velodyne::Encoder>),
    Ouster(ouster::LidarEncoder),
}

impl Encoder {
    pub(crate) fn velodyne(model: Model, mode: ReturnMode) -> Self {
        Self::Velodyne(Box::new(velodyne::Encoder::new(model, mode)))
    }

    /// Creates the encoder of an OS1 with 128 beams.
    pub(crate) fn ouster(profile: LidarProfile) -> Self {
        Self::Ouster(ouster::LidarEncoder::new(&os1(128, profile)).unwrap())
    }

    pub(crate) fn push(&mut self, column: &Column<'_>) -> Result<Option<&[u8]>, ColumnError> {
        match self {
            Self::Velodyne(encoder) => Ok(encoder.push(column)?.map(<[u8; 1206]>::as_slice)),
            Self::Ouster(encoder) => encoder.push(column),
        }
    }
}

/// A generator of values. Most are in the range of a sensor; others are negative, huge or NaN.
struct Values(u64);

impl Values {
    fn next(&mut self) -> u64 {
        // Knuth's MMIX generator; its upper bits are the good ones.
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 33
    }

    fn value(&mut self, most: f32) -> f32 {
        let share = self.next() as f32 / (1_u64 << 31) as f32;
        match self.next() % 24 {
            0 => f32::INFINITY,
            1 => f32::NAN,
            2 => f32::NEG_INFINITY,
            3 => 1e30,
            4 => -share * most,
            5 => 3.0 * share * most,
            _ => share * most,
        }
    }

    fn values(&mut self, count: usize, most: f32) -> Vec<f32> {
        (0..count).map(|_| self.value(most)).collect()
    }
}

/// Consecutive columns with random values.
pub(crate) struct Columns {
    columns: Vec<[Vec<f32>; 2]>,
    returns: usize,
}

impl Columns {
    pub(crate) fn any(count: usize, lasers: usize, returns: usize) -> Self {
        let mut values = Values(count as u64);
        let n = lasers * returns;
        let columns = (0..count).map(|_| [values.values(n, 200.0), values.values(n, 260.0)]).collect();
        Self { columns, returns }
    }

    pub(crate) fn len(&self) -> usize {
        self.columns.len()
    }

    pub(crate) fn column(&self, number: usize) -> Column<'_> {
        let [ranges_m, intensities] = &self.columns[number % self.columns.len()];
        let turned = number as f64 / 1024.0;
        Column { frame: 3, number, time_ns: 55_296 * number as u64, turned, ranges_m, intensities }
    }

    /// Returns range and intensity of a return.
    pub(crate) fn echo(&self, column: usize, laser: usize, number: usize) -> (f32, f32) {
        let [ranges, intensities] = &self.columns[column];
        let echo = laser * self.returns + number;
        (ranges[echo], intensities[echo])
    }
}
