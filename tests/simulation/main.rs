//! The simulator as a library.

#[path = "../robot_models/mod.rs"]
mod robot_models;
#[path = "../sdf/mod.rs"]
mod sdf;

mod bases;
mod contacts;
mod depth_presets;
mod dynamics;
mod far;
mod force_torque;
mod gpu_lidar;
mod inertial;
mod instruments;
mod lidar_clouds;
mod lidar_layouts;
mod lidar_returns;
mod logical_camera;
mod optics;
mod pbr_maps;
mod physics;
mod rest;
mod robot;
mod streams;
mod visibility;
