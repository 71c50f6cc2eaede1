#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod concave;
mod elements;
mod fiducial;
pub mod gazebo_materials;
pub mod housing;
pub mod image_file;
pub mod inertia;
mod label;
pub mod load;
pub mod mesh;
mod mimic;
pub mod model;
pub mod models;
pub mod ogre_material;
mod optics;
pub mod pbr_picture;
mod plugin;
pub mod rules;
mod sdf;
pub mod sensor;
pub mod sensor_frames;
mod solid;
pub mod text;
mod topic;
mod urdf;
pub mod values;

/// The crate `belvedere-xacro`, which expands xacro files.
pub use belvedere_xacro as xacro;
pub use belvedere_xacro::{
    budget, diagnostics, encoding, file, model_index, package, shell, suggestion, xml,
};

pub use diagnostics::{Diagnostics, Problem, Severity, Source};
pub use rules::{Rules, SensorModels};
