//! The running state of a world.

pub mod earth;
pub mod physics;
pub mod scene;
