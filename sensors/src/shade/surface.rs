//! The surfaces where the rays of a tile have hit: normals, and what a pixel covers of a texture. Flat faces have a
//! short cut of their own, [`super::face`].
//!
//! A tile sees few instances, so its surfaces are worked out instance by instance, for all lanes at once; each lane
//! keeps those of its own.

use super::tile::{Steps, Tile};
use crate::scene::{Kind, Solid, Triangles};
use crate::simd::{LANES, Lanes, WIDTH, floor, load_row, sqrt_f32};
use crate::trace::shapes::solid_surface;
use crate::trace::shapes::surface::{Surface, flat};
use crate::trace::view::{Placed, View};
use fearless_simd::{Select, Simd, SimdBase, f32x16, mask32x16};
use glam::DVec3;

/// What the pixels of a row cover of a texture, in its coordinates, repetitions included.
#[derive(Clone, Copy)]
pub(crate) struct Footprint<S: Simd> {
    /// The middle, less whole repetitions.
    pub(crate) uv: [f32x16<S>; 2],
    /// Change of u and v to the next pixel along the row, and to that down the column.
    pub(crate) steps: [[f32x16<S>; 2]; 2],
}

impl<S: Simd> Footprint<S> {
    /// Points at the origin.
    #[inline(always)]
    pub(crate) fn nothing(simd: S) -> Self {
        let zero = f32x16::splat(simd, 0.0);
        Self { uv: [zero; 2], steps: [[zero; 2]; 2] }
    }

    /// Takes those lanes of another that are `mine`.
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

/// Lane by lane, in the view. Where nothing was hit the normal is 0, and the rest undetermined.
pub(crate) struct Surfaces {
    /// Unit, outwards.
    pub(crate) normal: [Lanes<f32>; 3],
    /// Texture coordinates, repeated as the material says, less whole repetitions. Only on textured instances, as the
    /// next.
    uv: [Lanes<f32>; 2],
    /// Change of u and v to the next pixel along the row, and to that down the column.
    footprint: [[Lanes<f32>; 2]; 2],
    /// Change of u and of v per metre, times any factor above 0. Only if it is wanted.
    pub(crate) gradient: [[Lanes<f32>; 3]; 2],
    pub(crate) wants_gradient: bool,
    /// Of the instance at hand.
    local: Local,
}

impl Surfaces {
    pub(crate) const fn new() -> Self {
        Self {
            normal: [[0.0; LANES]; 3],
            uv: [[0.0; LANES]; 2],
            footprint: [[[0.0; LANES]; 2]; 2],
            gradient: [[[0.0; LANES]; 3]; 2],
            wants_gradient: false,
            local: Local {
                normal: [[0.0; LANES]; 3],
                uv: [[0.0; LANES]; 2],
                gradient: [[[0.0; LANES]; 3]; 2],
            },
        }
    }

    /// Of a row of sixteen lanes.
    #[inline(always)]
    pub(crate) fn footprint<S: Simd>(&self, simd: S, row: usize) -> Footprint<S> {
        let [[right_u, right_v], [down_u, down_v]] = &self.footprint;
        Footprint {
            uv: [load_row(simd, &self.uv[0], row), load_row(simd, &self.uv[1], row)],
            steps: [
                [load_row(simd, right_u, row), load_row(simd, right_v, row)],
                [load_row(simd, down_u, row), load_row(simd, down_v, row)],
            ],
        }
    }

    /// Fills in the lanes that have hit `placed`; what belongs to a texture only if it is repeated so often.
    #[inline(always)]
    pub(crate) fn add(
        &mut self,
        view: &View<'_>,
        tile: &Tile,
        (placed, lanes): (u32, u64),
        repeat: Option<[f32; 2]>,
        steps: &Steps,
    ) {
        if let Some(repeat) = repeat {
            self.add_kind::<true>(view, tile, (placed, lanes), repeat, steps);
        } else {
            self.add_kind::<false>(view, tile, (placed, lanes), [1.0; 2], steps);
        }
    }

    #[inline(always)]
    fn add_kind<const TEXTURED: bool>(
        &mut self,
        view: &View<'_>,
        tile: &Tile,
        (index, lanes): (u32, u64),
        repeat: [f32; 2],
        steps: &Steps,
    ) {
        let placed = &view.placed[index as usize];
        if !TEXTURED && let Kind::Triangles(triangles) = placed.kind() {
            self.local.take_normals(view, placed, triangles, &tile.local, lanes);
            self.add_lanes::<TEXTURED>(tile, index, placed, (repeat, steps));
            return;
        }
        // One array a loop, and local arrays between them: what may overlap in memory is not vectorised.
        let mut point = [[0.0; LANES]; 3];
        for axis in 0..3 {
            let [x, y, z] = placed.inverse[axis];
            let [tx, ty, tz] = placed.translation;
            for lane in 0..LANES {
                point[axis][lane] = x * (f64::from(tile.point[0][lane]) - tx)
                    + y * (f64::from(tile.point[1][lane]) - ty)
                    + z * (f64::from(tile.point[2][lane]) - tz);
            }
        }
        if self.local.fill::<TEXTURED>(view, tile, (index, lanes), &point) {
            self.add_lanes::<TEXTURED>(tile, index, placed, (repeat, steps));
        }
    }

    /// Takes what a shape says of its points into the view.
    #[inline(always)]
    fn add_lanes<const TEXTURED: bool>(
        &mut self,
        tile: &Tile,
        index: u32,
        placed: &Placed,
        (repeat, steps): ([f32; 2], &Steps),
    ) {
        let Local { normal, uv, gradient } = &self.local;
        let inverse = placed.inverse.map(DVec3::from_array);
        let to_local = |v: DVec3| DVec3::new(inverse[0].dot(v), inverse[1].dot(v), inverse[2].dot(v));
        let mine = |lane: usize| tile.placed[lane] == index;
        // Normals go by the inverse transpose, and are unit ones again afterwards.
        let mut turned = [[0.0; LANES]; 3];
        for axis in 0..3 {
            let [x, y, z] = inverse.map(|row| row[axis] as f32);
            for lane in 0..LANES {
                turned[axis][lane] = x * normal[0][lane] + y * normal[1][lane] + z * normal[2][lane];
            }
        }
        let mut per_length = [0.0; LANES];
        for lane in 0..LANES {
            let [x, y, z] = [turned[0][lane], turned[1][lane], turned[2][lane]];
            per_length[lane] = 1.0 / sqrt_f32(x * x + y * y + z * z);
        }
        for axis in 0..3 {
            for lane in 0..LANES {
                let unit = turned[axis][lane] * per_length[lane];
                let old = self.normal[axis][lane];
                self.normal[axis][lane] = if mine(lane) { unit } else { old };
            }
        }
        if !TEXTURED {
            return;
        }
        for axis in 0..2 {
            // Whole repetitions are taken away in f64: the rest keeps its digits in f32.
            let repeat = f64::from(repeat[axis]);
            for lane in 0..LANES {
                let coordinate = uv[axis][lane] * repeat;
                let rest = (coordinate - floor(coordinate)) as f32;
                self.uv[axis][lane] = if mine(lane) { rest } else { self.uv[axis][lane] };
            }
        }
        if self.wants_gradient {
            // Gradients go by the inverse transpose, as normals do.
            for side in 0..2 {
                for axis in 0..3 {
                    let [x, y, z] = inverse.map(|row| row[axis] as f32 * repeat[side]);
                    let [along_x, along_y, along_z] = &gradient[side];
                    for lane in 0..LANES {
                        let change = x * along_x[lane] + y * along_y[lane] + z * along_z[lane];
                        let old = self.gradient[side][axis][lane];
                        self.gradient[side][axis][lane] = if mine(lane) { change } else { old };
                    }
                }
            }
        }
        // The pixel's footprint: how far the hit moves on the surface's plane from one pixel to the next
        // (Igehy 1999, "Tracing ray differentials").
        let mut direction = [[0.0; LANES]; 3];
        for axis in 0..3 {
            let [x, y, z] = inverse[axis].as_vec3().to_array();
            for lane in 0..LANES {
                direction[axis][lane] =
                    x * tile.direction[0][lane] + y * tile.direction[1][lane] + z * tile.direction[2][lane];
            }
        }
        let mut per_approach = [0.0; LANES];
        for lane in 0..LANES {
            let approach = normal[0][lane] * direction[0][lane]
                + normal[1][lane] * direction[1][lane]
                + normal[2][lane] * direction[2][lane];
            per_approach[lane] = 1.0 / approach;
        }
        for side in 0..2 {
            let mut step = [[0.0; LANES]; 3];
            if let Some(steps) = steps {
                step = to_local(steps[side]).as_vec3().to_array().map(|step| [step; LANES]);
            } else {
                for axis in 0..3 {
                    let [x, y, z] = inverse[axis].as_vec3().to_array();
                    let [steps_x, steps_y, steps_z] = &tile.steps[side];
                    for lane in 0..LANES {
                        step[axis][lane] = x * steps_x[lane] + y * steps_y[lane] + z * steps_z[lane];
                    }
                }
            }
            let mut moved = [[0.0; LANES]; 3];
            for lane in 0..LANES {
                let [x, y, z] = [step[0][lane], step[1][lane], step[2][lane]];
                let across = normal[0][lane] * x + normal[1][lane] * y + normal[2][lane] * z;
                let back = across * per_approach[lane];
                let t = tile.t[lane];
                moved[0][lane] = (x - direction[0][lane] * back) * t;
                moved[1][lane] = (y - direction[1][lane] * back) * t;
                moved[2][lane] = (z - direction[2][lane] * back) * t;
            }
            for axis in 0..2 {
                let [x, y, z] = &gradient[axis];
                for lane in 0..LANES {
                    let change =
                        (x[lane] * moved[0][lane] + y[lane] * moved[1][lane] + z[lane] * moved[2][lane])
                            * repeat[axis];
                    let old = self.footprint[side][axis][lane];
                    self.footprint[side][axis][lane] = if mine(lane) { change } else { old };
                }
            }
        }
    }
}

/// What the shape of an instance says of points, lane by lane, in the axes of the instance: directions and differences in
/// single precision, texture coordinates in double.
struct Local {
    normal: [Lanes<f32>; 3],
    uv: [Lanes<f64>; 2],
    gradient: [[Lanes<f32>; 3]; 2],
}

impl Local {
    /// Of the lanes that have hit `index`; the others are undetermined. Not for shapes of flat faces.
    #[inline(always)]
    fn fill<const TEXTURED: bool>(
        &mut self,
        view: &View<'_>,
        tile: &Tile,
        (index, lanes): (u32, u64),
        point: &[Lanes<f64>; 3],
    ) -> bool {
        let instance = view.instance(index);
        let placed = &view.placed[index as usize];
        macro_rules! solid {
            ($solid:expr) => {
                self.take::<TEXTURED>(
                    point,
                    #[inline(always)]
                    |point| solid_surface::<TEXTURED>($solid, instance.size, point),
                )
            };
        }
        match placed.kind() {
            Kind::Solid(Solid::Sphere) => solid!(Solid::Sphere),
            Kind::Solid(Solid::Cylinder) => solid!(Solid::Cylinder),
            Kind::Solid(Solid::Capsule) => solid!(Solid::Capsule),
            Kind::Solid(Solid::Ellipsoid) => solid!(Solid::Ellipsoid),
            Kind::Solid(Solid::Cone) => solid!(Solid::Cone),
            Kind::Solid(Solid::Box | Solid::Rectangle | Solid::Plane) => return false,
            Kind::Triangles(triangles) => {
                let mut rest = lanes;
                while rest != 0 {
                    let lane = rest.trailing_zeros() as usize % LANES;
                    rest &= rest - 1;
                    let (point, local) =
                        (DVec3::from_array([0, 1, 2].map(|axis| point[axis][lane])), tile.local[lane]);
                    let surface = match triangles {
                        Triangles::Mesh => on_triangle(view, placed, local, point),
                        Triangles::HeightField => on_height_field(view, placed, local, point),
                    };
                    self.put::<TEXTURED>(lane, &surface);
                }
            }
        }
        true
    }

    #[inline(always)]
    fn take<const TEXTURED: bool>(&mut self, point: &[Lanes<f64>; 3], surface: impl Fn(DVec3) -> Surface) {
        for lane in 0..LANES {
            let surface = surface(DVec3::new(point[0][lane], point[1][lane], point[2][lane]));
            self.put::<TEXTURED>(lane, &surface);
        }
    }

    #[inline(always)]
    fn put<const TEXTURED: bool>(&mut self, lane: usize, surface: &Surface) {
        for axis in 0..3 {
            self.normal[axis][lane] = surface.normal[axis] as f32;
        }
        if TEXTURED {
            for axis in 0..2 {
                self.uv[axis][lane] = surface.uv[axis];
                self.gradient[axis][0][lane] = surface.uv_gradient[axis].x as f32;
                self.gradient[axis][1][lane] = surface.uv_gradient[axis].y as f32;
                self.gradient[axis][2][lane] = surface.uv_gradient[axis].z as f32;
            }
        }
    }

    /// Normals of triangles, for the lanes of some bits. Those of meshes are kept, and nothing else depends on the point.
    #[inline(always)]
    fn take_normals(
        &mut self,
        view: &View<'_>,
        placed: &Placed,
        triangles: Triangles,
        local: &Lanes<u32>,
        lanes: u64,
    ) {
        let first = placed.first_block as usize * WIDTH;
        // Neighbours most often lie on the same triangle.
        let mut last = (u32::MAX, [0.0; 3]);
        let mut rest = lanes;
        while rest != 0 {
            let lane = rest.trailing_zeros() as usize % LANES;
            rest &= rest - 1;
            let normal = match triangles {
                Triangles::Mesh => view.scene.facets[first + local[lane] as usize].normal,
                Triangles::HeightField => {
                    if last.0 != local[lane] {
                        last = (local[lane], normal_of(view, placed, local[lane]).as_vec3().to_array());
                    }
                    last.1
                }
            };
            for axis in 0..3 {
                self.normal[axis][lane] = normal[axis];
            }
        }
    }
}

/// Unit normal of a height field's triangle.
fn normal_of(view: &View<'_>, placed: &Placed, local: u32) -> DVec3 {
    let [a, b, c] = view.corners(placed, local);
    (b - a).cross(c - a).normalize_or(DVec3::Z)
}

fn on_height_field(view: &View<'_>, placed: &Placed, local: u32, point: DVec3) -> Surface {
    let [x, y] = view.height_grid(placed).field().size();
    flat(normal_of(view, placed, local), point, [DVec3::X / x, DVec3::Y / y])
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
