//! The surfaces where the rays of a packet have hit: points, normals, and what a pixel covers of a texture.
//!
//! A packet sees few instances, so its surfaces are worked out instance by instance, for all lanes at once; each
//! lane keeps those of its own.

use super::packet::Packet;
use super::shapes::surface::{Surface, flat, solid_surface};
use super::view::{Placed, View};
use crate::scene::tree::WIDTH;
use crate::scene::{
    KIND_BOX, KIND_CAPSULE, KIND_CONE, KIND_CYLINDER, KIND_ELLIPSOID, KIND_HEIGHT_FIELD, KIND_MESH,
    KIND_PLANE, KIND_RECTANGLE, KIND_SPHERE,
};
use crate::simd::{LANES, Lanes, sqrt_f32};
use glam::DVec3;

/// How a ray's direction changes from one pixel to the next, along a row and down a column.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PixelSteps {
    pub(crate) right: DVec3,
    pub(crate) down: DVec3,
}

/// Lane by lane, in the view. Where nothing was hit the normal is 0, and the rest undetermined.
pub(crate) struct Surfaces {
    pub(crate) point: [Lanes<f64>; 3],
    /// Unit, outwards.
    pub(crate) normal: [Lanes<f32>; 3],
    /// Texture coordinates, before the material's repetition. Only on textured instances, as the next.
    pub(crate) uv: [Lanes<f64>; 2],
    /// Change of u and v to the next pixel along the row, and to that down the column.
    pub(crate) footprint: [[Lanes<f32>; 2]; 2],
}

impl Surfaces {
    pub(crate) const fn new() -> Self {
        Self {
            point: [[0.0; LANES]; 3],
            normal: [[0.0; LANES]; 3],
            uv: [[0.0; LANES]; 2],
            footprint: [[[0.0; LANES]; 2]; 2],
        }
    }

    /// Takes the points where the packet has hit; the rest is for [`Surfaces::add`].
    #[inline(always)]
    pub(crate) fn start(&mut self, packet: &Packet) {
        self.normal = [[0.0; LANES]; 3];
        for axis in 0..3 {
            for lane in 0..LANES {
                self.point[axis][lane] =
                    packet.origin[axis][lane] + packet.t[lane] * packet.direction[axis][lane];
            }
        }
    }

    /// Fills in the lanes that have hit `placed`; what belongs to a texture only if there are `steps`.
    #[inline(always)]
    pub(crate) fn add(&mut self, view: &View<'_>, packet: &Packet, placed: u32, steps: Option<&PixelSteps>) {
        if let Some(steps) = steps {
            self.add_kind::<true>(view, packet, placed, steps);
        } else {
            self.add_kind::<false>(
                view,
                packet,
                placed,
                &PixelSteps { right: DVec3::ZERO, down: DVec3::ZERO },
            );
        }
    }

    #[inline(always)]
    fn add_kind<const TEXTURED: bool>(
        &mut self,
        view: &View<'_>,
        packet: &Packet,
        index: u32,
        steps: &PixelSteps,
    ) {
        let instance = view.instance(index);
        let placed = &view.placed[index as usize];
        macro_rules! solid {
            ($kind:expr) => {
                self.add_lanes::<TEXTURED>(
                    packet,
                    index,
                    placed,
                    steps,
                    #[inline(always)]
                    |_, point| solid_surface::<TEXTURED>($kind, instance.size, point),
                )
            };
        }
        match instance.kind {
            KIND_BOX => solid!(KIND_BOX),
            KIND_RECTANGLE => solid!(KIND_RECTANGLE),
            KIND_SPHERE => solid!(KIND_SPHERE),
            KIND_CYLINDER => solid!(KIND_CYLINDER),
            KIND_CAPSULE => solid!(KIND_CAPSULE),
            KIND_PLANE => solid!(KIND_PLANE),
            KIND_ELLIPSOID => solid!(KIND_ELLIPSOID),
            KIND_CONE => solid!(KIND_CONE),
            KIND_HEIGHT_FIELD | KIND_MESH => self.add_lanes::<TEXTURED>(
                packet,
                index,
                placed,
                steps,
                #[inline(always)]
                |lane, point| {
                    // Other lanes may have hit the triangle of something else.
                    if packet.placed[lane] != index {
                        flat(DVec3::Z, point, [DVec3::ZERO; 2])
                    } else if instance.kind == KIND_MESH {
                        on_triangle::<TEXTURED>(view, placed, packet.local[lane], point)
                    } else {
                        on_height_field(view, placed, packet.local[lane], point)
                    }
                },
            ),
            _ => {}
        }
    }

    /// `surface` gives the surface at a point, both in the axes of the instance.
    #[inline(always)]
    fn add_lanes<const TEXTURED: bool>(
        &mut self,
        packet: &Packet,
        index: u32,
        placed: &Placed,
        steps: &PixelSteps,
        surface: impl Fn(usize, DVec3) -> Surface,
    ) {
        let inverse = placed.inverse.map(DVec3::from_array);
        let to_local = |v: DVec3| DVec3::new(inverse[0].dot(v), inverse[1].dot(v), inverse[2].dot(v));
        let mine = |lane: usize| packet.placed[lane] == index;

        // One array a loop, and local arrays between them: what may overlap in memory is not vectorised.
        let mut point = [[0.0; LANES]; 3];
        for axis in 0..3 {
            let [x, y, z] = placed.inverse[axis];
            let [tx, ty, tz] = placed.translation;
            for lane in 0..LANES {
                point[axis][lane] = x * (self.point[0][lane] - tx)
                    + y * (self.point[1][lane] - ty)
                    + z * (self.point[2][lane] - tz);
            }
        }
        // Points and texture coordinates are in double precision, directions and differences in single.
        let mut normal = [[0.0_f32; LANES]; 3];
        let mut uv = [[0.0; LANES]; 2];
        let mut gradient = [[[0.0_f32; LANES]; 3]; 2];
        for lane in 0..LANES {
            let surface = surface(lane, DVec3::new(point[0][lane], point[1][lane], point[2][lane]));
            for axis in 0..3 {
                normal[axis][lane] = surface.normal[axis] as f32;
            }
            if TEXTURED {
                for axis in 0..2 {
                    uv[axis][lane] = surface.uv[axis];
                    gradient[axis][0][lane] = surface.uv_gradient[axis].x as f32;
                    gradient[axis][1][lane] = surface.uv_gradient[axis].y as f32;
                    gradient[axis][2][lane] = surface.uv_gradient[axis].z as f32;
                }
            }
        }
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
            for lane in 0..LANES {
                self.uv[axis][lane] = if mine(lane) { uv[axis][lane] } else { self.uv[axis][lane] };
            }
        }
        // The pixel's footprint: how far the hit moves on the surface's plane from one pixel to the next
        // (Igehy 1999, "Tracing ray differentials").
        let mut direction = [[0.0; LANES]; 3];
        for axis in 0..3 {
            let [x, y, z] = inverse[axis].as_vec3().to_array();
            for lane in 0..LANES {
                direction[axis][lane] = x * packet.direction[0][lane] as f32
                    + y * packet.direction[1][lane] as f32
                    + z * packet.direction[2][lane] as f32;
            }
        }
        let mut per_approach = [0.0; LANES];
        for lane in 0..LANES {
            let approach = normal[0][lane] * direction[0][lane]
                + normal[1][lane] * direction[1][lane]
                + normal[2][lane] * direction[2][lane];
            per_approach[lane] = 1.0 / approach;
        }
        for (side, step) in [to_local(steps.right), to_local(steps.down)].into_iter().enumerate() {
            let [x, y, z] = step.as_vec3().to_array();
            let mut moved = [[0.0; LANES]; 3];
            for lane in 0..LANES {
                let across = normal[0][lane] * x + normal[1][lane] * y + normal[2][lane] * z;
                let back = across * per_approach[lane];
                let t = packet.t[lane] as f32;
                moved[0][lane] = (x - direction[0][lane] * back) * t;
                moved[1][lane] = (y - direction[1][lane] * back) * t;
                moved[2][lane] = (z - direction[2][lane] * back) * t;
            }
            for axis in 0..2 {
                let [x, y, z] = &gradient[axis];
                for lane in 0..LANES {
                    let change =
                        x[lane] * moved[0][lane] + y[lane] * moved[1][lane] + z[lane] * moved[2][lane];
                    let old = self.footprint[side][axis][lane];
                    self.footprint[side][axis][lane] = if mine(lane) { change } else { old };
                }
            }
        }
    }
}

fn on_height_field(view: &View<'_>, placed: &Placed, local: u32, point: DVec3) -> Surface {
    let [a, b, c] = view.corners(placed, local);
    let [x, y] = view.height_grid(placed).field().size();
    let normal = (b - a).cross(c - a).normalize_or(DVec3::Z);
    flat(normal, point, [DVec3::X / x, DVec3::Y / y])
}

fn on_triangle<const TEXTURED: bool>(view: &View<'_>, placed: &Placed, local: u32, point: DVec3) -> Surface {
    let scene = &view.scene;
    let mesh = &scene.meshes[placed.mesh as usize];
    let [a, b, c] = view.corners(placed, local);
    let (ab, ac) = (b - a, c - a);
    let normal = ab.cross(ac);
    let squared = normal.length_squared();
    if !TEXTURED || squared <= 0.0 {
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
