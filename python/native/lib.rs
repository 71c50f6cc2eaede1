//! The module `belvedere._native`: Belvedere's sensors, simulator and streams for Python.
//!
//! This module converts arrays to slices, renders into slices, and wraps the ends of streams in objects. The Python
//! package (`src/belvedere`), its only user, defines arguments, defaults and shapes. Long operations release the
//! interpreter's lock.
//!
//! | module | contents |
//! |---|---|
//! | `errors` | exceptions that name the argument |
//! | `poses` | arrays of poses |
//! | `outputs` | the caller's arrays, as slices frame by frame |
//! | `pool` | threads, and their working memory |
//! | `interrupt` | Ctrl-C during long operations |
//! | `data` | a scene, and bodies that move as one |
//! | `world` | worlds built by Python |
//! | `load` | worlds and robots from files |
//! | `looks` | colours and lamps of each world of a batch |
//! | `shots` | poses of sensor and bodies for each frame of a batch |
//! | `states`, `lamps` | poses of sensor and bodies, and lamps, in states of MuJoCo |
//! | `path` | interpolation of rotating motion |
//! | `lens`, `camera`, `depth_camera`, `lidar`, `scanner` | the sensors |
//! | `cast` | arbitrary rays |
//! | `simulation` | running simulations |
//! | `own` | objects in shared memory: used by one thread at a time, and not in a forked child |
//! | `failures` | failures of the bridge as exceptions |
//! | `program` | the command line |
//! | `node`, `subscriber`, `frame`, `sender` | streams of a simulator in another process |
#![forbid(unsafe_code)]
#![allow(missing_docs, reason = "the interface is for Python, and documented in `_native.pyi`")]
#![allow(clippy::needless_pass_by_value, reason = "arguments from Python are owned")]
#![allow(clippy::too_many_arguments, reason = "keywords of Python")]

mod camera;
mod cast;
mod data;
mod depth_camera;
mod errors;
mod failures;
mod frame;
mod interrupt;
mod lamps;
mod lens;
mod lidar;
mod load;
mod looks;
mod node;
mod outputs;
mod own;
mod path;
mod pool;
mod poses;
mod program;
mod scanner;
mod sender;
mod shots;
mod simulation;
mod states;
mod subscriber;
mod surface;
mod world;

use pyo3::prelude::*;

/// Sensors, simulator and streams, only for the package `belvedere`.
#[pymodule]
mod _native {
    #[pymodule_export]
    use crate::camera::Camera;
    #[pymodule_export]
    use crate::depth_camera::DepthCamera;
    #[pymodule_export]
    use crate::frame::Frame;
    #[pymodule_export]
    use crate::lidar::Lidar;
    #[pymodule_export]
    use crate::node::Node;
    #[pymodule_export]
    use crate::poses::{bad_pose, poses_of_matrices};
    #[pymodule_export]
    use crate::program::run_words;
    #[pymodule_export]
    use crate::scanner::Scanner;
    #[pymodule_export]
    use crate::sender::Sender;
    #[pymodule_export]
    use crate::simulation::Simulation;
    #[pymodule_export]
    use crate::states::States;
    #[pymodule_export]
    use crate::subscriber::Subscriber;
    #[pymodule_export]
    use crate::world::World;
}
