//! An oracle for the first hit of a ray on a shape: elementary geometry in f64, one surface at a time, independent of
//! the library's kernels.

use belvedere_sensors::Pose;
use belvedere_sensors::camera::CameraConfig;
use belvedere_sensors::scene::Shape;
use glam::DVec3;

/// A ray p(t) = origin + t·direction.
#[derive(Clone, Copy)]
pub(crate) struct Ray {
    pub(crate) origin: DVec3,
    pub(crate) direction: DVec3,
}

impl Ray {
    fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }

    fn local(&self, world_from_shape: &Pose, scale: DVec3) -> Self {
        let shape_from_world = world_from_shape.rotation().inverse();
        Self {
            origin: shape_from_world * (self.origin - world_from_shape.translation()) / scale,
            direction: shape_from_world * self.direction / scale,
        }
    }
}

/// The ray of a camera's pixel, for which t is the depth.
pub(crate) fn pixel_ray(camera: &CameraConfig<'_>, pose: &Pose, column: u32, row: u32) -> Ray {
    ray_at(camera, pose, [column, row].map(f64::from))
}

/// The ray through a point between pixel centres.
pub(crate) fn ray_at(camera: &CameraConfig<'_>, pose: &Pose, [column, row]: [f64; 2]) -> Ray {
    let lens = super::pinhole(camera).intrinsics();
    let (right, down) = (column - lens.cx, row - lens.cy);
    let direction = pose.rotation() * DVec3::new(1.0, -right / lens.fx, -down / lens.fy);
    Ray { origin: pose.translation(), direction }
}

/// t of a point of a shape's surface on a ray, and the outward normal there.
pub(crate) type Candidate = (f64, DVec3);

/// The least t ≥ `t_min` at which the ray hits the shape's surface, from outside only unless `both` sides count. Meshes
/// have no formula.
pub(crate) fn first_hit(shape: &Shape, pose: &Pose, ray: &Ray, t_min: f64, both: bool) -> Option<f64> {
    first_hit_scaled(shape, pose, DVec3::ONE, ray, t_min, both)
}

/// The same for a shape that is scaled along its own axes.
pub(crate) fn first_hit_scaled(
    shape: &Shape,
    pose: &Pose,
    scale: DVec3,
    ray: &Ray,
    t_min: f64,
    both: bool,
) -> Option<f64> {
    first_surface(shape, pose, scale, ray, t_min, both).map(|(t, _)| t)
}

/// The same, with the outward unit normal there in the world.
pub(crate) fn first_surface(
    shape: &Shape,
    pose: &Pose,
    scale: DVec3,
    ray: &Ray,
    t_min: f64,
    both: bool,
) -> Option<Candidate> {
    let ray = ray.local(pose, scale);
    let candidates = match *shape {
        Shape::Box { size } => box_faces(&ray, DVec3::from_array(size) / 2.0),
        Shape::Rectangle { size } => {
            let within = |p: DVec3| p.x.abs() <= size[0] / 2.0 && p.y.abs() <= size[1] / 2.0;
            plane(&ray, DVec3::Z, 0.0, within).into_iter().collect()
        }
        Shape::Sphere { radius } => ball(&ray, DVec3::ZERO, radius),
        Shape::Cylinder { radius, length } => {
            let disc = |p: DVec3| p.x.hypot(p.y) <= radius;
            let ends = [DVec3::Z, DVec3::NEG_Z].map(|normal| plane(&ray, normal, length / 2.0, disc));
            tube(&ray, radius, length).into_iter().chain(ends.into_iter().flatten()).collect()
        }
        Shape::Capsule { radius, length } => {
            let end = DVec3::Z * (length / 2.0);
            let caps = [end, -end].into_iter().flat_map(|centre| {
                let beyond =
                    move |(t, _): &Candidate, ray: Ray| ray.at(*t).z * centre.z.signum() >= length / 2.0;
                ball(&ray, centre, radius).into_iter().filter(move |hit| beyond(hit, ray))
            });
            tube(&ray, radius, length).into_iter().chain(caps).collect()
        }
        Shape::Plane => plane(&ray, DVec3::Z, 0.0, |_| true).into_iter().collect(),
        Shape::Ellipsoid { radii } => {
            let radii = DVec3::from_array(radii);
            let stretched = Ray { origin: ray.origin / radii, direction: ray.direction / radii };
            ball(&stretched, DVec3::ZERO, 1.0).into_iter().map(|(t, normal)| (t, normal / radii)).collect()
        }
        Shape::Cone { radius, length } => {
            let disc = |p: DVec3| p.x.hypot(p.y) <= radius;
            let base = plane(&ray, DVec3::NEG_Z, length / 2.0, disc);
            mantle(&ray, radius, length).into_iter().chain(base).collect()
        }
        Shape::Mesh(_) | Shape::HeightField(_) => unreachable!("triangles have no formula"),
    };
    candidates
        .into_iter()
        .filter(|(t, normal)| *t >= t_min && (both || normal.dot(ray.direction) < 0.0))
        .min_by(|(a, _), (b, _)| a.total_cmp(b))
        // Normals are transformed by the inverse transpose.
        .map(|(t, normal)| (t, (pose.rotation() * (normal / scale)).normalize()))
}

/// The shape with all lengths multiplied by a factor.
pub(crate) fn scaled(shape: &Shape, factor: f64) -> Shape {
    match *shape {
        Shape::Box { size } => Shape::Box { size: size.map(|edge| edge * factor) },
        Shape::Rectangle { size } => Shape::Rectangle { size: size.map(|edge| edge * factor) },
        Shape::Sphere { radius } => Shape::Sphere { radius: radius * factor },
        Shape::Cylinder { radius, length } => {
            Shape::Cylinder { radius: radius * factor, length: length * factor }
        }
        Shape::Capsule { radius, length } => {
            Shape::Capsule { radius: radius * factor, length: length * factor }
        }
        Shape::Plane => Shape::Plane,
        Shape::Ellipsoid { radii } => Shape::Ellipsoid { radii: radii.map(|radius| radius * factor) },
        Shape::Cone { radius, length } => Shape::Cone { radius: radius * factor, length: length * factor },
        Shape::Mesh(_) | Shape::HeightField(_) => *shape,
    }
}

/// The part of the plane normal·p = offset where `within` holds.
fn plane(ray: &Ray, normal: DVec3, offset: f64, within: impl Fn(DVec3) -> bool) -> Option<Candidate> {
    let t = (offset - normal.dot(ray.origin)) / normal.dot(ray.direction);
    (t.is_finite() && within(ray.at(t))).then_some((t, normal))
}

fn box_faces(ray: &Ray, half: DVec3) -> Vec<Candidate> {
    (0..6)
        .filter_map(|face| {
            let (axis, sign) = (face / 2, if face % 2 == 0 { 1.0 } else { -1.0 });
            let mut normal = DVec3::ZERO;
            normal[axis] = sign;
            plane(ray, normal, half[axis], |p| (0..3).all(|a| a == axis || p[a].abs() <= half[a]))
        })
        .collect()
}

/// By Pythagoras: half a chord back and forth from the ray's point nearest to the centre.
fn ball(ray: &Ray, centre: DVec3, radius: f64) -> Vec<Candidate> {
    let speed = ray.direction.length();
    let ahead = ray.direction / speed;
    let nearest = ahead.dot(centre - ray.origin);
    let miss = (ray.origin + ahead * nearest - centre).length();
    if miss > radius {
        return vec![];
    }
    let half_chord = ((radius - miss) * (radius + miss)).sqrt();
    [nearest - half_chord, nearest + half_chord]
        .map(|distance| (distance / speed, (ray.origin + ahead * distance - centre) / radius))
        .into()
}

/// The side of a cylinder: a circle in the plane across, then the height there.
fn tube(ray: &Ray, radius: f64, length: f64) -> Vec<Candidate> {
    let (origin, direction) = (ray.origin.truncate(), ray.direction.truncate());
    let speed = direction.length();
    let ahead = direction / speed;
    let nearest = -ahead.dot(origin);
    let miss = ahead.perp_dot(origin).abs();
    if speed == 0.0 || miss > radius {
        return vec![];
    }
    let half_chord = ((radius - miss) * (radius + miss)).sqrt();
    [nearest - half_chord, nearest + half_chord]
        .into_iter()
        .map(|distance| (distance / speed, ((origin + ahead * distance) / radius).extend(0.0)))
        .filter(|(t, _)| ray.at(*t).z.abs() <= length / 2.0)
        .collect()
}

/// The side of a cone, by bisection: f(t) = ρ − (radius at that height) is convex along a ray, because it is the sum of
/// the convex distance to the axis and a linear function.
fn mantle(ray: &Ray, radius: f64, length: f64) -> Vec<Candidate> {
    let slope = radius / length;
    let outside = |t: f64| {
        let p = ray.at(t);
        p.x.hypot(p.y) - slope * (length / 2.0 - p.z)
    };
    // The interval in which the ray is inside the ball around the cone; beyond it there are no hits.
    let ends = ball(ray, DVec3::ZERO, radius.max(length));
    let [(start, _), (end, _)] = ends[..] else { return vec![] };
    let rises = |t: f64| {
        let p = ray.at(t);
        p.x * ray.direction.x + p.y * ray.direction.y + slope * ray.direction.z * p.x.hypot(p.y) > 0.0
    };
    let (mut low, mut high) = (start, end);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if rises(middle) { high = middle } else { low = middle }
    }
    let least = low;
    if outside(least) > 0.0 {
        return vec![];
    }
    [start, end]
        .into_iter()
        .filter(|far| outside(*far) > 0.0)
        .map(|far| {
            let (mut inner, mut outer) = (least, far);
            for _ in 0..60 {
                let middle = 0.5 * (inner + outer);
                if outside(middle) > 0.0 { outer = middle } else { inner = middle }
            }
            let p = ray.at(inner);
            (inner, (p.truncate().normalize_or_zero() * length).extend(radius))
        })
        .filter(|(t, _)| ray.at(*t).z.abs() <= length / 2.0)
        .collect()
}
