//! Ouster's packets, as in the OS1 User Guide v1.14, the "Lidar Data" chapter of its sensor documentation, and as
//! ouster-sdk 1.0.1 reads them.
//!
//! A lidar packet has 16 columns, little-endian. Bytes of its parts, where a column is the column's header, a channel for
//! each beam, and the column's footer:
//!
//! | profile | header | column's header | channel | column's footer | footer |
//! |---|---:|---:|---:|---:|---:|
//! | `LEGACY` | 0 | 16 | 12 | 4 | 0 |
//! | `RNG19_RFL8_SIG16_NIR16` | 32 | 12 | 12 | 0 | 32 |
//! | `RNG19_RFL8_SIG16_NIR16_DUAL` | 32 | 12 | 16 | 0 | 32 |
//! | `RNG15_RFL8_NIR8` | 32 | 12 | 4 | 0 | 32 |
//!
//! The footer ends with the CRC-64/XZ of all before it. Packets of the inertial unit have 48 bytes (`LEGACY`) or 452
//! (`ACCEL32_GYRO32_NMEA`).

mod device;
mod imu;
mod lidar;
mod metadata;
mod profile;

pub use device::{Device, DeviceError, Head, Identity, ProductLine};
pub use imu::ImuEncoder;
pub use lidar::LidarEncoder;
pub use profile::{ImuProfile, LidarProfile};

/// The UDP port to which lidar packets are sent.
pub const LIDAR_PORT: u16 = 7502;
/// The UDP port to which packets of the inertial unit are sent.
pub const IMU_PORT: u16 = 7503;

/// The CRC-64/XZ of a packet without its last eight bytes, which are for it.
fn checksum(text: &[u8]) -> u64 {
    let mut digest = crc64fast::Digest::new();
    digest.write(text);
    digest.sum64()
}
