//! Robot and world files: text in, one typed model out, every problem with its file and line.

pub mod any;
mod budget;
pub mod diagnostics;
mod fiducial;
pub mod gazebo_materials;
pub mod housing;
pub(crate) mod image_file;
pub(crate) mod inertia;
mod label;
pub mod mesh;
pub mod model;
pub mod ogre_material;
pub mod optical;
mod optics;
pub mod package;
mod plugin;
pub mod read;
pub mod robot;
pub mod rules;
mod sdf;
pub mod sensor;
pub mod single;
pub mod suggestion;
pub mod text;
mod topic;
mod urdf;
pub mod values;
pub mod world;
pub mod xacro;
pub mod xml;

pub use diagnostics::{Diagnostics, Problem, Severity, Source};
pub use rules::{Rules, SensorModels};
