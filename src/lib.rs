//! Belvedere: a robot sensor simulator.
//!
//! | module | is |
//! |---|---|
//! | [`description`] | robot and world files (xacro, URDF, SDF) as one typed model, every problem with file and line |
//! | [`world`] | the running world: physics, and the scene that the sensors see |
//! | [`robot`] | the Kobuki base: drive, odometry, transforms, joint states |
//! | [`rig`] | the sensors on their schedule, rendered straight into shared memory |
//! | [`control`] | how other processes control it: pause, step, reset, move, spawn, delete |
//! | [`simulation`] | all of it, advanced from frame to frame |
//! | [`picture`] | frames as pictures for people |
//! | [`cli`] | the `belvedere` command |
//!
//! The sensors themselves are the crate [`belvedere_sensors`], the shared memory is [`belvedere_bridge`].
#![forbid(unsafe_code)]

pub mod cli;
pub mod control;
pub mod description;
pub mod picture;
pub mod rig;
pub mod robot;
pub mod simulation;
pub mod world;
