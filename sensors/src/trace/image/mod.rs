//! Tracing in image order: all rays of a frame that start at one point, at once.
//!
//! Instead of walking the tree once for each ray, the tree is walked once, front to back, and the rays that hit it are
//! found: hierarchical rasterisation with an exact test for every ray. The rays are in blocks of sixteen. Sixteen boxes
//! at a time are projected onto the grid of rays, and dropped if no ray passes them or if all rays that do have already
//! hit something nearer ([`walk`](mod@walk)). If only few rays pass, each is tested on its own ([`single`]). Sixteen
//! triangles at a time are converted to edge planes through the origin ([`triangles`]), which a ray tests with four dot
//! products, and are drawn by one of three loops, depending on how many rays they cover.
//!
//! For each ray, 1/t of the nearest hit is stored, which on a plane is linear in the direction, and 0 if nothing is
//! hit; and the slot of the hit, which identifies the triangle and the instance.

mod corners;
mod entry;
mod leaf;
mod set_up;
mod sharp;
mod silhouette;
mod single;
mod solid;
mod strip;
mod target;
mod triangles;
mod walk;

pub(crate) use target::{GRAZING, GRAZING_SQUARED, NO_HIT, Target};
pub(crate) use walk::walk;
