//! Warns of concave collision meshes that move, because they are simulated as their convex hull.

use crate::diagnostics::Diagnostics;
use crate::model::{Collision, Geometry, Link, Mesh, Model};
use std::collections::HashMap;
use std::sync::Arc;

/// Sine of the largest inward bend at an edge that still counts as convex; rounding in files causes less.
const FLAT: f64 = 0.02;

/// Number of faces that are compared with all corners.
const COMPARED: usize = 64;
/// Largest distance of a corner beyond such a face, as a share of the distance from the first corner to the farthest.
const FAR: f64 = 0.01;

/// Adds a warning for each model that moves and has concave collision meshes: at the first of them, with their number.
pub(crate) fn warn_of_hulls<'m>(models: impl IntoIterator<Item = &'m Model>, diagnostics: &mut Diagnostics) {
    // A mesh that is used several times is looked at once.
    let mut known: HashMap<*const Mesh, bool> = HashMap::new();
    for model in models.into_iter().filter(|model| !model.is_static && model.trajectory.is_none()) {
        let mut found: Vec<(&Link, &Collision)> = Vec::new();
        for link in model.links.iter().filter(|link| !link.is_static) {
            found.extend(
                link.collisions
                    .iter()
                    .filter(|collision| is_hull(collision, &mut known))
                    .map(|it| (link, it)),
            );
        }
        let Some((link, collision)) = found.first() else { continue };
        let others = match found.len() - 1 {
            0 => String::new(),
            count => format!(" (so do {count} more of the model '{}')", model.name),
        };
        diagnostics.warning(
            &collision.source,
            format!(
                "the collision '{}' of the link '{}' is a concave mesh that moves: it touches as its convex hull, in whose \
                 hollows nothing fits{others}",
                collision.name, link.name
            ),
            "write several convex collisions in its place, or make the model <static>",
        );
    }
}

/// Returns true if a collision shape differs from its convex hull.
fn is_hull(collision: &Collision, known: &mut HashMap<*const Mesh, bool>) -> bool {
    let Geometry::Mesh(mesh) = &collision.geometry else { return false };
    collision.contact.is_solid && *known.entry(Arc::as_ptr(mesh)).or_insert_with(|| is_concave(mesh))
}

/// Returns true if the faces at an edge of the mesh bend inwards, a corner lies beyond a face, or the mesh has several
/// parts.
fn is_concave(mesh: &Mesh) -> bool {
    let triangles = welded(mesh);
    let point = |index: u32| glam::Vec3::from_array(mesh.positions[index as usize]).as_dvec3();
    // If the mesh is inside out, its faces point the other way.
    let volume: f64 = triangles.iter().map(|&[a, b, c]| point(a).dot(point(b).cross(point(c)))).sum();
    let normal = |&[a, b, c]: &[u32; 3]| {
        (point(b) - point(a)).cross(point(c) - point(a)).normalize_or_zero() * volume.signum()
    };
    let mut is_corner = vec![false; mesh.positions.len()];
    for corner in triangles.iter().flatten() {
        is_corner[*corner as usize] = true;
    }
    let corners: Vec<_> =
        (0..).zip(&is_corner).filter(|(_, is)| **is).map(|(index, _)| point(index)).collect();
    // Where faces are small, a hollow bends little at each of its edges.
    let Some(first) = corners.first() else { return false };
    let size = corners.iter().map(|corner| corner.distance(*first)).fold(0.0, f64::max);
    // An odd step, because faces often come in pairs.
    let mut some = triangles.iter().step_by((triangles.len() / COMPARED + 1) | 1);
    let is_beyond = |triangle: &[u32; 3]| {
        let (at, normal) = (point(triangle[0]), normal(triangle));
        corners.iter().any(|corner| (*corner - at).dot(normal) > FAR * size)
    };
    let is_bent = || {
        triangles.iter().zip(across(&triangles, mesh.positions.len())).any(|(triangle, across)| {
            let normal = normal(triangle);
            triangle.iter().zip(across).any(|(from, beyond)| {
                let Some(beyond) = beyond else { return false };
                let way = point(beyond) - point(*from);
                way.dot(normal) > FLAT * way.length()
            })
        })
    };
    some.any(is_beyond) || is_bent() || has_parts(&triangles, &is_corner)
}

/// Returns the triangles of a mesh. Vertices at the same place have the same number.
fn welded(mesh: &Mesh) -> Vec<[u32; 3]> {
    let bits = |index: usize| mesh.positions[index].map(|it| (it + 0.0).to_bits());
    // Sorted by place, byte by byte.
    let mut order: Vec<usize> = (0..mesh.positions.len()).collect();
    for (axis, byte) in (0..3).flat_map(|axis| (0..4).map(move |byte| (axis, byte))) {
        order = sorted(&order, 256, |index| usize::from(bits(index)[axis].to_le_bytes()[byte]));
    }
    let mut first = vec![0; order.len()];
    for same in order.chunk_by(|one, other| bits(*one) == bits(*other)) {
        for index in same {
            first[*index] = same[0] as u32;
        }
    }
    let welded = mesh.triangles.iter().filter_map(|triangle| {
        let [a, b, c] = triangle.map(|vertex| first.get(vertex as usize).copied());
        Some([a?, b?, c?])
    });
    welded.filter(|[a, b, c]| a != b && b != c && c != a).collect()
}

/// Returns the third corner of the triangle on the other side of each edge of each triangle: of the last one, if there are
/// several. The corners are numbered below `vertices`.
fn across(triangles: &[[u32; 3]], vertices: usize) -> Vec<[Option<u32>; 3]> {
    let ends = |edge: usize| {
        let (corners, side) = (triangles[edge / 3], edge % 3);
        [corners[side] as usize, corners[(side + 1) % 3] as usize]
    };
    let upper = |edge: usize| ends(edge)[0].max(ends(edge)[1]);
    let lower = |edge: usize| ends(edge)[0].min(ends(edge)[1]);
    let edges: Vec<usize> = (0..3 * triangles.len()).collect();
    let edges = sorted(&sorted(&edges, vertices, upper), vertices, lower);
    let mut across = vec![[None; 3]; triangles.len()];
    for same in edges.chunk_by(|one, other| lower(*one) == lower(*other) && upper(*one) == upper(*other)) {
        let is_upward = |edge: usize| usize::from(ends(edge)[0] == lower(edge));
        // The third corners of the last triangle whose edge leads down, and of the last one whose edge leads up.
        let mut third = [None; 2];
        for edge in same {
            third[is_upward(*edge)] = Some(triangles[edge / 3][(edge + 2) % 3]);
        }
        for edge in same {
            across[edge / 3][edge % 3] = third[1 - is_upward(*edge)];
        }
    }
    across
}

/// Sorts by a key below `keys`, in linear time; what has the same key keeps its order.
fn sorted(items: &[usize], keys: usize, key: impl Fn(usize) -> usize) -> Vec<usize> {
    let mut places = vec![0; keys + 1];
    for item in items {
        places[key(*item) + 1] += 1;
    }
    for key in 0..keys {
        places[key + 1] += places[key];
    }
    let mut sorted = vec![0; items.len()];
    for item in items {
        let place = &mut places[key(*item)];
        sorted[*place] = *item;
        *place += 1;
    }
    sorted
}

/// Returns true if a mesh has several parts that share no vertex.
fn has_parts(triangles: &[[u32; 3]], is_corner: &[bool]) -> bool {
    let mut above: Vec<u32> = (0..).take(is_corner.len()).collect();
    let mut count = is_corner.iter().filter(|is| **is).count();
    for [a, b, c] in triangles {
        for (one, other) in [(a, b), (b, c)] {
            let (one, other) = (top(&mut above, *one), top(&mut above, *other));
            if one != other {
                above[one as usize] = other;
                count -= 1;
            }
        }
    }
    count > 1
}

/// Returns the vertex that represents the part of another one, and halves the path to it (union–find).
fn top(above: &mut [u32], mut vertex: u32) -> u32 {
    while above[vertex as usize] != vertex {
        let over = above[above[vertex as usize] as usize];
        above[vertex as usize] = over;
        vertex = over;
    }
    vertex
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Instant;

    fn mesh(positions: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>) -> Mesh {
        Mesh { path: "m".into(), positions, uvs: Vec::new(), normals: Vec::new(), triangles, material: None }
    }

    /// A ring of `count` sides that stands on z = 0, with a tip above its middle, and another in its middle at `floor`.
    fn cone(count: u32, floor: f32) -> Mesh {
        let ring = (0..count).map(|side| {
            let angle = std::f32::consts::TAU * side as f32 / count as f32;
            [angle.cos(), angle.sin(), 0.0]
        });
        let positions = ring.chain([[0.0, 0.0, 1.0], [0.0, 0.0, floor]]).collect();
        let faces = |side: u32| {
            let next = (side + 1) % count;
            [[side, next, count], [next, side, count + 1]]
        };
        mesh(positions, (0..count).flat_map(faces).collect())
    }

    #[test]
    fn cones_with_a_hollow_are_concave() {
        for count in [3, 24, 1000] {
            assert!(!is_concave(&cone(count, 0.0)), "{count}: flat");
            assert!(!is_concave(&cone(count, -0.5)), "{count}: two cones");
            assert!(is_concave(&cone(count, 0.5)), "{count}: hollow");
        }
    }

    #[test]
    fn corners_that_are_written_again_are_one_and_two_parts_are_concave() {
        let whole = cone(24, -0.5);
        let apart = |shift: f32, from: u32| {
            let corners = whole.triangles.iter().flatten().map(move |it| *it as usize);
            let positions = corners.map(|it| whole.positions[it]).map(|[x, y, z]| [x + shift, y, z]);
            let triangles =
                (0..whole.triangles.len() as u32).map(move |it| [0, 1, 2].map(|it2| from + 3 * it + it2));
            (positions.collect::<Vec<_>>(), triangles.collect::<Vec<_>>())
        };
        let (mut positions, mut triangles) = apart(0.0, 0);
        assert!(!is_concave(&mesh(positions.clone(), triangles.clone())));
        let (others, more) = apart(5.0, positions.len() as u32);
        positions.extend(others);
        triangles.extend(more);
        assert!(is_concave(&mesh(positions, triangles)));
    }

    /// A vertex of the mesh has half of its edges.
    #[test]
    fn a_mesh_is_judged_faster_than_its_edges_are_hashed() {
        let large = cone(100_000, -0.5);
        let is_faster = || {
            let start = Instant::now();
            let concave = is_concave(&large);
            let judged = start.elapsed();
            let start = Instant::now();
            let edges = large.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
            let hashed: HashMap<[u32; 2], usize> = edges.zip(0..).collect();
            assert!(!concave && hashed.len() == 600_000);
            let hashed = start.elapsed();
            println!("judged in {judged:?}, hashed in {hashed:?}");
            judged < hashed
        };
        assert!((0..5).any(|_| is_faster()));
    }
}
