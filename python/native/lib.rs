//! The module `belvedere._native`: the sensors, the simulator and the streams of one for Python.
//!
//! Here arrays become slices and slices are rendered into, and the ends of streams become objects; what arguments mean, defaults and shapes are the Python
//! package's (`src/belvedere`), which alone uses this module. Whatever takes time runs without the interpreter's lock.
//!
//! | module | is |
//! |---|---|
//! | `errors` | exceptions that name the argument |
//! | `poses` | arrays of poses |
//! | `outputs` | the caller's arrays, as slices frame by frame |
//! | `pool` | threads, and the memory that each works in |
//! | `interrupt` | Ctrl-C while something takes long |
//! | `data` | a scene, and bodies that move as one |
//! | `world` | worlds as Python makes them |
//! | `load` | worlds and robots from files |
//! | `looks` | colours and lamps of each world of a batch |
//! | `shots` | from where and when a batch is seen |
//! | `path` | the way of what turns, in steps |
//! | `lens`, `camera`, `depth_camera`, `lidar`, `scanner` | the sensors |
//! | `cast` | rays with nothing in common |
//! | `simulation` | a world that runs |
//! | `own` | what is shared with other processes: one thread at a time, and not in a forked child |
//! | `failures` | failures of the bridge as exceptions |
//! | `node`, `subscriber`, `frame`, `sender` | streams of a simulator that runs beside |
#![forbid(unsafe_code)]
#![allow(missing_docs, reason = "the interface is Python's, and described in `_native.pyi`")]
#![allow(clippy::needless_pass_by_value, reason = "what Python hands over is owned")]
#![allow(clippy::too_many_arguments, reason = "keywords of Python")]

mod camera;
mod cast;
mod data;
mod depth_camera;
mod errors;
mod failures;
mod frame;
mod interrupt;
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
mod scanner;
mod sender;
mod shots;
mod simulation;
mod subscriber;
mod world;

use pyo3::prelude::*;

/// Sensors and simulator, for the package `belvedere` alone.
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
    use crate::scanner::Scanner;
    #[pymodule_export]
    use crate::sender::Sender;
    #[pymodule_export]
    use crate::simulation::Simulation;
    #[pymodule_export]
    use crate::subscriber::Subscriber;
    #[pymodule_export]
    use crate::world::World;
}
