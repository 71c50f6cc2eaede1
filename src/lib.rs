//! Belvedere: a robot sensor simulator.
//!
//! | module | is |
//! |---|---|
//! | `colours` | the colours of distances (feature `dataset`) |
//! | [`gltf`] | models as a file that other programs show |
//! | [`world`] | the running world: physics, and the scene that the sensors see |
//! | [`robot`] | the Kobuki base: drive, odometry, transforms, joint states |
//! | [`entities`] | who is in the world, by name |
//! | [`rig`] | the sensors on their schedule, rendered straight into a sink's memory |
//! | [`simulation`] | all of it, stepped and rendered by a caller: the library |
//! | [`randomize`] | lamps and materials drawn at random, for learning |
//! | `dataset` | samples for learning, in shards (feature `dataset`) |
//! | `server` | the same for other processes: shared memory, commands (feature `server`) |
//! | `recording` | runs kept in MCAP files, and played again (feature `recording`) |
//! | `link` | streams on other machines (feature `link`) |
//! | `view` | a page in the browser (feature `view`) |
//! | `picture` | frames as pictures for people (feature `cli`) |
//! | `cli` | the `belvedere` command (feature `cli`) |
//!
//! Each uses only those above it. The sensors themselves are the crate [`sensors`], the messages of streams and the shared
//! memory are the crate [`bridge`].
#![forbid(unsafe_code)]

/// The crate `belvedere-bridge`: headers and payloads of frames, as [`bridge::payload::Odometry`], and, with the feature
/// `server`, publishers and subscribers.
pub use belvedere_bridge as bridge;
/// The crate `belvedere-description`: robot and world files (xacro, URDF, SDF) as one typed model.
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
#[cfg(feature = "server")]
pub mod server;
pub mod simulation;
#[cfg(feature = "view")]
pub mod view;
pub mod world;

/// The Rust code of the book.
#[cfg(doctest)]
mod book {
    #[doc = include_str!("../docs/library.md")]
    mod library {}
    #[doc = include_str!("../docs/sensors.md")]
    mod sensors {}
}
