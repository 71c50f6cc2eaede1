//! Ouster's packets, according to the OS1 User Guide v1.14, the "Lidar Data" chapter of the sensor documentation, and the
//! decoder of ouster-sdk 1.0.1.
//!
//! A lidar packet has a header, 16 columns and a footer, little-endian. A column has a header, a channel for each beam, and
//! a footer. The sizes in bytes:
//!
//! | profile | header | column's header | channel | column's footer | footer |
//! |---|---:|---:|---:|---:|---:|
//! | `LEGACY` | 0 | 16 | 12 | 4 | 0 |
//! | `RNG19_RFL8_SIG16_NIR16` | 32 | 12 | 12 | 0 | 32 |
//! | `RNG19_RFL8_SIG16_NIR16_DUAL` | 32 | 12 | 16 | 0 | 32 |
//! | `RNG15_RFL8_NIR8` | 32 | 12 | 4 | 0 | 32 |
//!
//! The footer ends with the CRC-64/XZ of all bytes before the checksum. Packets of the inertial unit have 48 bytes
//! (`LEGACY`) or 452 (`ACCEL32_GYRO32_NMEA`).

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

/// Returns the CRC-64/XZ of a packet, given without its last eight bytes, which hold the checksum.
fn checksum(text: &[u8]) -> u64 {
    let mut digest = crc64fast::Digest::new();
    digest.write(text);
    digest.sum64()
}
