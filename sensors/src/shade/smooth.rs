//! Normals of meshes that have one per vertex, interpolated between the corners of the triangle that was hit (Phong
//! 1975, "Illumination for computer generated pictures").
//!
//! Only light depends on them. Which side of a triangle is seen, where its texture lies and where its shadow falls
//! depends on the triangle itself. A lamp therefore lights points whose interpolated normal faces it, as in Gazebo and
//! MuJoCo, unless its shadow says that the mesh is in between.

use super::axes::{local_points, to_view};
use super::tile::Tile;
use crate::scene::Scene;
use crate::simd::{Lanes, WIDTH, load_row, store_row};
use crate::trace::placed::view::{Placed, View};
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16, mask32x16};
use glam::DVec3;

/// The least square of the length of an interpolated normal. It is shorter only between normals that are nearly
/// opposite, where it has no direction.
const LEAST: f64 = 1e-12;

/// Normals on a triangle, in the axes of its instance.
struct Corners {
    /// The slot of the triangle.
    slot: u32,
    first: DVec3,
    /// Gradients of the barycentric coordinates of the second and third corner.
    gradients: [DVec3; 2],
    normals: [DVec3; 3],
    /// The normal of the triangle itself.
    flat: DVec3,
}

impl Corners {
    fn new(view: &View<'_>, placed: &Placed, slot: u32) -> Self {
        let scene: &Scene<'_> = &view.scene;
        let [a, b, c] = view.corners(placed, slot);
        let (ab, ac) = (b - a, c - a);
        let normal = ab.cross(ac);
        let squared = normal.length_squared();
        // On a triangle without area, the normal of its first corner counts.
        let per_squared = if squared > 0.0 { 1.0 / squared } else { 0.0 };
        let mesh = &scene.meshes[placed.mesh as usize];
        let facet = &scene.facets[placed.first_block as usize * WIDTH + slot as usize];
        let triangle = scene.triangles[(mesh.first_triangle + facet.triangle) as usize];
        let of = |vertex: u32| scene.normals[(mesh.first_vertex + vertex) as usize].map(f64::from);
        Self {
            slot,
            first: a,
            gradients: [ac.cross(normal) * per_squared, normal.cross(ab) * per_squared],
            normals: triangle.map(|vertex| DVec3::from_array(of(vertex))),
            flat: DVec3::from_array(facet.normal.map(f64::from)),
        }
    }

    /// The normal at a point, of any length but 0.
    #[inline(always)]
    fn at(&self, point: DVec3) -> DVec3 {
        let beside = point - self.first;
        // The point is rounded, so it may be outside of the triangle: far outside, if the ray grazes it.
        let second = between(self.gradients[0].dot(beside), 1.0);
        let third = between(self.gradients[1].dot(beside), 1.0 - second);
        let [a, b, c] = self.normals;
        let normal = a * (1.0 - second - third) + b * second + c * third;
        if normal.length_squared() > LEAST { normal } else { self.flat }
    }
}

/// The number, or the nearest one between 0 and `most`; 0 for NaN.
#[inline(always)]
fn between(value: f64, most: f64) -> f64 {
    let positive = if value > 0.0 { value } else { 0.0 };
    if positive < most { positive } else { most }
}

/// Replaces the normals of triangles in `lanes` of a row, which are in the view, by interpolated ones, and returns the
/// lanes whose triangle faces away from the sensor.
#[inline(never)]
pub(super) fn smooth_row<S: Simd>(
    simd: S,
    (view, placed): (&View<'_>, &Placed),
    (tile, row): (&Tile, usize),
    lanes: u16,
    normal: &mut [Lanes<f32>; 3],
) -> u16 {
    simd.vectorize(
        #[inline(always)]
        || {
            let points = local_points(placed, tile, row);
            let mut corners: Option<Corners> = None;
            let mut local = [[0.0; WIDTH]; 3];
            let mut rest = lanes;
            while rest != 0 {
                let lane = rest.trailing_zeros() as usize % WIDTH;
                rest &= rest - 1;
                let slot = tile.local[row * WIDTH + lane];
                // Neighbours usually lie on the same triangle.
                let on = match &mut corners {
                    Some(known) if known.slot == slot => known,
                    other => other.insert(Corners::new(view, placed, slot)),
                };
                let found = on.at(DVec3::new(points[0][lane], points[1][lane], points[2][lane]));
                for axis in 0..3 {
                    local[axis][lane] = found[axis] as f32;
                }
            }

            let mine: mask32x16<S> = simd.from_bitmask_mask32x16(u64::from(lanes));
            // Normals are transformed by the inverse transpose, and normalised afterwards.
            let [x, y, z] = to_view(simd, placed, &local, 1.0);
            let per_length = f32x16::splat(simd, 1.0) / ((x * x + y * y) + z * z).sqrt();
            let mut along = f32x16::splat(simd, 0.0);
            for (axis, turned) in [x, y, z].into_iter().enumerate() {
                let flat = load_row(simd, &normal[axis], row);
                along += flat * load_row(simd, &tile.direction[axis], row);
                store_row(mine.select(turned * per_length, flat), &mut normal[axis], row);
            }
            (along.simd_gt(f32x16::splat(simd, 0.0)) & mine).to_bitmask() as u16
        },
    )
}
