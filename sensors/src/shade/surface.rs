//! The surfaces that the rays of a tile have hit: normals, and footprints on textures. Flat faces have their own,
//! faster implementation in [`super::face`].
//!
//! A tile sees few instances, so its surfaces are computed instance by instance, for all lanes of a row at once, and
//! each lane keeps the result of its own instance.

use super::axes::{load, local_points, to_instance, to_view};
use super::smooth::smooth_row;
use super::tile::{Steps, Tile};
use super::{ROWS, lanes_in, store_where};
use crate::optics::rays::dot;
use crate::scene::{Kind, Solid, Triangles};
use crate::simd::{LANES, Lanes, WIDTH, floor, load_row, sqrt_f32};
use crate::trace::hit::cache::HitCache;
use crate::trace::hit::curved::Curved;
use crate::trace::placed::view::{Placed, View};
use crate::trace::shapes::solid_surface;
use crate::trace::shapes::surface::{Surface, flat};
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, f32x16, mask32x16};
use glam::DVec3;

/// Footprints of a row's pixels on a texture, in texture coordinates including repetitions.
#[derive(Clone, Copy)]
pub(crate) struct Footprint<S: Simd> {
    /// The centre, without whole repetitions.
    pub(crate) uv: [f32x16<S>; 2],
    /// Changes of u and v to the next pixel along the row, and down the column.
    pub(crate) steps: [[f32x16<S>; 2]; 2],
}

impl<S: Simd> Footprint<S> {
    /// Footprints of size 0 at the origin.
    #[inline(always)]
    pub(crate) fn nothing(simd: S) -> Self {
        let zero = f32x16::splat(simd, 0.0);
        Self { uv: [zero; 2], steps: [[zero; 2]; 2] }
    }

    /// Copies the lanes of another footprint that are set in `mine`.
    #[inline(always)]
    pub(crate) fn take(&mut self, mine: mask32x16<S>, other: &Self) {
        for axis in 0..2 {
            self.uv[axis] = mine.select(other.uv[axis], self.uv[axis]);
            for side in 0..2 {
                self.steps[side][axis] = mine.select(other.steps[side][axis], self.steps[side][axis]);
            }
        }
    }
}

/// The surfaces of all lanes, in the view. If nothing was hit, the normal is 0 and the rest is undefined.
pub(crate) struct Surfaces {
    /// Unit normal, pointing outwards.
    pub(crate) normal: [Lanes<f32>; 3],
    /// Gradients of u and of v, up to a positive factor. Only set if `wants_gradient`.
    pub(crate) gradient: [[Lanes<f32>; 3]; 2],
    pub(crate) wants_gradient: bool,
    /// The lanes with [interpolated normals](super::smooth), as one bit each, and those of them whose triangle faces
    /// away from the sensor.
    pub(crate) smooth: u64,
    pub(crate) smooth_away: u64,
    /// Recently hit solids without flat faces.
    curved: HitCache<Curved>,
}

impl Surfaces {
    pub(crate) const fn new() -> Self {
        Self {
            normal: [[0.0; LANES]; 3],
            gradient: [[[0.0; LANES]; 3]; 2],
            wants_gradient: false,
            smooth: 0,
            smooth_away: 0,
            curved: HitCache::new(),
        }
    }

    /// Computes the lanes that hit `placed`, and their footprints on the texture if its number of repetitions is given.
    #[inline(always)]
    pub(crate) fn add<S: Simd>(
        &mut self,
        simd: S,
        (view, tile): (&View<'_>, &Tile),
        hits: (u32, u64),
        repeat: Option<[f32; 2]>,
        steps: &Steps,
        footprints: &mut [Footprint<S>; ROWS],
    ) {
        if let Some(repeat) = repeat {
            self.add_rows::<S, true>(simd, (view, tile), hits, (repeat, steps), footprints);
        } else {
            self.add_rows::<S, false>(simd, (view, tile), hits, ([1.0; 2], steps), footprints);
        }
    }

    /// Processes the rows one by one, since most instances are only visible in a few rows of a tile.
    #[inline(always)]
    fn add_rows<S: Simd, const TEXTURED: bool>(
        &mut self,
        simd: S,
        (view, tile): (&View<'_>, &Tile),
        (index, lanes): (u32, u64),
        texture: ([f32; 2], &Steps),
        footprints: &mut [Footprint<S>; ROWS],
    ) {
        let placed = &view.placed[index as usize];
        let instance = view.instance(index);
        let is_smooth = placed.kind().is_mesh() && view.scene.is_smooth(placed.mesh);
        let mut local = Local::new();
        for row in 0..ROWS {
            let lanes = (lanes >> (row * WIDTH)) as u16;
            if lanes == 0 {
                continue;
            }
            match placed.kind() {
                Kind::Solid(solid) if TEXTURED => {
                    local.take_solid((solid, instance.size), &local_points(placed, tile, row));
                }
                Kind::Solid(solid) => {
                    let make = || Curved::new((solid, instance.size), placed, &placed.inverse);
                    let [x, y, z] = &tile.point;
                    let points = [load_row(simd, x, row), load_row(simd, y, row), load_row(simd, z, row)];
                    let normals = self.curved.get(index, make).normals(simd, &points);
                    for axis in 0..3 {
                        store_where(
                            simd,
                            lanes_in(simd, lanes.into(), 0),
                            normals[axis],
                            &mut self.normal[axis],
                            row,
                        );
                    }
                    continue;
                }
                Kind::Triangles(triangles) if TEXTURED => {
                    local.take_triangles(view, (placed, triangles), (tile, row), lanes);
                }
                Kind::Triangles(triangles) => {
                    let slots = &tile.local.as_chunks().0[row];
                    local.take_normals(view, (placed, triangles), slots, lanes);
                }
            }
            let mine = lanes_in(simd, lanes.into(), 0);
            self.add_row(simd, mine, placed, row, (&local, texture.0));
            if is_smooth {
                let away = smooth_row(simd, (view, placed), (tile, row), lanes, &mut self.normal);
                self.smooth |= u64::from(lanes) << (row * WIDTH);
                self.smooth_away |= u64::from(away) << (row * WIDTH);
            }
            if TEXTURED {
                footprints[row] = local.footprint(simd, placed, (tile, row), texture);
            }
        }
    }

    /// Converts the surface of a shape at the points of a row to the view.
    #[inline(always)]
    fn add_row<S: Simd>(
        &mut self,
        simd: S,
        mine: mask32x16<S>,
        placed: &Placed,
        row: usize,
        (local, repeat): (&Local, [f32; 2]),
    ) {
        // Normals are transformed by the inverse transpose, and normalised again afterwards.
        let [x, y, z] = to_view(simd, placed, &local.normal, 1.0);
        let per_length = f32x16::splat(simd, 1.0) / ((x * x + y * y) + z * z).sqrt();
        for (axis, turned) in [x, y, z].into_iter().enumerate() {
            store_where(simd, mine, turned * per_length, &mut self.normal[axis], row);
        }
        if self.wants_gradient {
            // Gradients are transformed in the same way.
            for side in 0..2 {
                let change = to_view(simd, placed, &local.gradient[side], repeat[side]);
                for axis in 0..3 {
                    store_where(simd, mine, change[axis], &mut self.gradient[side][axis], row);
                }
            }
        }
    }
}

/// The surface of an instance's shape at the points of a row, in the axes of the instance: directions and differences
/// in single precision, texture coordinates in double precision.
struct Local {
    normal: [[f32; WIDTH]; 3],
    uv: [[f64; WIDTH]; 2],
    gradient: [[[f32; WIDTH]; 3]; 2],
    /// The triangle of a height field that was hit last, and its normal, since neighbours usually lie on the same
    /// triangle.
    last: (u32, [f32; 3]),
}

impl Local {
    #[inline(always)]
    const fn new() -> Self {
        Self {
            normal: [[0.0; WIDTH]; 3],
            uv: [[0.0; WIDTH]; 2],
            gradient: [[[0.0; WIDTH]; 3]; 2],
            last: (u32::MAX, [0.0; 3]),
        }
    }

    /// Computes the surface of a solid without flat faces at the given points; the result is undefined for points that
    /// are not on it.
    #[inline(always)]
    fn take_solid(&mut self, (solid, size): (Solid, [f64; 3]), points: &[[f64; WIDTH]; 3]) {
        macro_rules! each {
            ($($solid:ident),*) => {
                match solid {
                    $(Solid::$solid => for lane in 0..WIDTH {
                        let point = DVec3::new(points[0][lane], points[1][lane], points[2][lane]);
                        self.put(lane, &solid_surface(Solid::$solid, size, point));
                    })*
                    Solid::Box | Solid::Rectangle | Solid::Plane => {}
                }
            };
        }
        each!(Sphere, Cylinder, Capsule, Ellipsoid, Cone);
    }

    /// Computes the surfaces of triangles, for the lanes whose bits are set.
    #[inline(always)]
    fn take_triangles(
        &mut self,
        view: &View<'_>,
        (placed, triangles): (&Placed, Triangles),
        (tile, row): (&Tile, usize),
        lanes: u16,
    ) {
        let points = local_points(placed, tile, row);
        let mut rest = lanes;
        while rest != 0 {
            let lane = rest.trailing_zeros() as usize % WIDTH;
            rest &= rest - 1;
            let point = DVec3::new(points[0][lane], points[1][lane], points[2][lane]);
            let local = tile.local[row * WIDTH + lane];
            let surface = match triangles {
                Triangles::Mesh => on_triangle(view, placed, local, point),
                Triangles::HeightField => on_height_field(view, placed, local, point),
            };
            self.put(lane, &surface);
        }
    }

    #[inline(always)]
    fn put(&mut self, lane: usize, surface: &Surface) {
        for axis in 0..3 {
            self.normal[axis][lane] = surface.normal[axis] as f32;
        }
        for axis in 0..2 {
            self.uv[axis][lane] = surface.uv[axis];
            self.gradient[axis][0][lane] = surface.uv_gradient[axis].x as f32;
            self.gradient[axis][1][lane] = surface.uv_gradient[axis].y as f32;
            self.gradient[axis][2][lane] = surface.uv_gradient[axis].z as f32;
        }
    }

    /// Computes the normals of triangles, for the lanes whose bits are set. The normals of meshes are stored, and
    /// nothing else depends on the point.
    #[inline(always)]
    fn take_normals(
        &mut self,
        view: &View<'_>,
        (placed, triangles): (&Placed, Triangles),
        slots: &[u32; WIDTH],
        lanes: u16,
    ) {
        let mut rest = lanes;
        while rest != 0 {
            let lane = rest.trailing_zeros() as usize % WIDTH;
            rest &= rest - 1;
            let slot = slots[lane];
            let normal = match triangles {
                Triangles::Mesh => kept_normal(view, placed, slot),
                Triangles::HeightField => {
                    if self.last.0 != slot {
                        self.last = (slot, view.height_field_normal(placed, slot));
                    }
                    self.last.1
                }
            };
            for axis in 0..3 {
                self.normal[axis][lane] = normal[axis];
            }
        }
    }

    /// The footprints of the pixels on the texture: how far the hit moves on the surface's plane from one pixel to the
    /// next (Igehy 1999, "Tracing ray differentials").
    #[inline(always)]
    fn footprint<S: Simd>(
        &self,
        simd: S,
        placed: &Placed,
        (tile, row): (&Tile, usize),
        (repeat, steps): ([f32; 2], &Steps),
    ) -> Footprint<S> {
        let mut footprint = Footprint::nothing(simd);
        for axis in 0..2 {
            // Whole repetitions are subtracted in f64, so that the rest keeps its digits in f32.
            let repeat = f64::from(repeat[axis]);
            let mut rest = [0.0; WIDTH];
            for lane in 0..WIDTH {
                let coordinate = self.uv[axis][lane] * repeat;
                rest[lane] = (coordinate - floor(coordinate)) as f32;
            }
            footprint.uv[axis] = load(simd, &rest);
        }
        let normal = [load(simd, &self.normal[0]), load(simd, &self.normal[1]), load(simd, &self.normal[2])];
        let direction = to_instance(simd, placed, &tile.direction, row);
        let approach = dot(&normal, &direction);
        let per_approach = f32x16::splat(simd, 1.0) / approach;
        let t = load_row(simd, &tile.t, row);
        for side in 0..2 {
            let step = if let Some(steps) = steps {
                let step = placed.vector_in_instance(steps[side]).as_vec3().to_array();
                [f32x16::splat(simd, step[0]), f32x16::splat(simd, step[1]), f32x16::splat(simd, step[2])]
            } else {
                to_instance(simd, placed, &tile.steps[side], row)
            };
            let back = dot(&normal, &step) * per_approach;
            let mut moved = step;
            for axis in 0..3 {
                moved[axis] = (step[axis] - direction[axis] * back) * t;
            }
            for axis in 0..2 {
                let [x, y, z] = &self.gradient[axis];
                let change = (load(simd, x) * moved[0] + load(simd, y) * moved[1]) + load(simd, z) * moved[2];
                footprint.steps[side][axis] = change * repeat[axis];
            }
        }
        footprint
    }
}

/// Unit normal, in the view, of a triangle without a texture, computed with the same operations as in
/// [`Surfaces::add`].
pub(super) fn triangle_normal(
    view: &View<'_>,
    (placed, triangles): (&Placed, Triangles),
    local: u32,
) -> [f32; 3] {
    let [x, y, z] = match triangles {
        Triangles::Mesh => kept_normal(view, placed, local),
        Triangles::HeightField => view.height_field_normal(placed, local),
    };
    let mut turned = [0.0; 3];
    for axis in 0..3 {
        let [a, b, c] = [0, 1, 2].map(|row| placed.inverse[row][axis] as f32);
        turned[axis] = (x * a + y * b) + z * c;
    }
    let [x, y, z] = turned;
    let per_length = 1.0 / sqrt_f32((x * x + y * y) + z * z);
    [x * per_length, y * per_length, z * per_length]
}

/// The stored unit normal of a mesh's triangle.
#[inline(always)]
fn kept_normal(view: &View<'_>, placed: &Placed, local: u32) -> [f32; 3] {
    view.scene.facets[placed.first_block as usize * WIDTH + local as usize].normal
}

fn on_height_field(view: &View<'_>, placed: &Placed, local: u32, point: DVec3) -> Surface {
    let [x, y] = view.height_grid(placed).field().size();
    let normal = DVec3::from_array(view.height_field_normal(placed, local).map(f64::from));
    flat(normal, point, [DVec3::X / x, DVec3::Y / y])
}

fn on_triangle(view: &View<'_>, placed: &Placed, local: u32, point: DVec3) -> Surface {
    let scene = &view.scene;
    let mesh = &scene.meshes[placed.mesh as usize];
    let [a, b, c] = view.corners(placed, local);
    let (ab, ac) = (b - a, c - a);
    let normal = ab.cross(ac);
    let squared = normal.length_squared();
    if squared <= 0.0 {
        return flat(normal.normalize_or(DVec3::Z), point, [DVec3::ZERO; 2]);
    }
    // Barycentric coordinates of b and c are linear in the point; these are their gradients.
    let (to_b, to_c) = (ac.cross(normal) / squared, normal.cross(ab) / squared);
    let (beta, gamma) = (to_b.dot(point - a), to_c.dot(point - a));
    let triangle = scene.facets[placed.first_block as usize * WIDTH + local as usize].triangle;
    let uvs = scene.triangles[(mesh.first_triangle + triangle) as usize]
        .map(|vertex| scene.uvs[(mesh.first_vertex + vertex) as usize].map(f64::from));
    let mut surface =
        Surface { normal: normal.normalize_or(DVec3::Z), uv: [0.0; 2], uv_gradient: [DVec3::ZERO; 2] };
    for axis in 0..2 {
        let (along_ab, along_ac) = (uvs[1][axis] - uvs[0][axis], uvs[2][axis] - uvs[0][axis]);
        surface.uv[axis] = uvs[0][axis] + beta * along_ab + gamma * along_ac;
        surface.uv_gradient[axis] = to_b * along_ab + to_c * along_ac;
    }
    surface
}
