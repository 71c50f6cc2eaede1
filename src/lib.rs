//! Belvedere: a robot sensor simulator.
#![forbid(unsafe_code)]

pub mod description;
pub mod rig;
pub mod robot;
pub mod simulation;
pub mod world;
