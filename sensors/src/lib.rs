//! Robot sensors by exact ray casting.
#![cfg_attr(not(feature = "std"), no_std)]
#![forbid(unsafe_code)]
#![warn(missing_docs)]

#[cfg(feature = "alloc")]
extern crate alloc;

pub mod noise;
pub mod pose;

pub use pose::Pose;
