//! Individual rays, each with its own origin, direction and range. They are traced one after the other, against sixteen
//! boxes or sixteen triangles at a time.

mod block;
pub(crate) mod bundle;
mod cast;
mod describe;
mod node;
pub(crate) mod ray;
pub(crate) mod scene;
mod settle;
mod walk;
pub(crate) mod wave;

pub use cast::{Rays, cast_rays, occluded_rays, workspace_len};
#[cfg(feature = "raw")]
pub use cast::{cast_mesh, occluded_by_mesh};
pub(crate) use scene::mesh_tree;
#[cfg(feature = "raw")]
pub use walk::MeshTree;
pub(crate) use walk::nearest_in_tree;

use crate::scene::tree::WideNode;
use crate::simd::WIDTH;

/// The absolute part of the error of t in single precision. Coordinates are rounded, so it is 2⁻²⁰ of the largest
/// coordinate in the tree. It matters where t is near 0.
#[inline(always)]
pub(crate) fn doubt_of(root: Option<&WideNode>) -> f32 {
    let mut size = 0.0_f32;
    if let Some(root) = root {
        for axis in 0..3 {
            for lane in 0..WIDTH {
                size = size.max(root.min[axis][lane].abs()).max(root.max[axis][lane].abs());
            }
        }
    }
    size * (1.0 / 1_048_576.0)
}

#[cfg(test)]
mod tests;
