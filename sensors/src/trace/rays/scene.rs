//! Rays in a scene.
//!
//! Each ray walks the tree over the instances, front to back. At an instance, it continues in the instance's own frame:
//! through the tree of a mesh or a height field, or in the kernel of a solid. If the scene consists of a single mesh,
//! sixteen rays at a time traverse its tree directly.

use super::doubt_of;
use super::ray::{FrameRay, Nearest, Ray};
use super::walk::{MeshTree, STACK, Stack, Waiting, children_of, nearest_in_tree};
use crate::scene::tree::NONE;
use crate::scene::{Kind, Triangles};
use crate::trace::Faces;
use crate::trace::placed::view::{Placed, View};
use crate::trace::shapes::match_solid;
use fearless_simd::Simd;
use glam::{DMat3, DVec3};

/// The hit of a ray in a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SceneHit {
    /// t, in units of the ray's direction.
    pub(crate) t: f64,
    /// The index among the placed instances; [`NONE`] for a miss.
    pub(crate) placed: u32,
    /// Block × 16 + lane for a mesh or height field, otherwise 0.
    pub(crate) slot: u32,
}

/// Memory for the waiting children of the tree over the instances and of the instance's own tree.
pub(crate) struct Stacks {
    instances: [Waiting; STACK],
    triangles: [Waiting; STACK],
}

impl Stacks {
    /// No waiting children.
    pub(crate) const fn new() -> Self {
        Self { instances: [Waiting::NONE; STACK], triangles: [Waiting::NONE; STACK] }
    }
}

/// Transforms a ray to the frame of an instance.
pub(super) fn in_instance(placed: &Placed, ray: &FrameRay) -> [DVec3; 2] {
    let inverse = DMat3::from_cols_array_2d(&placed.inverse).transpose();
    let origin = DVec3::from_array(placed.origin_in_instance) + inverse * wide(ray.origin);
    [origin, inverse * wide(ray.direction)]
}

fn wide(v: [f32; 3]) -> DVec3 {
    DVec3::new(v[0].into(), v[1].into(), v[2].into())
}

/// The tree of a placed mesh.
pub(crate) fn mesh_tree<'a>(view: &View<'a>, placed: &Placed) -> MeshTree<'a> {
    let mesh = &view.scene.meshes[view.scene.instances[placed.instance as usize].mesh as usize];
    MeshTree {
        nodes: &view.scene.nodes[mesh.first_node as usize..][..mesh.nodes as usize],
        blocks: &view.scene.blocks[mesh.first_block as usize..][..mesh.blocks as usize],
    }
}

/// Finds the nearest hit of a ray on any instance; with `ANY`, any hit.
#[inline(always)]
pub(crate) fn hit_in_view<const ANY: bool, S: Simd>(
    simd: S,
    view: &View<'_>,
    ray: &FrameRay,
    faces: Faces,
    stacks: &mut Stacks,
) -> SceneHit {
    let mut hit = SceneHit { t: f64::INFINITY, placed: NONE, slot: NONE };
    let frame_ray = Ray::new(ray.origin.map(f64::from), ray.direction.map(f64::from), ray.range, 0.0);
    let top = MeshTree { nodes: view.nodes, blocks: &[] };
    let below = &mut stacks.triangles[..];
    children_of(
        simd,
        top,
        &frame_ray,
        &mut stacks.instances,
        #[inline(always)]
        |placed| {
            hit_instance(simd, view, placed, ray, faces, below, &mut hit);
            if ANY && hit.placed != NONE {
                return f32::NEG_INFINITY;
            }
            // Slightly more, because boxes and hits are rounded.
            let t = (hit.t / f64::from(frame_ray.unit) * (1.0 + 1e-6)) as f32;
            if t < frame_ray.range[1] { t } else { frame_ray.range[1] }
        },
    );
    hit
}

/// Stores the ray's hit on one instance if it is nearer than its hit so far.
#[inline(always)]
fn hit_instance<S: Simd>(
    simd: S,
    view: &View<'_>,
    index: u32,
    ray: &FrameRay,
    faces: Faces,
    stack: &mut Stack,
    hit: &mut SceneHit,
) {
    let Some(placed) = view.placed.get(index as usize) else { return };
    let instance = &view.scene.instances[placed.instance as usize];
    let [origin, direction] = in_instance(placed, ray);
    let from = f64::from(ray.range[0]);
    let (origin, direction) = (origin.to_array(), direction.to_array());
    let nearest_in = |stack: &mut Stack, triangles: Triangles| {
        // No farther than the hit so far, plus the rounding error of single precision.
        let limit = (hit.t * (1.0 + 1e-6)) as f32;
        let range = [ray.range[0], if limit < ray.range[1] { limit } else { ray.range[1] }];
        let (nearest, unit) = match triangles {
            Triangles::Mesh => {
                let tree = mesh_tree(view, placed);
                let local = Ray::new(origin, direction, range, doubt_of(tree.nodes.first()));
                (nearest_of(simd, tree, &local, faces, stack), local.unit)
            }
            Triangles::HeightField => {
                let grid = view.height_grid(placed);
                let local = Ray::new(origin, direction, range, doubt_of(Some(&grid.node(0))));
                (nearest_of(simd, &grid, &local, faces, stack), local.unit)
            }
        };
        (nearest.t * f64::from(unit), nearest.slot)
    };
    let found = match instance.kind() {
        Kind::Solid(solid) => match_solid!(
            solid,
            instance.size,
            inside => (inside(origin, direction).first(from, faces == Faces::Both), 0)
        ),
        Kind::Triangles(triangles) => nearest_in(stack, triangles),
    };
    let (t, slot) = found;
    let first = t < hit.t || (t == hit.t && (index, slot) < (hit.placed, hit.slot));
    if t < f64::INFINITY && t <= f64::from(ray.range[1]) && first {
        *hit = SceneHit { t, placed: index, slot };
    }
}

#[inline(always)]
fn nearest_of<S: Simd>(
    simd: S,
    tree: impl super::walk::Branches,
    ray: &Ray,
    faces: Faces,
    stack: &mut Stack,
) -> Nearest {
    let mut nearest = Nearest::none(ray);
    nearest_in_tree(simd, tree, ray, faces == Faces::Front, stack, &mut nearest);
    nearest
}
