//! Meshes and solids with poses and scales.

use super::oracle::{Random, soup, sphere};
use super::{Mesh, around, levels};
use crate::scene::{InstanceConfig, MaterialConfig, SceneBuilder, Shape};
use crate::trace::rays::{Rays, cast_rays, occluded_rays, workspace_len};
use crate::trace::{CacheLine, Faces, Hits, Workspace};
use crate::{Execution, Pose};
use glam::{DQuat, DVec3};

struct Found {
    distance: Vec<f32>,
    normal: Vec<[f32; 3]>,
    instance: Vec<u32>,
    barycentrics: Vec<[f32; 2]>,
}

/// Casts at every level, checks that all give the same bits, and returns the hits.
fn cast(builder: &SceneBuilder, reference: DVec3, rays: &Rays<'_>, faces: Faces) -> Found {
    let scene = builder.scene();
    let mut buffer = vec![CacheLine::ZERO; workspace_len(&scene)];
    let count = rays.directions.len();
    let mut answers = levels().into_iter().map(|level| {
        let mut found = Found {
            distance: vec![0.0; count],
            normal: vec![[0.0; 3]; count],
            instance: vec![0; count],
            barycentrics: vec![[0.0; 2]; count],
        };
        let mut primitive = vec![0; count];
        let mut occluded = vec![false; count];
        let execution = Execution::at(level);
        let mut workspace = Workspace { buffer: &mut buffer, execution };
        let hits = Hits {
            distance: Some(&mut found.distance),
            normal: Some(&mut found.normal),
            instance: Some(&mut found.instance),
            primitive: Some(&mut primitive),
            barycentrics: Some(&mut found.barycentrics),
        };
        cast_rays(&scene, builder.poses(), reference, rays, u32::MAX, faces, &mut workspace, hits)
            .expect("outputs of the right size");
        occluded_rays(
            &scene,
            builder.poses(),
            reference,
            rays,
            u32::MAX,
            faces,
            &mut workspace,
            &mut occluded,
        )
        .expect("outputs of the right size");
        for index in 0..count {
            assert_eq!(occluded[index], found.distance[index].is_finite(), "ray {index}");
            assert_eq!(occluded[index], found.instance[index] != u32::MAX);
            assert_eq!(occluded[index], primitive[index] != u32::MAX);
        }
        found
    });
    let first = answers.next().expect("a level");
    for other in answers {
        assert!(first.distance == other.distance && first.normal == other.normal);
        assert!(first.instance == other.instance && first.barycentrics == other.barycentrics);
    }
    first
}

fn pose(random: &mut Random, spread: f32) -> Pose {
    let [x, y, z] = random.point(spread).map(f64::from);
    let [a, b, c] = random.direction().map(f64::from);
    let turn = DQuat::from_axis_angle(DVec3::new(a, b, c).normalize(), 6.0 * random.unit());
    Pose::new(DVec3::new(x, y, z), turn)
}

fn with_material() -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    builder.add_material(&MaterialConfig::default()).expect("a valid material");
    builder
}

/// Compares meshes in a scene with the oracle, which gets the same triangles in the frame of the reference point.
fn check_meshes(count: usize, reference: DVec3, faces: Faces, turned: bool) {
    let mut random = Random(21 + count as u64);
    let mut builder = with_material();
    let mut all = (Vec::new(), Vec::new());
    for _ in 0..count {
        let (vertices, triangles) = soup(&mut random, 60, 0.5);
        let mesh = builder.add_mesh(&vertices, &[], &triangles).expect("a valid mesh");
        let relative = pose(&mut random, 2.0);
        let (relative, scale) = if turned {
            (relative, [0.5, -1.5, 0.8])
        } else {
            (Pose::from_translation(relative.translation()), [1.0; 3])
        };
        let world = Pose::new(relative.translation() + reference, relative.rotation());
        let config = InstanceConfig {
            shape: Shape::Mesh(mesh),
            world_from_instance: world,
            scale,
            ..Default::default()
        };
        builder.add_instance(&config).expect("a valid instance");
        let first = all.0.len() as u32;
        all.0.extend(vertices.iter().map(|vertex| {
            let scaled = DVec3::from_array([0, 1, 2].map(|axis| f64::from(vertex[axis]) * scale[axis]));
            (world.rotation() * scaled + (world.translation() - reference)).as_vec3().to_array()
        }));
        // A mirrored instance has the opposite winding; its outside stays the outside.
        let mirrored = scale[0] * scale[1] * scale[2] < 0.0;
        all.1.extend(triangles.iter().map(|&[a, b, c]| {
            let [b, c] = if mirrored { [c, b] } else { [b, c] };
            [a + first, b + first, c + first]
        }));
    }
    let oracle = Mesh::new(all);
    let (origins, directions) = around(&mut random, 2000, 3.0);
    let rays = Rays { origins: &origins, directions: &directions, ranges: None };
    let found = cast(&builder, reference, &rays, faces);
    let hits = oracle.compare(&rays, faces, &found.distance, &found.normal, 2e-6);
    assert!(hits > 50, "{hits}");
}

#[test]
fn one_mesh_and_many_with_poses_and_scales() {
    for count in [1, 2, 40] {
        for faces in [Faces::Both, Faces::Front] {
            for turned in [false, true] {
                check_meshes(count, DVec3::ZERO, faces, turned);
            }
        }
    }
}

#[test]
fn a_hundred_kilometres_away() {
    check_meshes(1, DVec3::new(1e5, -7e4, 300.1), Faces::Both, true);
    check_meshes(20, DVec3::new(1e5, -7e4, 300.1), Faces::Both, true);
}

#[test]
fn barycentrics_give_the_point() {
    let (vertices, triangles) = sphere(8, 1.0);
    let mut builder = with_material();
    let mesh = builder.add_mesh(&vertices, &[], &triangles).expect("a valid mesh");
    builder
        .add_instance(&InstanceConfig { shape: Shape::Mesh(mesh), ..Default::default() })
        .expect("a valid instance");
    let (_, directions) = around(&mut Random(22), 200, 1.0);
    let rays = Rays { origins: &[[0.0; 3]], directions: &directions, ranges: None };
    let found = cast(&builder, DVec3::ZERO, &rays, Faces::Both);
    for [b, c] in found.barycentrics {
        assert!(b > -1e-6 && c > -1e-6 && b + c < 1.0 + 1e-6);
    }
}

/// The normal is perpendicular to the plane through the hits of three neighbouring rays.
#[test]
fn normals_of_every_shape_are_across_its_surface() {
    let mut shapes = with_material();
    let heights: Vec<f32> = (0..49_u16).map(|index| (f32::from(index) * 1.3).sin() * 0.3).collect();
    let field = shapes.add_height_field(7, 7, [2.0, 2.0], &heights).expect("a valid field");
    for shape in [
        Shape::Box { size: [1.0, 2.0, 1.5] },
        Shape::Rectangle { size: [2.0, 1.5] },
        Shape::Plane,
        Shape::Sphere { radius: 1.0 },
        Shape::Ellipsoid { radii: [1.0, 0.6, 0.8] },
        Shape::Cylinder { radius: 0.7, length: 1.5 },
        Shape::Capsule { radius: 0.5, length: 1.0 },
        Shape::Cone { radius: 0.8, length: 1.6 },
        Shape::HeightField(field),
    ] {
        let mut builder = shapes.clone();
        let mut random = Random(23);
        let world_from_instance = pose(&mut random, 0.1);
        let config =
            InstanceConfig { shape, world_from_instance, scale: [1.2, 0.9, -1.1], ..Default::default() };
        builder.add_instance(&config).expect("a valid instance");
        let (mut origins, mut directions) = (Vec::new(), Vec::new());
        for _ in 0..500 {
            let origin = random.direction().map(|component| component * 4.0);
            let target = random.point(0.5);
            for _ in 0..3 {
                let near = random.point(1e-3);
                origins.push(origin);
                directions.push([0, 1, 2].map(|axis| target[axis] + near[axis] - origin[axis]));
            }
        }
        let rays = Rays { origins: &origins, directions: &directions, ranges: None };
        let found = cast(&builder, DVec3::ZERO, &rays, Faces::Both);
        let (mut right, mut tried) = (0, 0);
        for first in (0..origins.len()).step_by(3) {
            let t = &found.distance[first..first + 3];
            if t.iter().any(|t| t.is_infinite()) {
                continue;
            }
            let point = |index: usize| {
                let at = |axis: usize| {
                    f64::from(origins[first + index][axis])
                        + f64::from(directions[first + index][axis]) * f64::from(t[index])
                };
                DVec3::new(at(0), at(1), at(2))
            };
            let across = (point(1) - point(0)).cross(point(2) - point(0)).normalize();
            let normal = DVec3::from_array(found.normal[first].map(f64::from));
            assert!((normal.length() - 1.0).abs() < 1e-6, "{shape:?}: {normal}");
            tried += 1;
            right += usize::from(across.dot(normal).abs() > 0.99);
            // Solids are only hit from outside.
            if !matches!(shape, Shape::Rectangle { .. } | Shape::Plane | Shape::HeightField(_)) {
                let direction = DVec3::from_array(directions[first].map(f64::from));
                assert!(normal.dot(direction) < 0.0, "{shape:?}");
            }
        }
        assert!(tried > 100 && right * 100 > tried * 90, "{shape:?}: {right} of {tried}");
    }
}
