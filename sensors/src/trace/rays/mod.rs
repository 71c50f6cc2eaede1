//! Rays that have nothing in common: each with its own origin, direction and range, one after the other, against
//! sixteen boxes or sixteen triangles at a time.

mod block;
mod node;
mod ray;
mod walk;

pub(crate) use ray::{Nearest, Ray};
pub(crate) use walk::{Stack, Tree, nearest_in_mesh};
