//! The surface where a ray has hit: its normal, and its texture coordinates with their gradients.

use super::frame::Frame;
use super::packet::Packet;
use super::traverse::triangle_corners;
use crate::scene::{KIND_BOX, KIND_CAPSULE, KIND_CYLINDER, KIND_MESH, KIND_RECTANGLE, KIND_SPHERE};
use core::f64::consts::{PI, TAU};
use glam::DVec3;

/// A point of a surface, in the axes of the frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Surface {
    /// Unit, outwards.
    pub(crate) normal: DVec3,
    /// Texture coordinates, before the material's repetition.
    pub(crate) uv: [f64; 2],
    /// Change of u and of v per metre along each axis.
    pub(crate) uv_gradient: [DVec3; 2],
}

/// The surface that `lane` of the packet has hit. The texture coordinates are only worked out if `textured`.
pub(crate) fn surface_at(frame: &Frame<'_>, packet: &Packet, lane: usize, textured: bool) -> Surface {
    let index = packet.placed[lane];
    let instance = frame.instance(index);
    let placed = &frame.placed[index as usize];
    let frame_from_instance = placed.frame_from_instance();
    let point = placed.local_point(packet.point(lane));
    let [a, b, c] = instance.size;
    let local = match instance.kind {
        KIND_BOX => on_box(point, DVec3::new(a, b, c)),
        KIND_RECTANGLE => flat(DVec3::Z, point, [DVec3::X / (2.0 * a), DVec3::Y / (2.0 * b)]),
        KIND_SPHERE => around(point, point / a, [-a, a], textured),
        KIND_CYLINDER => on_cylinder(point, a, b, textured),
        KIND_CAPSULE => {
            let axis_point = DVec3::new(0.0, 0.0, point.z.clamp(-b, b));
            around(point, (point - axis_point) / a, [-b - a, b + a], textured)
        }
        KIND_MESH => on_triangle(frame, packet.triangle[lane], instance.mesh, point, textured),
        _ => flat(DVec3::Z, point, [DVec3::ZERO; 2]),
    };
    Surface {
        normal: frame_from_instance * local.normal,
        uv: local.uv,
        uv_gradient: if textured {
            local.uv_gradient.map(|gradient| frame_from_instance * gradient)
        } else {
            local.uv_gradient
        },
    }
}

/// A flat face centred on the origin of u and v, which run from 0 to 1 over it.
fn flat(normal: DVec3, point: DVec3, uv_gradient: [DVec3; 2]) -> Surface {
    Surface { normal, uv: uv_gradient.map(|gradient| gradient.dot(point) + 0.5), uv_gradient }
}

fn on_box(point: DVec3, half: DVec3) -> Surface {
    // The face is the one that the point is nearest to.
    let depth = half - point.abs();
    let axis = if depth.x <= depth.y && depth.x <= depth.z {
        0
    } else if depth.y <= depth.z {
        1
    } else {
        2
    };
    let sign = 1.0_f64.copysign(point[axis]);
    let (normal, right, up) = match axis {
        0 => (DVec3::X, DVec3::Y * sign, DVec3::Z),
        1 => (DVec3::Y, DVec3::X * -sign, DVec3::Z),
        _ => (DVec3::Z, DVec3::X, DVec3::Y * sign),
    };
    let per_metre = |direction: DVec3| direction / (2.0 * direction.abs().dot(half));
    flat(normal * sign, point, [per_metre(right), per_metre(up)])
}

fn on_cylinder(point: DVec3, radius: f64, half_length: f64, textured: bool) -> Surface {
    let radial = DVec3::new(point.x, point.y, 0.0);
    if half_length - point.z.abs() < radius - radial.length() {
        let sign = 1.0_f64.copysign(point.z);
        let per_metre = 0.5 / radius;
        return flat(DVec3::Z * sign, point, [DVec3::X * per_metre, DVec3::Y * sign * per_metre]);
    }
    around(point, radial / radius, [-half_length, half_length], textured)
}

/// A surface of revolution: u once around from −x, v along z.
fn around(point: DVec3, normal: DVec3, [low, high]: [f64; 2], textured: bool) -> Surface {
    if !textured {
        return flat(normal, point, [DVec3::ZERO; 2]);
    }
    let squared = (point.x * point.x + point.y * point.y).max(1e-12);
    let along = 1.0 / (high - low);
    Surface {
        normal,
        uv: [(libm::atan2(point.y, point.x) + PI) / TAU, (point.z - low) * along],
        uv_gradient: [DVec3::new(-point.y, point.x, 0.0) / (squared * TAU), DVec3::Z * along],
    }
}

fn on_triangle(frame: &Frame<'_>, triangle: u32, mesh: u32, point: DVec3, textured: bool) -> Surface {
    let scene = &frame.scene;
    let mesh = &scene.meshes[mesh as usize];
    let [a, b, c] = triangle_corners(frame, mesh, triangle);
    let (ab, ac) = (b - a, c - a);
    let normal = ab.cross(ac);
    let squared = normal.length_squared();
    if !textured || squared <= 0.0 {
        return flat(normal.normalize_or(DVec3::Z), point, [DVec3::ZERO; 2]);
    }
    // Barycentric coordinates of b and c are linear in the point; these are their gradients.
    let (to_b, to_c) = (ac.cross(normal) / squared, normal.cross(ab) / squared);
    let (beta, gamma) = (to_b.dot(point - a), to_c.dot(point - a));
    let uvs = scene.triangles[triangle as usize]
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
