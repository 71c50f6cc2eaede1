//! Walks the trees with a packet of rays.

use super::frame::Frame;
use super::packet::{Faces, MISS, Packet, PacketBounds};
use super::shapes::{LocalRays, commit, match_solid, triangle};
use crate::scene::{KIND_MESH, Mesh, Node, bvh};
use crate::simd::LANES;
use fearless_simd::Simd;
use glam::DVec3;

/// Finds the nearest hit of every lane.
pub(crate) fn nearest<S: Simd>(simd: S, frame: &Frame<'_>, packet: &mut Packet, faces: Faces) {
    simd.vectorize(
        #[inline(always)]
        || walk_instances::<S, false>(simd, frame, packet, faces, MISS),
    );
}

/// Finds for every lane whether anything is hit at all; `placed` is [`MISS`] where not. Which of several hits
/// is named is not specified. The placed instance `left_out` is passed over.
pub(crate) fn occluded<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    packet: &mut Packet,
    faces: Faces,
    left_out: u32,
) {
    simd.vectorize(
        #[inline(always)]
        || walk_instances::<S, true>(simd, frame, packet, faces, left_out),
    );
}

#[inline(always)]
fn walk_instances<S: Simd, const ANY: bool>(
    simd: S,
    frame: &Frame<'_>,
    packet: &mut Packet,
    faces: Faces,
    left_out: u32,
) {
    if frame.placed.is_empty() {
        return;
    }
    let bounds = PacketBounds::new(&packet.origin, &packet.direction, packet);
    walk(
        frame.nodes,
        &bounds,
        packet.farthest(),
        #[inline(always)]
        |leaf| {
            for &placed in &frame.order[leaf.first as usize..(leaf.first + leaf.count) as usize] {
                if !ANY || placed != left_out {
                    intersect_instance(simd, frame, placed, packet, faces);
                }
            }
            if ANY {
                retire_hits(packet);
            }
            packet.farthest()
        },
    );
}

/// Lanes that have hit something need no more.
#[inline(always)]
fn retire_hits(packet: &mut Packet) {
    for lane in 0..LANES {
        packet.t[lane] = if packet.placed[lane] == MISS { packet.t[lane] } else { f64::NEG_INFINITY };
    }
}

/// Visits the leaves that the packet may meet, nearer ones first. `visit` returns the farthest t that still
/// matters.
#[inline(always)]
fn walk(nodes: &[Node], bounds: &PacketBounds, mut farthest: f64, mut visit: impl FnMut(&Node) -> f64) {
    let mut stack = [(0_u32, f64::NEG_INFINITY); bvh::MAX_DEPTH + 1];
    let mut depth = usize::from(bounds.enter(&nodes[0].bounds, farthest).is_some());
    while depth > 0 {
        depth -= 1;
        let (index, enter) = stack[depth];
        if enter > farthest {
            continue;
        }
        let node = &nodes[index as usize];
        if node.count > 0 {
            farthest = visit(node);
            continue;
        }
        let children = [node.first, node.first + 1];
        let left = bounds.enter(&nodes[children[0] as usize].bounds, farthest);
        let right = bounds.enter(&nodes[children[1] as usize].bounds, farthest);
        match (left, right) {
            (Some(left), Some(right)) => {
                // The nearer child goes on top. Where both begin alike, their centres along the axis that tells
                // them apart decide.
                let left_first = if left == right { leads(nodes, children, bounds) } else { left < right };
                let [first, second] = if left_first {
                    [(children[0], left), (children[1], right)]
                } else {
                    [(children[1], right), (children[0], left)]
                };
                stack[depth] = second;
                stack[depth + 1] = first;
                depth += 2;
            }
            (Some(enter), None) => {
                stack[depth] = (children[0], enter);
                depth += 1;
            }
            (None, Some(enter)) => {
                stack[depth] = (children[1], enter);
                depth += 1;
            }
            (None, None) => {}
        }
    }
}

#[inline(always)]
fn leads(nodes: &[Node], children: [u32; 2], bounds: &PacketBounds) -> bool {
    let (left, right) = (&nodes[children[0] as usize].bounds, &nodes[children[1] as usize].bounds);
    let apart = |axis: usize| (left.min[axis] + left.max[axis]) - (right.min[axis] + right.max[axis]);
    let (x, y, z) = (apart(0).abs(), apart(1).abs(), apart(2).abs());
    let axis = if x > y && x > z { 0 } else { usize::from(z > y) + 1 };
    (apart(axis) < 0.0) == bounds.ascending(axis)
}

#[inline(always)]
fn intersect_instance<S: Simd>(simd: S, frame: &Frame<'_>, placed: u32, packet: &mut Packet, faces: Faces) {
    let instance = frame.instance(placed);
    let rays = local_rays(frame, placed, packet);
    match_solid!(
        instance,
        inside => commit(&rays, packet, faces, placed, inside),
        _ => if instance.kind == KIND_MESH {
            walk_mesh(simd, frame, &frame.scene.meshes[instance.mesh as usize], &rays, packet, faces, placed);
        }
    );
}

#[inline(always)]
fn local_rays(frame: &Frame<'_>, placed: u32, packet: &Packet) -> LocalRays {
    let placed = &frame.placed[placed as usize];
    let mut rays = LocalRays { origin: [[0.0; LANES]; 3], direction: [[0.0; LANES]; 3] };
    for axis in 0..3 {
        let [x, y, z] = placed.inverse[axis];
        let [tx, ty, tz] = placed.translation;
        let origin = |lane: usize| {
            x * (packet.origin[0][lane] - tx)
                + y * (packet.origin[1][lane] - ty)
                + z * (packet.origin[2][lane] - tz)
        };
        if packet.shared_origin {
            rays.origin[axis] = [origin(0); LANES];
        } else {
            for lane in 0..LANES {
                rays.origin[axis][lane] = origin(lane);
            }
        }
        for lane in 0..LANES {
            rays.direction[axis][lane] =
                x * packet.direction[0][lane] + y * packet.direction[1][lane] + z * packet.direction[2][lane];
        }
    }
    rays
}

fn walk_mesh<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    mesh: &Mesh,
    rays: &LocalRays,
    packet: &mut Packet,
    faces: Faces,
    placed: u32,
) {
    let scene = &frame.scene;
    let nodes = &scene.old_nodes[mesh.old_first_node as usize..][..mesh.old_nodes as usize];
    simd.vectorize(
        #[inline(always)]
        || {
            let bounds = PacketBounds::new(&rays.origin, &rays.direction, packet);
            walk(
                nodes,
                &bounds,
                packet.farthest(),
                #[inline(always)]
                |leaf| {
                    for index in leaf.first..leaf.first + leaf.count {
                        let triangle = mesh.first_triangle + index;
                        let corners = triangle_corners(frame, mesh, triangle);
                        triangle::intersect(rays, corners, packet, faces, placed, triangle);
                    }
                    packet.farthest()
                },
            );
        },
    );
}

/// Corners of a triangle of the scene in the frame of its mesh.
#[inline(always)]
pub(crate) fn triangle_corners(frame: &Frame<'_>, mesh: &Mesh, triangle: u32) -> [DVec3; 3] {
    let scene = &frame.scene;
    scene.triangles[triangle as usize].map(|vertex| {
        let [x, y, z] = scene.vertices[(mesh.first_vertex + vertex) as usize];
        DVec3::new(f64::from(x), f64::from(y), f64::from(z))
    })
}
