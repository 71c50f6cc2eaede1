//! Description files: their meaning, and the messages about their errors.

#[path = "../sdf/mod.rs"]
mod sdf;

mod actors;
mod budget;
mod concave;
mod frames;
mod frames_at_random;
mod lights;
mod looks;
mod mesh;
mod of_others;
mod of_others_sensors;
mod parameters;
mod plugin_parameters;
mod robot;
mod shapes;
mod world;
mod world_faults;
