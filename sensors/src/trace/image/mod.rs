//! The image-order path: all rays of a frame that start in one point, at once.
//!
//! Not "for each ray walk the tree", but "walk the tree once, front to back, and find the rays": hierarchical
//! rasterisation with an exact test for every ray. The rays lie in blocks of sixteen; sixteen boxes at a time are
//! projected onto the grid of rays, and dropped where no ray passes or where all that do have already hit something
//! nearer ([`walk`](mod@walk)); where few rays pass, each is asked by itself ([`single`]). Sixteen triangles at a time
//! become edge planes through the origin ([`triangles`]), which a ray tests with four dot products, and are drawn by
//! one of three loops, depending on how many rays they cover.
//!
//! What is kept of a ray is 1/t of its nearest hit, linear in the direction over a plane (and 0 if nothing is
//! hit), and the hit's slot: which triangle of which instance it is.

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
