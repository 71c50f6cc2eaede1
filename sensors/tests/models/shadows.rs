//! Meshes and height fields in low light: there is no shadow where nothing blocks the light, and every shadow where
//! something does.

use crate::common;

use crate::common::oracle::pixel_ray;
use crate::common::{SIZE, add, camera, camera_of, look_at, picture};
use belvedere_sensors::Pose;
use belvedere_sensors::camera::CameraConfig;
use belvedere_sensors::scene::{
    Environment, LightConfig, LightKind, MaterialConfig, MaterialId, SceneBuilder, Shape,
};
use core::fmt::Write;
use glam::DVec3;

const CELLS: u32 = 48;
fn small() -> CameraConfig<'static> {
    camera_of([96, 72], 0.7)
}

/// A floor through the origin, and its unit normal.
struct Floor {
    builder: SceneBuilder,
    pose: Pose,
    normal: DVec3,
    half: f64,
}

fn white(builder: &mut SceneBuilder) -> MaterialId {
    builder.set_environment(Environment { ambient: [0.0; 3], background: [0.0; 3] });
    let config = MaterialConfig { diffuse: [1.0; 3], ambient: [0.0; 3], ..MaterialConfig::default() };
    builder.add_material(&config).unwrap()
}

/// The corners and triangles of a square grid of heights, with rows along x.
fn grid_mesh(half: f64, height: impl Fn(f64, f64) -> f64) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let at = |index: u32| (f64::from(index) / f64::from(CELLS) * 2.0 - 1.0) * half;
    let mut corners = Vec::new();
    for row in 0..=CELLS {
        for column in 0..=CELLS {
            let (x, y) = (at(column), at(row));
            corners.push([x as f32, y as f32, height(x, y) as f32]);
        }
    }
    let mut triangles = Vec::new();
    for row in 0..CELLS {
        for column in 0..CELLS {
            let a = row * (CELLS + 1) + column;
            let (b, c, d) = (a + 1, a + CELLS + 2, a + CELLS + 1);
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    (corners, triangles)
}

/// Floors of one mesh or height field: level, rotated by their pose, and sloped by their corners.
fn floors(half: f64) -> Vec<Floor> {
    let turned = Pose::from_xyz_rpy(DVec3::ZERO, DVec3::new(0.2, -0.3, 0.7));
    let slope = [0.11, -0.07];
    let mut floors = Vec::new();
    for (pose, [along, across]) in
        [(Pose::IDENTITY, [0.0; 2]), (turned, [0.0; 2]), (Pose::IDENTITY, slope), (turned, slope)]
    {
        for is_mesh in [true, false] {
            let mut builder = SceneBuilder::new();
            let material = white(&mut builder);
            let height = |x: f64, y: f64| along * x + across * y;
            let (corners, triangles) = grid_mesh(half, height);
            let shape = if is_mesh {
                Shape::Mesh(builder.add_mesh(&corners, &[], &triangles).unwrap())
            } else {
                // Rows of heights run down from the top, at y = half.
                let heights: Vec<_> = corners
                    .chunks((CELLS + 1) as usize)
                    .rev()
                    .flat_map(|row| row.iter().map(|corner| corner[2]))
                    .collect();
                let size = [2.0 * half; 2];
                Shape::HeightField(builder.add_height_field(CELLS + 1, CELLS + 1, size, &heights).unwrap())
            };
            add(&mut builder, shape, pose, material);
            let normal = pose.transform_vector(DVec3::new(-along, -across, 1.0).normalize());
            floors.push(Floor { builder, pose, normal, half });
        }
    }
    floors
}

/// The number of grey levels of a picture of an evenly lit floor, and the number of wrong ones.
fn count(floor: &Floor, camera: &CameraConfig, view: &Pose, brightness: impl Fn(DVec3) -> f64) -> [usize; 2] {
    let pixels = picture(&floor.builder, *camera, *view);
    let mut counts = [0; 2];
    for (index, pixel) in pixels.as_chunks::<3>().0.iter().enumerate() {
        let [width, _] = common::pinhole(camera).size();
        let ray = pixel_ray(camera, view, index as u32 % width, index as u32 / width);
        let t = -ray.origin.dot(floor.normal) / ray.direction.dot(floor.normal);
        let point = ray.origin + ray.direction * t;
        let local = floor.pose.inverse().transform_point(point);
        // Points that are seen from farther than a hundred metres are not checked.
        let inside = local.x.abs().max(local.y.abs()) < 0.99 * floor.half;
        if t <= 0.0 || !inside || t > 100.0 {
            continue;
        }
        counts[0] += 1;
        let expected = 255.0 * brightness(point);
        counts[1] += usize::from((f64::from(pixel[0]) - expected).abs() > 2.0);
    }
    counts
}

#[test]
fn floors_are_lit_however_low_the_lamp_is() {
    let mut worst = String::new();
    let mut all = [0; 2];
    for distance in [1.0, 3.0, 10.0, 30.0, 100.0] {
        for mut floor in floors(2.0 * distance) {
            let (u, v) = floor.normal.any_orthonormal_pair();
            for (number, elevation_deg) in [0.5_f64, 1.0, 2.0, 5.0, 20.0, 60.0, 90.0].into_iter().enumerate()
            {
                let (sin, cos) = elevation_deg.to_radians().sin_cos();
                let (turn, turned) = (1.0 + number as f64).sin_cos();
                let towards = (u * turned + v * turn) * cos + floor.normal * sin;
                let gain = 0.5 / sin;
                for far in [None, Some(3.0 * distance)] {
                    let kind = match far {
                        None => LightKind::Directional { direction: (-towards).to_array() },
                        Some(far) => LightKind::Point { position: (towards * far).to_array() },
                    };
                    let mut builder = floor.builder.clone();
                    builder
                        .add_light(&LightConfig {
                            kind,
                            diffuse: [gain as f32; 3],
                            cast_shadows: true,
                            ..Default::default()
                        })
                        .unwrap();
                    let bare = core::mem::replace(&mut floor.builder, builder);
                    for look_deg in [8.0_f64, 40.0] {
                        let (rise, level) = look_deg.to_radians().sin_cos();
                        let eye = (u * level + floor.normal * rise) * distance;
                        let counts = count(&floor, &small(), &look_at(eye, DVec3::ZERO, 0.3), |point| {
                            let cosine =
                                far.map_or(sin, |far| (towards * far - point).normalize().dot(floor.normal));
                            (gain * cosine).clamp(0.0, 1.0)
                        });
                        assert!(counts[0] > 1000, "{counts:?}");
                        all = [all[0] + counts[0], all[1] + counts[1]];
                        if counts[1] > 0 && worst.lines().count() < 40 {
                            writeln!(worst, "{counts:?} at {distance} m, lamp {elevation_deg}° high, {far:?}, seen at {look_deg}°").unwrap();
                        }
                    }
                    floor.builder = bare;
                }
            }
        }
    }
    assert_eq!(all[1], 0, "of {} pixels are wrong:\n{worst}", all[0]);
}

/// A box as a mesh, wound outwards unless it is `inwards`.
fn box_mesh(half: [f32; 3], centre: [f32; 3], inwards: bool, first: u32) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let corners = (0..8_u32)
        .map(|index| {
            core::array::from_fn(|axis| {
                centre[axis] + if index >> axis & 1 == 1 { half[axis] } else { -half[axis] }
            })
        })
        .collect();
    let quads: [[u32; 4]; 6] =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let mut triangles = Vec::new();
    for [a, b, c, d] in quads {
        for [a, b, c] in [[a, b, c], [a, c, d]] {
            let [b, c] = if inwards { [c, b] } else { [b, c] };
            triangles.push([a + first, b + first, c + first]);
        }
    }
    (corners, triangles)
}

#[test]
fn a_step_of_a_millimetre_casts_a_shadow_from_its_foot_on() {
    let height = 1e-3;
    for own_mesh in [false, true] {
        for far in [None, Some(4.0)] {
            let mut builder = SceneBuilder::new();
            let material = white(&mut builder);
            let (mut corners, mut triangles) = grid_mesh(4.0, |_, _| 0.0);
            let step = box_mesh([0.1, 0.1, 5e-4], [0.0, 0.0, 5e-4], false, corners.len() as u32);
            if own_mesh {
                corners.extend(step.0);
                triangles.extend(step.1);
            } else {
                let pose = Pose::from_translation(DVec3::Z * 0.5 * height);
                add(&mut builder, Shape::Box { size: [0.2, 0.2, height] }, pose, material);
            }
            let mesh = builder.add_mesh(&corners, &[], &triangles).unwrap();
            add(&mut builder, Shape::Mesh(mesh), Pose::IDENTITY, material);
            // From the left, two degrees high.
            let (sin, cos) = 2_f64.to_radians().sin_cos();
            let towards = DVec3::new(-cos, 0.0, sin);
            let kind = match far {
                None => LightKind::Directional { direction: (-towards).to_array() },
                Some(far) => LightKind::Point { position: (towards * far).to_array() },
            };
            builder
                .add_light(&LightConfig {
                    kind,
                    diffuse: [20.0; 3],
                    cast_shadows: true,
                    ..Default::default()
                })
                .unwrap();
            let view = look_at(DVec3::new(0.25, -0.02, 0.3), DVec3::new(0.11, 0.0, 0.0), 0.0);
            let camera = camera_of(SIZE, 0.3);
            let pixels = picture(&builder, camera, view);
            let (mut dark, mut lit) = (0, 0);
            for (index, pixel) in pixels.as_chunks::<3>().0.iter().enumerate() {
                let ray = pixel_ray(&camera, &view, index as u32 % SIZE[0], index as u32 / SIZE[0]);
                let point = ray.origin - ray.direction * (ray.origin.z / ray.direction.z);
                // The height at which light passes over the far edge, which shades the floor behind it.
                let lamp = far.map_or(towards * 1e9, |far| towards * far);
                let slope = lamp.z / (point.x - lamp.x);
                let over = (point.x - 0.1) * slope;
                let beside = point.y + (lamp.y - point.y) * (point.x - 0.1) / (point.x - lamp.x);
                if point.x < 0.1001 || beside.abs() > 0.099 || (over - height).abs() < 1e-5 {
                    continue;
                }
                let expected = over > height;
                assert_eq!(pixel[0] > 50, expected, "{pixel:?} at {point}, own mesh {own_mesh}, {far:?}");
                if expected { lit += 1 } else { dark += 1 }
            }
            assert!(dark > 10_000 && lit > 10_000, "{dark} dark, {lit} lit");
        }
    }
}

#[test]
fn no_light_comes_into_a_closed_room() {
    for thickness in [0.1, 1e-3] {
        let mut builder = SceneBuilder::new();
        let material = white(&mut builder);
        let inner = [3.0, 2.0, 1.5];
        let outer = inner.map(|half| half + thickness);
        let (mut corners, mut triangles) = box_mesh(inner, [0.0; 3], true, 0);
        let outside = box_mesh(outer, [0.0; 3], false, 8);
        corners.extend(outside.0);
        triangles.extend(outside.1);
        let mesh = builder.add_mesh(&corners, &[], &triangles).unwrap();
        let pose = Pose::from_xyz_rpy(DVec3::new(20.0, -7.0, 3.0), DVec3::new(0.1, 0.2, 0.3));
        add(&mut builder, Shape::Mesh(mesh), pose, material);
        for towards in [DVec3::X, DVec3::new(1.0, 1.0, 0.03), DVec3::new(-1.0, 0.4, 0.9), DVec3::NEG_Y] {
            let towards = pose.transform_vector(towards.normalize());
            for kind in [
                LightKind::Directional { direction: (-towards).to_array() },
                LightKind::Point { position: (pose.translation() + towards * 30.0).to_array() },
            ] {
                builder
                    .add_light(&LightConfig {
                        kind,
                        diffuse: [100.0; 3],
                        cast_shadows: true,
                        ..Default::default()
                    })
                    .unwrap();
            }
        }
        for corner in 0..8 {
            let sign = |axis: u32| if corner >> axis & 1 == 1 { 1.0 } else { -1.0 };
            let target = DVec3::new(3.0 * sign(0), 2.0 * sign(1), 1.5 * sign(2));
            let view = look_at(pose.transform_point(target * -0.8), pose.transform_point(target), 0.0);
            let pixels = picture(&builder, camera(), view);
            let lit = pixels.iter().filter(|&&level| level > 0).count();
            assert_eq!(lit, 0, "corner {target}, walls of {thickness} m");
        }
    }
}
