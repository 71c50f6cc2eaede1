//! Shapes of parry3d: the hits agree with those that parry3d itself finds in double precision, ray by ray.
#![cfg(feature = "parry")]

use crate::common::{LIDAR, look_at, scan};
use belvedere_sensors::Pose;
use belvedere_sensors::lidar::Beams;
use belvedere_sensors::parry::ParryError;
use belvedere_sensors::scene::{InstanceConfig, MaterialConfig, SceneBuilder, SceneError, Shape as Kind};
use belvedere_sensors::simd::WIDTH;
use glam::{DQuat, DVec3, Quat, Vec3};
use parry3d::math::Pose as Pose32;
use parry3d::shape as single;
use parry3d_f64::math::Pose as Pose64;
use parry3d_f64::query::Ray;
use parry3d_f64::shape as double;

/// A range may be anywhere between those of the shape enlarged and shrunk by this fraction: at edges and silhouettes,
/// and where a ray grazes a cylinder, cone or polyhedron, whose surface parry3d's own search (GJK) finds to 1e-8 of its
/// size.
const EDGE: f64 = 1e-6;
/// The largest error of a range, relative to it.
const RELATIVE_ERROR: f64 = 1e-5;
/// The number of rays per pose along each axis, and of poses per shape: at least 10⁵ rays.
const BEAMS: u32 = 100;
const POSES: u32 = 12;

/// The same shape in single and in double precision. All numbers are exact in both.
struct Case {
    name: &'static str,
    single: single::SharedShape,
    double: double::SharedShape,
}

fn case<A: single::Shape, B: double::Shape>(name: &'static str, a: A, b: B) -> Case {
    Case { name, single: single::SharedShape::new(a), double: double::SharedShape::new(b) }
}

fn cases() -> Vec<Case> {
    let v = Vec3::new;
    let d = |v: Vec3| v.as_dvec3();
    let slanted = [v(-0.25, 0.125, 0.5), v(0.5, -0.25, -0.375)];
    let normal = v(0.5, 0.75, -0.25).normalize();
    let corners = [v(-0.5, -0.5, -0.25), v(0.75, -0.5, -0.25), v(0.0, 0.625, -0.25), v(0.0, 0.0, 0.75)];
    let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let cloud: Vec<Vec3> = (0..24)
        .map(|i| {
            let part = |factor: f32| ((i as f32 * factor).fract() * 64.0).round() / 64.0 - 0.5;
            v(part(0.618), part(0.414), part(0.732))
        })
        .collect();
    let cloud64: Vec<DVec3> = cloud.iter().copied().map(d).collect();
    let turned = Quat::from_xyzw(0.5, 0.25, -0.125, 0.75).normalize();
    let pose = Pose32::from_parts(v(0.25, -0.5, 0.125), turned);
    let pose64 = Pose64::from_parts(d(pose.translation), pose.rotation.as_dquat().normalize());
    let aside = v(-0.5, 0.25, 0.0);
    let (terrain, terrain64) = terrains();
    vec![
        case("HeightField", terrain, terrain64),
        case("Ball", single::Ball::new(0.625), double::Ball::new(0.625)),
        case(
            "Cuboid",
            single::Cuboid::new(v(0.5, 0.25, 0.75)),
            double::Cuboid::new(DVec3::new(0.5, 0.25, 0.75)),
        ),
        case("Capsule x", single::Capsule::new_x(0.5, 0.25), double::Capsule::new_x(0.5, 0.25)),
        case("Capsule y", single::Capsule::new_y(0.5, 0.25), double::Capsule::new_y(0.5, 0.25)),
        case("Capsule z", single::Capsule::new_z(0.5, 0.25), double::Capsule::new_z(0.5, 0.25)),
        case(
            "Capsule",
            single::Capsule::new(slanted[0], slanted[1], 0.375),
            double::Capsule::new(d(slanted[0]), d(slanted[1]), 0.375),
        ),
        case("Cylinder", single::Cylinder::new(0.5, 0.375), double::Cylinder::new(0.5, 0.375)),
        case("Cone", single::Cone::new(0.625, 0.5), double::Cone::new(0.625, 0.5)),
        case("HalfSpace", single::HalfSpace::new(normal), double::HalfSpace::new(d(normal).normalize())),
        case(
            "Triangle",
            single::Triangle::new(corners[0], corners[1], corners[3]),
            double::Triangle::new(d(corners[0]), d(corners[1]), d(corners[3])),
        ),
        case(
            "TriMesh",
            single::TriMesh::new(corners.to_vec(), faces.to_vec()).unwrap(),
            double::TriMesh::new(corners.map(d).to_vec(), faces.to_vec()).unwrap(),
        ),
        case(
            "ConvexPolyhedron",
            single::ConvexPolyhedron::from_convex_hull(&cloud).unwrap(),
            double::ConvexPolyhedron::from_convex_hull(&cloud64).unwrap(),
        ),
        case(
            "Compound",
            single::Compound::new(vec![
                (pose, single::SharedShape::cone(0.5, 0.375)),
                (Pose32::from_translation(aside), single::SharedShape::cuboid(0.25, 0.5, 0.25)),
                (Pose32::IDENTITY, single::SharedShape::capsule_x(0.5, 0.125)),
            ]),
            double::Compound::new(vec![
                (pose64, double::SharedShape::cone(0.5, 0.375)),
                (Pose64::from_translation(d(aside)), double::SharedShape::cuboid(0.25, 0.5, 0.25)),
                (Pose64::IDENTITY, double::SharedShape::capsule_x(0.5, 0.125)),
            ]),
        ),
    ]
}

/// Scattered numbers from −0.5 to 0.5.
struct Scatter(u64);

impl Scatter {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.next(), self.next(), self.next())
    }

    fn pose(&mut self) -> Pose {
        let rotation = DQuat::from_vec4(self.vector().extend(self.next()));
        Pose::new(self.vector() * 20.0, rotation)
    }

    fn scale(&mut self) -> DVec3 {
        let factor = |x: f64| x.signum() * 4.0_f64.powf(2.0 * x);
        self.vector().to_array().map(factor).into()
    }
}

/// The result of parry3d for a scaled and placed shape that is enlarged by a factor.
fn truth(
    shape: &dyn double::Shape,
    pose: &Pose,
    scale: DVec3,
    origin: DVec3,
    ahead: DVec3,
    growth: f64,
) -> f64 {
    let shape_from_world = pose.rotation().inverse();
    let to_shape = |v: DVec3| (shape_from_world * v) / (scale * growth);
    let ray = Ray::new(to_shape(origin - pose.translation()), to_shape(ahead));
    // parry3d's own search needs directions of about unit length.
    let length = ray.dir.length();
    let unit = Ray::new(ray.origin, ray.dir / length);
    shape.cast_local_ray(&unit, f64::MAX, false).map_or(f64::INFINITY, |t| t / length)
}

#[derive(PartialEq)]
enum Verdict {
    Same,
    Edge,
    Different,
}

/// Compares a range with that of a shape which is enlarged by a factor.
fn compare(found: f64, truth: impl Fn(f64) -> f64) -> Verdict {
    let expected = truth(1.0);
    if found == expected || (found - expected).abs() < RELATIVE_ERROR * expected {
        return Verdict::Same;
    }
    let (larger, smaller) = (truth(1.0 + EDGE), truth(1.0 - EDGE));
    if larger.min(smaller) <= found && found <= larger.max(smaller) {
        Verdict::Edge
    } else {
        Verdict::Different
    }
}

#[test]
fn shapes_are_hit_as_by_parry3d() {
    let beams = Beams { samples: BEAMS, min_angle_rad: -0.5, max_angle_rad: 0.45 };
    let config = LIDAR.horizontal(beams).vertical(beams).range_min_m(0.0).range_max_m(1e6);
    for Case { name, single, double } in cases() {
        let mut scatter = Scatter(7);
        let (mut hits, mut edges) = (0, 0);
        for number in 0..POSES {
            let mut builder = SceneBuilder::new();
            let material = builder.add_material(&MaterialConfig::default()).unwrap();
            let pose = scatter.pose();
            let mut scale = if number < 4 { DVec3::ONE } else { scatter.scale() };
            let parts = builder.add_parry_shape(single.0.as_ref(), scale.to_array()).or_else(|error| {
                // Slanted capsules and compounds of rotated parts.
                assert!(matches!(error, ParryError::Sheared(_)), "{name}: {error}");
                scale = DVec3::splat(scale.x.abs());
                builder.add_parry_shape(single.0.as_ref(), scale.to_array())
            });
            let look = InstanceConfig { material, world_from_instance: pose, ..Default::default() };
            for part in parts.unwrap() {
                builder.add_instance(&part.instance(&look)).unwrap();
            }
            let target = pose.translation() + scatter.vector() * 0.5 * scale.abs();
            // Every fourth pose is inside.
            let away = if number % 4 == 3 { 0.1 } else { 2.5 + 2.0 * scatter.next() };
            let eye = target + scatter.vector().normalize() * away * scale.abs().max_element();
            let view = look_at(eye, target, scatter.next());
            let (ranges, _) = scan(&builder, config, view);
            for (index, &range) in ranges.iter().enumerate() {
                let (line, beam) = (index as u32 / BEAMS, index as u32 % BEAMS);
                let (up, left) = (config.vertical.angle(line), config.horizontal.angle(beam));
                let ahead = DVec3::new(up.cos() * left.cos(), up.cos() * left.sin(), up.sin());
                let ahead = view.transform_vector(ahead);
                let truth = |growth: f64| {
                    Some(truth(double.0.as_ref(), &pose, scale, eye, ahead, growth))
                        .filter(|range| *range <= config.range_max_m)
                        .unwrap_or(f64::INFINITY)
                };
                hits += u32::from(range.is_finite());
                let verdict = compare(f64::from(range), truth);
                edges += u32::from(verdict == Verdict::Edge);
                assert!(
                    verdict != Verdict::Different,
                    "{name} × {scale}, pose {number}, line {line}, beam {beam}: {range}, not {}",
                    truth(1.0)
                );
            }
        }
        println!("{name}: {hits} hits of {} rays, {edges} at edges", POSES * BEAMS * BEAMS);
        assert!(hits > 10_000, "{name}: {hits} hits");
    }
}

/// A height field of parry3d, and its triangles in double precision as a mesh: parry3d's own walk over the cells misses
/// some hits, but the one over the mesh does not.
fn terrains() -> (single::HeightField, double::TriMesh) {
    let (rows, columns) = (13, 22);
    let height = |k: usize| ((k as f32 * 0.618).fract() * 64.0).round() / 64.0;
    let heights: Vec<f32> = (0..rows * columns).map(height).collect();
    let heights64 = heights.iter().map(|height| f64::from(*height)).collect();
    let (heights, heights64) = (
        parry3d::utils::Array2::new(rows, columns, heights),
        parry3d_f64::utils::Array2::new(rows, columns, heights64),
    );
    let size = Vec3::new(4.0, 0.5, 2.0);
    let (vertices, triangles) = double::HeightField::new(heights64, size.as_dvec3()).to_trimesh();
    (single::HeightField::new(heights, size), double::TriMesh::new(vertices, triangles).unwrap())
}

#[test]
fn height_fields_are_hit_as_by_parry3d() {
    let (single, double) = terrains();
    let mut builder = SceneBuilder::new();
    let parts = builder.add_parry_shape(&single, [1.0; 3]).unwrap();
    let [part] = parts[..] else { panic!("{} parts", parts.len()) };
    let Kind::HeightField(field) = part.shape else { panic!("{:?}", part.shape) };
    let scene = builder.scene();
    let grid = scene.height_field(field).unwrap();
    let mut scatter = Scatter(3);
    let (mut hits, mut edges) = (0, 0);
    for number in 0..20_000 {
        let origin = (scatter.vector() * 8.0) + DVec3::Y * 2.0;
        let ahead = (scatter.vector() * DVec3::new(4.5, 0.5, 2.5) - origin).normalize();
        let part_from_shape = part.shape_from_part.inverse();
        let (o, v) = (part_from_shape.transform_point(origin), part_from_shape.transform_vector(ahead));
        let hit = |block: u32, lane: usize| {
            let block = grid.block(block);
            let [a, b, c] =
                block.corners.map(|corner| DVec3::from_array(corner.map(|axis| f64::from(axis[lane]))));
            let normal = (b - a).cross(c - a);
            let t = (a - o).dot(normal) / v.dot(normal);
            let p = o + v * t;
            let within = |a: DVec3, b: DVec3| (b - a).cross(p - a).dot(normal) >= 0.0;
            (t >= 0.0 && within(a, b) && within(b, c) && within(c, a)).then_some(t)
        };
        let found = (0..grid.field().blocks())
            .flat_map(|block| (0..WIDTH).filter_map(move |lane| hit(block, lane)))
            .fold(f64::INFINITY, f64::min);
        let truth = |growth: f64| truth(&double, &Pose::IDENTITY, DVec3::ONE, origin, ahead, growth);
        hits += u32::from(found.is_finite());
        let verdict = compare(found, truth);
        edges += u32::from(verdict == Verdict::Edge);
        assert!(verdict != Verdict::Different, "ray {number}: {found}, not {}", truth(1.0));
    }
    println!("HeightField: {hits} hits, {edges} at edges");
    assert!(hits > 10_000, "{hits} hits");
}

#[test]
fn terrain_with_holes_is_a_mesh() {
    let (mut single, _) = terrains();
    single.set_cell_status(2, 3, single::HeightFieldCellStatus::CELL_REMOVED);
    let mut builder = SceneBuilder::new();
    let parts = builder.add_parry_shape(&single, [1.0; 3]).unwrap();
    assert!(matches!(parts[0].shape, Kind::Mesh(_)), "{:?}", parts[0].shape);
}

#[test]
fn untraceable_shapes_are_refused() {
    let mut builder = SceneBuilder::new();
    let mut refusal =
        |shape: &dyn single::Shape, scale: [f64; 3]| builder.add_parry_shape(shape, scale).err();
    let round = single::RoundCuboid { inner_shape: single::Cuboid::new(Vec3::ONE), border_radius: 0.1 };
    assert_eq!(refusal(&round, [1.0; 3]), Some(ParryError::NotTraced("RoundCuboid")));
    let sharp = single::RoundCuboid { border_radius: 0.0, ..round };
    assert_eq!(refusal(&sharp, [1.0; 3]), None);
    let segment = single::Segment::new(Vec3::ZERO, Vec3::ONE);
    assert_eq!(refusal(&segment, [1.0; 3]), Some(ParryError::NotTraced("Segment")));
    let slanted = single::Capsule::new(Vec3::ZERO, Vec3::ONE, 0.5);
    assert_eq!(refusal(&slanted, [1.0, 2.0, 1.0]), Some(ParryError::Sheared("Capsule")));
    assert_eq!(refusal(&slanted, [-2.0; 3]), None);
    for factor in [0.0, f64::NAN, f64::INFINITY] {
        let scale = [1.0, factor, 1.0];
        assert_eq!(refusal(&sharp, scale), Some(ParryError::Scene(SceneError::BadScale)));
    }
}

#[cfg(feature = "rapier")]
mod colliders {
    use super::*;
    use belvedere_sensors::parry::ParryError;
    use belvedere_sensors::rapier::{ColliderError, ColliderScene};
    use rapier3d::prelude::{ColliderBuilder, ColliderHandle, PhysicsWorld, RigidBodyBuilder, SharedShape};

    fn tower(world: &mut PhysicsWorld) -> Vec<ColliderHandle> {
        let ground = ColliderBuilder::new(SharedShape::new(single::HalfSpace::new(Vec3::Z)));
        let mut colliders = vec![world.insert(RigidBodyBuilder::fixed(), ground).1];
        for number in 0..5 {
            let body = RigidBodyBuilder::dynamic().translation(Vec3::new(0.1, 0.0, 0.6 + number as f32));
            let collider = if number % 2 == 0 {
                ColliderBuilder::cuboid(0.5, 0.5, 0.5)
            } else {
                ColliderBuilder::cylinder(0.5, 0.5).position(Pose32::rotation(Vec3::X * 1.5))
            };
            colliders.push(world.insert(body, collider).1);
        }
        colliders
    }

    /// Checks that the mirror equals a newly created one.
    fn check(mirror: &ColliderScene, builder: &SceneBuilder, world: &PhysicsWorld) {
        let mut fresh_builder = builder.clone();
        let mut fresh = ColliderScene::new();
        for (handle, _) in world.colliders.iter() {
            fresh.add(&mut fresh_builder, &world.colliders, handle, &InstanceConfig::default()).unwrap();
            let poses = |mirror: &ColliderScene, builder: &SceneBuilder| {
                mirror.instances(handle).map(|instance| builder.pose(instance).unwrap()).collect::<Vec<_>>()
            };
            assert_eq!(poses(mirror, builder), poses(&fresh, &fresh_builder), "{handle:?}");
        }
    }

    #[test]
    fn colliders_follow_their_bodies() {
        let mut world = PhysicsWorld::new();
        world.gravity = Vec3::Z * -9.81;
        let handles = tower(&mut world);
        let mut builder = SceneBuilder::new();
        builder.add_material(&MaterialConfig::default()).unwrap();
        let mut mirror = ColliderScene::new();
        for handle in &handles {
            mirror.add(&mut builder, &world.colliders, *handle, &InstanceConfig::default()).unwrap();
        }
        let mut slept = false;
        for _ in 0..1500 {
            world.step();
            mirror.update(&mut builder, &world.islands, &world.bodies, &world.colliders);
            check(&mirror, &builder, &world);
            slept |= world.islands.active_bodies().count() == 0;
        }
        assert!(slept, "the tower comes to rest");

        // Bodies at rest are not updated, so a fixed body that is moved by hand must be reported.
        let ground = world.colliders[handles[0]].parent().unwrap();
        world.bodies[ground].set_translation(Vec3::Z * -1.0, true);
        world.step();
        mirror.update(&mut builder, &world.islands, &world.bodies, &world.colliders);
        assert!(mirror.refresh(&mut builder, &world.colliders, handles[0]));
        check(&mirror, &builder, &world);
    }

    #[test]
    fn colliders_come_and_go() {
        let mut world = PhysicsWorld::new();
        let mut builder = SceneBuilder::new();
        let material = builder.add_material(&MaterialConfig::default()).unwrap();
        let look = InstanceConfig { material, ..Default::default() };
        let mut mirror = ColliderScene::new();
        let shape = SharedShape::compound(vec![
            (Pose32::IDENTITY, SharedShape::ball(0.5)),
            (Pose32::from_translation(Vec3::X), SharedShape::cuboid(0.5, 0.5, 0.5)),
        ]);
        for _ in 0..10 {
            let handle = world.insert(RigidBodyBuilder::dynamic(), ColliderBuilder::new(shape.clone())).1;
            mirror.add(&mut builder, &world.colliders, handle, &look).unwrap();
            mirror.add(&mut builder, &world.colliders, handle, &look).unwrap();
            assert_eq!(mirror.instances(handle).count(), 2);
            assert_eq!(builder.scene().instances().len(), 2, "instances are used again");
            let (ranges, _) = scan(&builder, LIDAR, Pose::from_translation(DVec3::X * -2.0));
            assert!(ranges.iter().any(|range| range.is_finite()));
            assert!(mirror.remove(&mut builder, handle) && !mirror.remove(&mut builder, handle));
            let (ranges, _) = scan(&builder, LIDAR, Pose::from_translation(DVec3::X * -2.0));
            assert!(ranges.iter().all(|range| range.is_infinite()));
            assert!(!mirror.refresh(&mut builder, &world.colliders, handle));
            let body = world.colliders[handle].parent().unwrap();
            world.remove_body(body);
            world.step();
            mirror.update(&mut builder, &world.islands, &world.bodies, &world.colliders);
            let gone = mirror.add(&mut builder, &world.colliders, handle, &look);
            assert_eq!(gone, Err(ColliderError::NoSuchCollider(handle)));
        }
        let round = ColliderBuilder::round_cuboid(0.5, 0.5, 0.5, 0.1);
        let handle = world.insert(RigidBodyBuilder::dynamic(), round).1;
        let refused = mirror.add(&mut builder, &world.colliders, handle, &look);
        assert_eq!(refused, Err(ColliderError::Shape(ParryError::NotTraced("RoundCuboid"))));
    }

    #[test]
    fn meshes_are_removed_with_their_last_collider() {
        let mut world = PhysicsWorld::new();
        let mut builder = SceneBuilder::new();
        let material = builder.add_material(&MaterialConfig::default()).unwrap();
        let look = InstanceConfig { material, ..Default::default() };
        let mut mirror = ColliderScene::new();
        let add = |world: &mut PhysicsWorld, shape: &SharedShape| {
            world.insert(RigidBodyBuilder::dynamic(), ColliderBuilder::new(shape.clone())).1
        };
        let mut sizes = Vec::new();
        for _ in 0..20 {
            // A different shape each time, so its mesh differs too.
            let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z].to_vec();
            let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
            let shape = SharedShape::trimesh(corners, faces).unwrap();
            let handles = [add(&mut world, &shape), add(&mut world, &shape)];
            for handle in handles {
                mirror.add(&mut builder, &world.colliders, handle, &look).unwrap();
            }
            sizes.push(builder.memory_len());
            assert!(mirror.remove(&mut builder, handles[0]));
            assert_eq!(mirror.instances(handles[1]).count(), 1, "the other still has it");
            assert!(mirror.remove(&mut builder, handles[1]));
        }
        assert!(sizes.iter().all(|size| *size == sizes[0]), "{sizes:?}");
    }
}
