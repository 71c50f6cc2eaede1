//! Belvedere: a robot sensor simulator.
#![forbid(unsafe_code)]

pub mod description;
pub mod robot;
pub mod world;
