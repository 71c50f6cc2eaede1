//! Belvedere: a robot sensor simulator.
#![forbid(unsafe_code)]

pub mod cli;
pub mod description;
pub mod picture;
