//! What is known of triangles besides their corners.

use crate::scene::tree::{Facet, TriangleBlock, WIDTH};
use crate::simd::sqrt;

/// Works out the facets of blocks, sixteen for each.
///
/// # Panics
/// When there are not sixteen facets for each block.
pub fn fill_facets(blocks: &[TriangleBlock], facets: &mut [Facet]) {
    assert_eq!(facets.len(), blocks.len() * WIDTH, "sixteen facets for each block");
    for (block, facets) in blocks.iter().zip(facets.as_chunks_mut::<WIDTH>().0) {
        for (lane, facet) in facets.iter_mut().enumerate() {
            let [a, b, c] = block.corners.each_ref().map(|corner| corner.map(|axis| f64::from(axis[lane])));
            *facet = Facet { normal: unit_normal(a, b, c), triangle: block.triangle[lane] };
        }
    }
}

fn unit_normal(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> [f32; 3] {
    let [ux, uy, uz] = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
    let [vx, vy, vz] = [c[0] - a[0], c[1] - a[1], c[2] - a[2]];
    let normal = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
    let length = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    if length > 0.0 { normal.map(|x| (x / length) as f32) } else { [0.0; 3] }
}
