//! Checks of mesh vertices, and access to the corners of a triangle.

use super::SceneError;

/// The greatest allowed distance of a vertex from the origin of its mesh along an axis, in metres: products of three
/// lengths must stay in the range of f32.
pub const MAX_COORDINATE: f32 = 1e12;

/// Number of vertices that are checked at a time.
const CHUNK: usize = 1024;

/// Checks that every vertex is finite and within [`MAX_COORDINATE`].
pub(super) fn check_vertices(positions: &[[f32; 3]]) -> Result<(), SceneError> {
    // No early exit within a chunk, so that the check is vectorised.
    let inside = |x: &f32| x.abs() <= MAX_COORDINATE;
    let faulty = |chunk: &[[f32; 3]]| !chunk.as_flattened().iter().fold(true, |all, x| all & inside(x));
    let Some(chunk) = positions.chunks(CHUNK).position(faulty) else {
        return Ok(());
    };
    let within = positions[chunk * CHUNK..].iter().position(|vertex| !vertex.iter().all(inside));
    let bad = chunk * CHUNK + within.unwrap_or(0);
    let finite = positions[bad].iter().all(|x| x.is_finite());
    Err(if finite { SceneError::VertexTooFar(bad) } else { SceneError::BadVertex(bad) })
}

/// The corners of a triangle.
///
/// # Errors
/// [`SceneError::BadTriangle`] if the triangle refers to a vertex that does not exist.
#[inline(always)]
pub(super) fn corners(
    positions: &[[f32; 3]],
    triangles: &[[u32; 3]],
    index: usize,
) -> Result<[[f32; 3]; 3], SceneError> {
    let [a, b, c] = triangles[index];
    match (positions.get(a as usize), positions.get(b as usize), positions.get(c as usize)) {
        (Some(&a), Some(&b), Some(&c)) => Ok([a, b, c]),
        _ => Err(SceneError::BadTriangle(index)),
    }
}
