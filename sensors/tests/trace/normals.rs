//! Normals of solids against closed forms: of every shape, scaled and rotated, from far away and from very near.

use crate::common::oracle::{first_surface, ray_at};
use crate::common::{camera_of, look_at};
use belvedere_sensors::camera::{Camera, Picture};
use belvedere_sensors::scene::{InstanceConfig, MaterialConfig, SceneBuilder, Shape};
use belvedere_sensors::trace::{Truth, WorkspaceBuf};
use belvedere_sensors::{Capture, Pose, Sensor};
use glam::{DVec3, Vec3};

const SIZE: [u32; 2] = [120, 90];
/// A normal is as accurate as the ray: it may be that of a ray displaced by this many pixels …
const BESIDE: f64 = 1e-3;
/// … and has this rounding error.
const ROUNDING: f64 = 3e-6;

const SHAPES: [Shape; 8] = [
    Shape::Plane,
    Shape::Rectangle { size: [1.5, 1.0] },
    Shape::Box { size: [1.0, 0.75, 0.5] },
    Shape::Sphere { radius: 0.5 },
    Shape::Ellipsoid { radii: [0.5, 0.4, 0.2] },
    Shape::Cylinder { radius: 0.25, length: 1.0 },
    Shape::Capsule { radius: 0.25, length: 0.5 },
    Shape::Cone { radius: 0.4, length: 0.8 },
];

/// The number of compared pixels of the shape, and the largest error of a normal that a displaced ray does not explain.
fn compare(shape: Shape, scale: DVec3, pose: Pose, view: Pose) -> (usize, f64) {
    let mut builder = SceneBuilder::new();
    let material = builder.add_material(&MaterialConfig::default()).unwrap();
    let instance = InstanceConfig {
        shape,
        scale: scale.to_array(),
        world_from_instance: pose,
        material,
        ..Default::default()
    };
    builder.add_instance(&instance).unwrap();
    let config = camera_of(SIZE, 1.2).near_m(1e-6);
    let camera = Camera::new(config).unwrap();
    let mut normals = vec![[7.0; 3]; (SIZE[0] * SIZE[1]) as usize];
    let scene = builder.scene();
    let capture = Capture::new(0, builder.moment(view));
    let mut memory = WorkspaceBuf::default();
    let truth = Truth::new().normal(&mut normals);
    camera.sense_in(&mut memory, &scene, &capture, Picture::new().truth(truth)).unwrap();

    let (mut compared, mut worst) = (0, 0.0_f64);
    for (pixel, &found) in normals.iter().enumerate() {
        let at = [pixel % SIZE[0] as usize, pixel / SIZE[0] as usize].map(|at| at as f64);
        let normal = |[x, y]: [f64; 2]| {
            let ray = ray_at(&config, &view, [at[0] + x, at[1] + y]);
            let (t, normal) = first_surface(&shape, &pose, scale, &ray, config.near_m, false)?;
            (t < 0.999 * config.far_m).then_some(normal)
        };
        let around = [[BESIDE, 0.0], [-BESIDE, 0.0], [0.0, BESIDE], [0.0, -BESIDE]].map(normal);
        // At the outline, either result is correct.
        let (Some(expected), [Some(a), Some(b), Some(c), Some(d)]) = (normal([0.0; 2]), around) else {
            continue;
        };
        let spread = [a, b, c, d].map(|other| other.distance(expected)).into_iter().fold(0.0, f64::max);
        let found = Vec3::from_array(found).as_dvec3();
        assert!((found.length() - 1.0).abs() < 1e-6, "{shape:?}: a normal {found}");
        worst = worst.max(found.distance(expected) - spread);
        compared += 1;
    }
    (compared, worst)
}

#[test]
fn normals_are_those_of_closed_form() {
    let pose = Pose::from_xyz_rpy(DVec3::new(0.3, -0.2, 0.4), DVec3::new(0.5, -0.3, 1.1));
    for shape in SHAPES {
        for scale in [DVec3::ONE, DVec3::new(0.9, -0.6, 1.1), DVec3::new(1e-3, 1e-3, 1e-3)] {
            for away in [0.9, 4.0] {
                for side in
                    [DVec3::new(1.2, 0.9, 0.7), DVec3::new(-0.5, -1.0, 1.1), DVec3::new(0.2, 0.9, -1.3)]
                {
                    let size = scale.abs().max_element();
                    let eye = pose.translation() + side.normalize() * (size * away);
                    let view = look_at(eye, pose.translation(), 0.4);
                    let (compared, worst) = compare(shape, scale, pose, view);
                    assert!(worst < ROUNDING, "{shape:?} × {scale}, {away} from {side}: {worst} off");
                    let is_flat = matches!(shape, Shape::Plane | Shape::Rectangle { .. });
                    assert!(compared > 50 || is_flat, "{shape:?} × {scale}: {compared} pixels");
                }
            }
        }
    }
}
