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
    let opposite: HashMap<[u32; 2], u32> =
        triangles.iter().flat_map(|&[a, b, c]| [([a, b], c), ([b, c], a), ([c, a], b)]).collect();
    let point = |index: u32| glam::Vec3::from_array(mesh.positions[index as usize]).as_dvec3();
    // If the mesh is inside out, its faces point the other way.
    let volume: f64 = triangles.iter().map(|&[a, b, c]| point(a).dot(point(b).cross(point(c)))).sum();
    let normal = |&[a, b, c]: &[u32; 3]| {
        (point(b) - point(a)).cross(point(c) - point(a)).normalize_or_zero() * volume.signum()
    };
    let is_bent = |triangle: &[u32; 3]| {
        let ([a, b, c], normal) = (*triangle, normal(triangle));
        [[a, b], [b, c], [c, a]].into_iter().any(|[from, to]| {
            let Some(beyond) = opposite.get(&[to, from]) else { return false };
            let way = point(*beyond) - point(from);
            way.dot(normal) > FLAT * way.length()
        })
    };
    // Where faces are small, a hollow bends little at each of its edges.
    let corners = || triangles.iter().flatten().map(|corner| point(*corner));
    let Some(first) = corners().next() else { return false };
    let size = corners().map(|corner| corner.distance(first)).fold(0.0, f64::max);
    // An odd step, because faces often come in pairs.
    let mut some = triangles.iter().step_by((triangles.len() / COMPARED + 1) | 1);
    let is_beyond = |triangle: &[u32; 3]| {
        let (at, normal) = (point(triangle[0]), normal(triangle));
        corners().any(|corner| (corner - at).dot(normal) > FAR * size)
    };
    some.any(is_beyond) || triangles.iter().any(is_bent) || parts(&triangles) > 1
}

/// Returns the triangles of a mesh. Vertices at the same place have the same number.
fn welded(mesh: &Mesh) -> Vec<[u32; 3]> {
    let mut places: HashMap<[u32; 3], u32> = HashMap::new();
    let first: Vec<u32> = mesh
        .positions
        .iter()
        .zip(0..)
        .map(|(position, index)| *places.entry(position.map(|it| (it + 0.0).to_bits())).or_insert(index))
        .collect();
    let welded = mesh.triangles.iter().filter_map(|triangle| {
        let [a, b, c] = triangle.map(|vertex| first.get(vertex as usize).copied());
        Some([a?, b?, c?])
    });
    welded.filter(|[a, b, c]| a != b && b != c && c != a).collect()
}

/// Returns the number of parts of a mesh that share no vertex.
fn parts(triangles: &[[u32; 3]]) -> usize {
    let mut above: HashMap<u32, u32> = triangles.iter().flatten().map(|vertex| (*vertex, *vertex)).collect();
    let mut count = above.len();
    for [a, b, c] in triangles {
        for (one, other) in [(a, b), (b, c)] {
            let (one, other) = (top(&mut above, *one), top(&mut above, *other));
            if one != other {
                above.insert(one, other);
                count -= 1;
            }
        }
    }
    count
}

/// Returns the vertex that represents the part of another one, and halves the path to it (union–find).
fn top(above: &mut HashMap<u32, u32>, mut vertex: u32) -> u32 {
    while above[&vertex] != vertex {
        let over = above[&above[&vertex]];
        above.insert(vertex, over);
        vertex = over;
    }
    vertex
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::{Duration, Instant};

    fn mesh(positions: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>) -> Mesh {
        Mesh { path: "m".into(), positions, uvs: Vec::new(), triangles, material: None }
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

    #[test]
    fn a_million_triangles_are_judged_in_time() {
        let large = cone(500_000, -0.5);
        let start = Instant::now();
        let concave = is_concave(&large);
        assert!(!concave && start.elapsed() < Duration::from_secs(60), "{concave} {:?}", start.elapsed());
    }
}
