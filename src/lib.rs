//! Belvedere: a robot sensor simulator.
//!
//! | module | is |
//! |---|---|
//! | `colours` | colour map for distances (feature `dataset`) |
//! | [`gltf`] | export of models to glTF |
//! | [`world`] | the running world: physics, and the scene that the sensors see |
//! | [`robot`] | robot bases: drives, odometry, transforms, joint states |
//! | [`entities`] | the models and robots in the world, by name |
//! | [`rig`] | sensors on their schedules, rendered directly into a sink's memory |
//! | [`simulation`] | the complete simulation, stepped and rendered by the calling program |
//! | [`randomize`] | random lights and materials for machine learning |
//! | `dataset` | generation of training data, in shards (feature `dataset`) |
//! | `server` | the simulation served to other processes: shared memory, commands (feature `server`) |
//! | `recording` | recording to MCAP files, and replay (feature `recording`) |
//! | `link` | streams to and from other machines (feature `link`) |
//! | `view` | web page that shows the simulation (feature `view`) |
//! | `picture` | frames drawn as pictures (feature `cli`) |
//! | `cli` | the `belvedere` command (feature `cli`) |
//!
//! Each module uses only those above it. The sensors themselves are in the crate [`sensors`]; the messages of streams
//! and the shared memory are in the crate [`bridge`].
#![forbid(unsafe_code)]

/// The crate `belvedere-bridge`: headers and payloads of frames, such as [`bridge::payload::Odometry`], and, with the
/// feature `server`, publishers and subscribers.
pub use belvedere_bridge as bridge;
/// The crate `belvedere-description`: robot and world files (xacro, URDF, SDF) parsed into typed models.
pub use belvedere_description as description;
/// The crate `belvedere-sensors`: cameras, depth cameras and lidars without a simulator.
pub use belvedere_sensors as sensors;

#[cfg(feature = "cli")]
pub mod cli;
#[cfg(feature = "dataset")]
mod colours;
#[cfg(feature = "dataset")]
pub mod dataset;
pub mod entities;
pub mod gltf;
#[cfg(feature = "link")]
pub mod link;
#[cfg(feature = "cli")]
pub mod picture;
pub mod randomize;
#[cfg(feature = "recording")]
pub mod recording;
pub mod rig;
pub mod robot;
#[cfg(feature = "ros2")]
pub mod ros2;
#[cfg(feature = "server")]
pub mod server;
pub mod simulation;
#[cfg(feature = "view")]
pub mod view;
pub mod world;

/// Compiles the Rust examples in the book.
#[cfg(doctest)]
mod book {
    #[doc = include_str!("../docs/library.md")]
    mod library {}
    #[doc = include_str!("../docs/sensors.md")]
    mod sensors {}
}
