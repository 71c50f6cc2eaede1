//! Sensors: their measurements, compared with the truth.

#[path = "../common/mod.rs"]
mod common;

mod air;
mod bad_input;
mod beams;
mod cubes;
mod defaults;
mod depth_formats;
mod depth_models;
mod depth_principles;
mod depth_sensors;
mod device;
mod disturbed;
mod gaussian;
mod lens_pictures;
mod lidar_points;
mod light;
mod lighting;
mod livox;
mod mirrors;
mod modulation;
mod moments;
mod noise_in_sensors;
mod owned;
mod parameters;
mod pbr_maps;
mod plain;
mod scanner;
mod scanner_presets;
mod shadows;
mod shutter;
mod smooth;
mod textures;
mod turning;
