//! The running state of a world.

pub mod physics;
pub mod scene;
