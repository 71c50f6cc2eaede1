//! Belvedere: a robot sensor simulator.
#![forbid(unsafe_code)]

pub mod cli;
pub mod description;
<<<<<<< HEAD
pub mod rig;
pub mod robot;
pub mod simulation;
pub mod world;
=======
pub mod picture;
>>>>>>> bridge
