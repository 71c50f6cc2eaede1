//! Depth images and scans against closed formulas, pixel by pixel and beam by beam.

use crate::common::oracle::{Ray, first_hit, pixel_ray, scaled};
use crate::common::{LIDAR, SIZE, add_grey, camera, depth_camera, depth_image, look_at, scan};
use belvedere_sensors::Pose;
use belvedere_sensors::lidar::{Beams, TooNear};
use belvedere_sensors::scene::{SceneBuilder, Shape};
use belvedere_sensors::trace::Faces;
use core::f64::consts::PI;
use glam::DVec3;

/// A pixel may differ in hit or miss if changing the size of the shape by this fraction changes the result.
const EDGE: f64 = 1e-6;
/// The largest error of a depth or range, relative to it.
const RELATIVE_ERROR: f64 = 1e-5;

const SHAPES: [Shape; 8] = [
    Shape::Rectangle { size: [1.5, 1.0] },
    Shape::Box { size: [1.0, 0.75, 0.5] },
    Shape::Sphere { radius: 0.5 },
    Shape::Cylinder { radius: 0.25, length: 1.0 },
    Shape::Capsule { radius: 0.25, length: 0.5 },
    Shape::Plane,
    Shape::Ellipsoid { radii: [0.5, 0.3, 0.2] },
    Shape::Cone { radius: 0.4, length: 0.8 },
];

fn shape_pose() -> Pose {
    Pose::from_xyz_rpy(DVec3::new(0.3, -0.2, 0.4), DVec3::new(0.5, -0.3, 1.1))
}

/// Oblique views from all around, near and far, and one along the shape's own axis.
fn views() -> [Pose; 6] {
    let target = shape_pose().translation();
    let from = |x: f64, y: f64, z: f64, roll: f64| look_at(DVec3::new(x, y, z) + target, target, roll);
    let axis = shape_pose().transform_vector(DVec3::Z) * 2.0;
    [
        from(1.2, 0.9, 0.7, 0.3),
        from(-1.0, 1.4, -0.6, -2.0),
        from(0.2, -0.3, 1.3, 1.0),
        from(-0.5, -1.0, -1.1, 0.0),
        from(6.0, -5.0, 3.0, 0.1),
        from(axis.x, axis.y, axis.z, 0.0),
    ]
}

/// Compares a depth image of one shape, with these visible sides, with the formula, and returns the number of pixels
/// that it covers.
fn check_depths(depths: &[f32], shape: &Shape, shape_pose: &Pose, view: &Pose, faces: Faces) -> usize {
    let both = faces == Faces::Both;
    let mut covered = 0;
    for (index, &depth) in depths.iter().enumerate() {
        let (column, row) = (index as u32 % SIZE[0], index as u32 / SIZE[0]);
        let ray = pixel_ray(&camera(), view, column, row);
        let hit = |shape: &Shape| {
            first_hit(shape, shape_pose, &ray, camera().near_m, both).filter(|t| *t < camera().far_m)
        };
        let at_edge =
            || hit(&scaled(shape, 1.0 + EDGE)).is_some() != hit(&scaled(shape, 1.0 - EDGE)).is_some();
        match hit(shape) {
            Some(truth) if depth.is_finite() => {
                let error = (f64::from(depth) - truth).abs() / truth;
                assert!(
                    error < RELATIVE_ERROR || at_edge(),
                    "{shape:?} at ({column}, {row}): {depth}, should be {truth}"
                );
                covered += 1;
            }
            None if depth == f32::INFINITY => {}
            truth => assert!(at_edge(), "{shape:?} at ({column}, {row}): {depth}, should be {truth:?}"),
        }
    }
    covered
}

#[test]
fn depth_of_every_shape() {
    for shape in SHAPES {
        let mut builder = SceneBuilder::new();
        add_grey(&mut builder, shape, shape_pose());
        let mut covered = 0;
        for view in views() {
            let [front, both] = [Faces::Front, Faces::Both].map(|faces| {
                let depths = depth_image(&builder, depth_camera().faces(faces), view);
                check_depths(&depths, &shape, &shape_pose(), &view, faces)
            });
            assert!(both >= front, "{shape:?} covers {both} pixels of both sides and {front} of its outside");
            covered += front;
        }
        assert!(covered > 50_000, "{shape:?} covers only {covered} pixels of all views");
    }
}

/// The corners and triangles of a box around the origin, counter-clockwise seen from outside.
fn box_mesh([x, y, z]: [f32; 3]) -> ([[f32; 3]; 8], [[u32; 3]; 12]) {
    let corners = core::array::from_fn(|i| {
        let side = |bit: usize, edge: f32| if i >> bit & 1 == 1 { edge * 0.5 } else { edge * -0.5 };
        [side(0, x), side(1, y), side(2, z)]
    });
    let triangles = [
        [1, 3, 7],
        [1, 7, 5],
        [0, 4, 6],
        [0, 6, 2],
        [2, 6, 7],
        [2, 7, 3],
        [0, 1, 5],
        [0, 5, 4],
        [4, 5, 7],
        [4, 7, 6],
        [0, 2, 3],
        [0, 3, 1],
    ];
    (corners, triangles)
}

#[test]
fn depth_of_a_mesh() {
    let shape = SHAPES[1];
    let (corners, triangles) = box_mesh([1.0, 0.75, 0.5]);
    let mut builder = SceneBuilder::new();
    let mesh = builder.add_mesh(&corners, &[], &triangles).unwrap();
    add_grey(&mut builder, Shape::Mesh(mesh), shape_pose());
    for view in views() {
        let depths = depth_image(&builder, depth_camera(), view);
        check_depths(&depths, &shape, &shape_pose(), &view, Faces::Both);
    }
}

#[test]
fn a_hundred_kilometres_away_all_looks_the_same() {
    let far = Pose::from_translation(DVec3::new(100_000.0, -100_000.0, 25.0));
    for shape in SHAPES {
        let mut builder = SceneBuilder::new();
        add_grey(&mut builder, shape, far * shape_pose());
        let view = far * views()[0];
        let depths = depth_image(&builder, depth_camera(), view);
        check_depths(&depths, &shape, &(far * shape_pose()), &view, Faces::Both);
    }
}

#[test]
fn the_nearest_of_many_shapes() {
    let mut builder = SceneBuilder::new();
    let mut placed = Vec::new();
    for index in 0..40 {
        let shape = SHAPES[index % SHAPES.len()];
        let i = index as f64;
        let pose = Pose::from_xyz_rpy(
            DVec3::new((i * 1.7).sin() * 3.0, (i * 2.3).cos() * 3.0, (i * 0.9).sin() * 1.5),
            DVec3::new(i, 2.0 * i, 3.0 * i),
        );
        add_grey(&mut builder, shape, pose);
        placed.push((shape, pose));
    }
    let view = look_at(DVec3::new(-6.0, 1.0, 2.0), DVec3::ZERO, 0.2);
    let depths = depth_image(&builder, depth_camera(), view);
    let mut edges = 0;
    for (index, &depth) in depths.iter().enumerate() {
        let ray = pixel_ray(&camera(), &view, index as u32 % SIZE[0], index as u32 / SIZE[0]);
        let truth = placed
            .iter()
            .filter_map(|(shape, pose)| first_hit(shape, pose, &ray, camera().near_m, true))
            .fold(f64::INFINITY, f64::min);
        let agrees = f64::from(depth) == truth || (f64::from(depth) - truth).abs() < RELATIVE_ERROR * truth;
        edges += usize::from(!agrees);
    }
    assert!(edges <= 2, "{edges} pixels differ; only those within {EDGE} of an edge may");
}

#[test]
fn a_camera_sees_out_of_its_housing() {
    let mut builder = SceneBuilder::new();
    let (corners, triangles) = box_mesh([0.5, 0.5, 0.5]);
    let mesh = builder.add_mesh(&corners, &[], &triangles).unwrap();
    for shape in [
        Shape::Mesh(mesh),
        Shape::Box { size: [0.3; 3] },
        Shape::Sphere { radius: 0.2 },
        Shape::Cylinder { radius: 0.2, length: 0.3 },
        Shape::Capsule { radius: 0.2, length: 0.3 },
    ] {
        add_grey(&mut builder, shape, Pose::IDENTITY);
    }
    let wall = Shape::Box { size: [0.1, 20.0, 20.0] };
    add_grey(&mut builder, wall, Pose::from_translation(DVec3::X * 2.05));
    let depths = depth_image(&builder, depth_camera().faces(Faces::Front), Pose::IDENTITY);
    assert!(depths.iter().all(|depth| (depth - 2.0).abs() < 2e-5));
    // The nearest inside is a side of the box, at half its edge.
    let depths = depth_image(&builder, depth_camera(), Pose::IDENTITY);
    assert!(depths.iter().all(|depth| *depth <= 0.15 + 1e-6));
}

/// A wall across the view at this depth.
fn wall_at(depth: f64) -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    let wall = Shape::Box { size: [0.5, 1000.0, 1000.0] };
    add_grey(&mut builder, wall, Pose::from_translation(DVec3::X * (depth + 0.25)));
    builder
}

#[test]
fn clip_distances_and_cutoffs() {
    let mut config = depth_camera().faces(Faces::Front).min_depth_m(0.4).max_depth_m(5.0);
    (config.camera.near_m, config.camera.far_m) = (0.25, 8.0);
    for (depth, infinite) in [
        (0.2, f32::NEG_INFINITY), // Nearer than the near clip distance.
        (0.3, f32::NEG_INFINITY),
        (0.5, 0.5),
        (4.875, 4.875),
        (5.125, f32::INFINITY),
        (8.5, f32::INFINITY),
    ] {
        let builder = wall_at(depth);
        config.out_of_range = belvedere_sensors::depth::OutOfRange::Infinite;
        for seen in depth_image(&builder, config, Pose::IDENTITY) {
            let near_enough = (seen - infinite).abs() < 1e-5;
            assert!(seen == infinite || near_enough, "a wall at {depth} is seen at {seen}");
        }
        config.out_of_range = belvedere_sensors::depth::OutOfRange::Nan;
        for seen in depth_image(&builder, config, Pose::IDENTITY) {
            assert_eq!(seen.is_nan(), infinite.is_infinite(), "a wall at {depth} is seen at {seen}");
        }
    }
    // Culled, with nothing behind.
    config.out_of_range = belvedere_sensors::depth::OutOfRange::Infinite;
    config.too_near = TooNear::SeenThrough;
    let depths = depth_image(&wall_at(0.2), config, Pose::IDENTITY);
    assert!(depths.iter().all(|&depth| depth == f32::INFINITY));
}

/// A room of 8 × 6 m around the origin with a column in it, and the formula of a horizontal beam.
const ROOM: [f64; 2] = [4.0, 3.0];
const COLUMN: (DVec3, f64) = (DVec3::new(1.5, 1.0, 0.0), 0.25);

fn room() -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    for sign in [-1.0, 1.0] {
        let x_wall = Shape::Box { size: [0.2, 6.0, 2.5] };
        add_grey(&mut builder, x_wall, Pose::from_translation(DVec3::X * sign * (ROOM[0] + 0.1)));
        let y_wall = Shape::Box { size: [8.4, 0.2, 2.5] };
        add_grey(&mut builder, y_wall, Pose::from_translation(DVec3::Y * sign * (ROOM[1] + 0.1)));
    }
    let column = Shape::Cylinder { radius: COLUMN.1, length: 2.0 };
    add_grey(&mut builder, column, Pose::from_translation(COLUMN.0));
    builder
}

fn room_range(position: DVec3, heading: f64) -> f64 {
    let (sin, cos) = heading.sin_cos();
    let to_wall = |room: f64, at: f64, speed: f64| (room * speed.signum() - at) / speed;
    let walls = to_wall(ROOM[0], position.x, cos).min(to_wall(ROOM[1], position.y, sin));
    let to_column = COLUMN.0 - position;
    let (ahead, aside) = (to_column.x * cos + to_column.y * sin, to_column.y * cos - to_column.x * sin);
    let chord = COLUMN.1 * COLUMN.1 - aside * aside;
    if chord > 0.0 && ahead > 0.0 { walls.min(ahead - chord.sqrt()) } else { walls }
}

#[test]
fn scans_of_a_room() {
    let builder = room();
    let full = Beams { samples: 360, min_angle_rad: -PI, max_angle_rad: PI };
    for horizontal in [LIDAR.horizontal, full] {
        for (x, y, yaw) in [(0.0, 0.0, 0.0), (-2.0, 1.3, 0.7), (3.0, -2.5, -2.9)] {
            let position = DVec3::new(x, y, 0.1);
            let config = LIDAR.horizontal(horizontal);
            let pose = Pose::from_xyz_rpy(position, DVec3::Z * yaw);
            let (ranges, _) = scan(&builder, config, pose);
            let mut at_edge = 0;
            for (beam, &range) in ranges.iter().enumerate() {
                let step =
                    (horizontal.max_angle_rad - horizontal.min_angle_rad) / f64::from(horizontal.samples - 1);
                let truth = room_range(position, yaw + horizontal.min_angle_rad + beam as f64 * step);
                at_edge += usize::from((f64::from(range) - truth).abs() > RELATIVE_ERROR * truth);
            }
            assert_eq!(at_edge, 0, "from ({x}, {y})");
            if horizontal.samples == 360 {
                assert!((ranges[0] - ranges[359]).abs() < 1e-5, "beams at ±π look the same way");
            }
        }
    }
}

#[test]
fn scan_lines_and_both_sides_of_shapes() {
    let config =
        LIDAR.vertical(Beams { samples: 16, min_angle_rad: -0.4, max_angle_rad: 0.5 }).range_min_m(0.0);
    for shape in SHAPES {
        let mut builder = SceneBuilder::new();
        add_grey(&mut builder, shape, shape_pose());
        // From outside, and from inside (for the rectangle, from behind).
        let inside = shape_pose().transform_point(DVec3::new(0.01, 0.02, -0.03));
        for pose in [views()[0], Pose::from_xyz_rpy(inside, DVec3::new(0.1, 0.2, 0.3))] {
            let (ranges, _) = scan(&builder, config, pose);
            let mut hits = 0;
            for (index, &range) in ranges.iter().enumerate() {
                let (line, beam) = (index as u32 / 720, index as u32 % 720);
                let (up, left) = (config.vertical.angle(line), config.horizontal.angle(beam));
                let direction = DVec3::new(up.cos() * left.cos(), up.cos() * left.sin(), up.sin());
                let ray = Ray { origin: pose.translation(), direction: pose.transform_vector(direction) };
                let hit = |shape: &Shape| {
                    first_hit(shape, &shape_pose(), &ray, 0.0, true)
                        .filter(|range| *range <= config.range_max_m)
                        .unwrap_or(f64::INFINITY)
                };
                let truth = hit(&shape);
                hits += usize::from(truth.is_finite());
                let agrees =
                    f64::from(range) == truth || (f64::from(range) - truth).abs() < RELATIVE_ERROR * truth;
                let at_edge = || {
                    hit(&scaled(&shape, 1.0 + EDGE)).is_finite()
                        != hit(&scaled(&shape, 1.0 - EDGE)).is_finite()
                };
                assert!(agrees || at_edge(), "{shape:?}, line {line}, beam {beam}: {range}, not {truth}");
            }
            assert!(hits > 100, "{shape:?}: only {hits} hits");
        }
    }
}

#[test]
fn surfaces_too_near_for_a_lidar() {
    let mut builder = wall_at(2.0);
    add_grey(&mut builder, Shape::Sphere { radius: 0.05 }, Pose::IDENTITY);
    for (too_near, expected) in [(TooNear::Blocks, f32::NEG_INFINITY), (TooNear::SeenThrough, 2.0)] {
        let config = LIDAR.too_near(too_near);
        let (ranges, _) = scan(&builder, config, Pose::IDENTITY);
        // None of 720 beams is straight ahead: the two in the middle are 0.0022 rad off.
        let ahead = ranges[360];
        assert!(ahead == expected || (ahead - expected).abs() < 1e-5, "{too_near:?}: {ahead}");
    }
}

#[test]
fn ranges_end_at_the_largest_range() {
    let config = LIDAR.range_max_m(2.5);
    let (ranges, intensities) = scan(&wall_at(2.0), config, Pose::IDENTITY);
    assert!((ranges[360] - 2.0).abs() < 1e-4 && ranges[0] == f32::INFINITY);
    assert!(ranges.iter().all(|range| *range < 2.5 || *range == f32::INFINITY));
    assert!(intensities.iter().all(|intensity| *intensity == 0.0));
}
