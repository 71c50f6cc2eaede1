//! Rays and their hits, against closed forms, exhaustive search and other libraries.

#[path = "../common/mod.rs"]
mod common;

mod angles;
mod baked;
mod builder;
mod cast_mesh;
mod closed_form;
mod edges;
mod exact;
mod grazing;
mod landmarks;
mod normals;
mod parry;
mod same_hits;
mod shapes;
mod sizes;
mod slices;
mod table;
mod trees;
mod truth;
mod watertight;
