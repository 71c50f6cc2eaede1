//! Rays that have nothing in common: each with its own origin, direction and range, one after the other, against
//! sixteen boxes or sixteen triangles at a time.

mod block;
mod bundle;
mod cast;
mod node;
mod ray;
mod settle;
mod walk;
mod wave;

pub use cast::{Hits, Rays, cast_mesh, occluded_by_mesh};
pub use walk::Tree;

#[cfg(test)]
mod tests;
