#![doc = include_str!("../README.md")]
//!
//! # Modules
//!
//! | module | contents |
//! |---|---|
//! | [`velodyne`] | data packets of VLP-16, HDL-32E and VLS-128 |
//! | [`ouster`] | lidar packets in four layouts, packets of the inertial unit in two, and the metadata that a decoder needs |
//! | [`pcap`] | packets in a file, with the headers of Ethernet, IPv4 and UDP |
//! | [`whole`] | the rounding of all values, for programs whose values must agree with those in the packets |
#![forbid(unsafe_code)]

mod column;
pub mod ouster;
pub mod pcap;
pub mod velodyne;
pub mod whole;

pub use column::{Column, ColumnError};
