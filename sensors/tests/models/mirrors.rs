//! Mirrors and panes of glass, as lidars and depth cameras see them, against closed forms.

#![allow(clippy::large_types_passed_by_value, reason = "configurations made where they are used read better")]

use crate::common::random::case;
use crate::common::{LIDAR, add, add_grey, camera_of, depth_camera, depth_frame, scan};
use belvedere_sensors::Pose;
use belvedere_sensors::device::depth_model::{DepthModel, SecondEye};
use belvedere_sensors::scanner::{
    Echoes, Firing, Intensity, Pattern, Receiver, Returns, Scanner, ScannerConfig,
};
use belvedere_sensors::scene::{InstanceConfig, MaterialConfig, MaterialId, SceneBuilder, SceneError, Shape};
use belvedere_sensors::trace::WorkspaceBuf;
use belvedere_sensors::{Capture, Keyframe, Moment, Sensor, Shutter};
use core::f64::consts::PI;
use glam::{DQuat, DVec3};

/// Numbers of a fixed seed, uniform on a range.
fn random(index: u32, range: [f64; 2]) -> f64 {
    case(21, index, range)
}

/// A random direction near another, given by its slopes.
fn about(index: u32, axis: DVec3, most: f64) -> DVec3 {
    let (right, up) = axis.any_orthonormal_pair();
    let slope = |part| random(index + part, [-most, most]);
    (axis + right * slope(0) + up * slope(1)).normalize()
}

/// A plane through a point, with a normal.
#[derive(Clone, Copy)]
struct Flat {
    point: DVec3,
    normal: DVec3,
}

impl Flat {
    fn pose(self) -> Pose {
        Pose::new(self.point, DQuat::from_rotation_arc(DVec3::Z, self.normal))
    }

    /// The distance at which a ray hits it.
    fn range(self, origin: DVec3, direction: DVec3) -> f64 {
        (self.point - origin).dot(self.normal) / direction.dot(self.normal)
    }

    fn mirror(self, direction: DVec3) -> DVec3 {
        direction - self.normal * (2.0 * direction.dot(self.normal))
    }
}

fn glazing(builder: &mut SceneBuilder, specular_reflectance: f32, transmittance: f32) -> MaterialId {
    let config = MaterialConfig { specular_reflectance, transmittance, ..MaterialConfig::default() };
    builder.add_material(&config).unwrap()
}

/// The two triangles of a square.
fn square(builder: &mut SceneBuilder, edge: f32) -> Shape {
    let half = 0.5 * edge;
    let corners = [[-half, -half, 0.0], [half, -half, 0.0], [half, half, 0.0], [-half, half, 0.0]];
    Shape::Mesh(builder.add_mesh(&corners, &[], &[[0, 1, 2], [0, 2, 3]]).unwrap())
}

/// A square that the axis of a sensor sees in a mirror, both at random, beside the part of the scene that the sensor
/// sees directly; behind the mirror is an object that must not be visible.
fn square_in_mirror(case: u32, is_mesh: bool) -> (SceneBuilder, Flat, Flat) {
    let number = |index, range| random(1000 * case + index, range);
    let (tilt, spin) = (number(0, [0.45, 1.0]), number(1, [-PI, PI]));
    let aside = DVec3::new(0.0, spin.cos(), spin.sin());
    let mirror = Flat {
        point: DVec3::X * number(2, [1.0, 8.0]),
        normal: (DVec3::NEG_X * tilt.cos() + aside * tilt.sin()).normalize(),
    };
    let ahead = mirror.mirror(DVec3::X);
    let target = Flat {
        point: mirror.point + ahead * number(3, [3.0, 9.0]),
        normal: about(1000 * case + 4, -ahead, 0.5),
    };
    let mut builder = SceneBuilder::new();
    let silver = glazing(&mut builder, 0.95, 0.0);
    let shape = if is_mesh { square(&mut builder, 2.0) } else { Shape::Rectangle { size: [2.0; 2] } };
    add(&mut builder, shape, mirror.pose(), silver);
    add_grey(&mut builder, Shape::Rectangle { size: [2.2; 2] }, target.pose());
    let behind = Flat { point: mirror.point - mirror.normal * 0.3, normal: mirror.normal };
    add_grey(&mut builder, Shape::Rectangle { size: [0.6; 2] }, behind.pose());
    (builder, mirror, target)
}

fn still(config: ScannerConfig<'_>, builder: &SceneBuilder) -> (Vec<f32>, Vec<f32>) {
    fire(config, builder, Shutter::Global(builder.moment(Pose::IDENTITY)))
}

/// Ranges and intensities.
fn fire(config: ScannerConfig<'_>, builder: &SceneBuilder, shutter: Shutter<'_>) -> (Vec<f32>, Vec<f32>) {
    let scanner = Scanner::new(config).unwrap();
    let values = scanner.most_firings() * scanner.returns();
    let (mut ranges, mut intensities) = (vec![7.0; values], vec![7.0; values]);
    let (scene, capture) = (builder.scene(), Capture::new(0, shutter));
    let mut memory = WorkspaceBuf::default();
    let output = Echoes::new().ranges(&mut ranges).intensities(&mut intensities);
    scanner
        .sense(&scene, &capture, &mut memory.lend(scanner.workspace_len(&scene, &capture)), output)
        .unwrap();
    (ranges, intensities)
}

fn firings(count: u32, case: u32) -> Vec<Firing> {
    (0..count)
        .map(|index| Firing {
            time_s: 0.0,
            origin: DVec3::ZERO,
            direction: about(100_000 + 1000 * case + 2 * index, DVec3::X, 0.02),
            laser: 0,
        })
        .collect()
}

#[track_caller]
fn assert_range(found: f32, expected: f64) {
    // Single precision; for a mesh, that of its triangles.
    assert!((f64::from(found) - expected).abs() < 2e-6 * expected, "{found} instead of {expected}");
}

#[test]
fn reflections_are_seen_at_the_sum_of_the_ranges() {
    for case in 0..24_u32 {
        let (builder, mirror, target) = square_in_mirror(case, case % 2 == 1);
        let expected = |direction: DVec3| {
            let first = mirror.range(DVec3::ZERO, direction);
            first + target.range(direction * first, mirror.mirror(direction))
        };
        let table = firings(150, case);
        let (ranges, _) = still(ScannerConfig::new(Pattern::Table(&table)), &builder);
        for (firing, range) in table.iter().zip(ranges) {
            assert_range(range, expected(firing.direction));
        }

        let mut lidar = LIDAR;
        (lidar.horizontal.samples, lidar.vertical.samples) = (37, 5);
        let axis = |samples: u32| {
            let step = 0.02 / f64::from(samples);
            (-0.5 * f64::from(samples - 1) * step, step)
        };
        for beams in [&mut lidar.horizontal, &mut lidar.vertical] {
            (beams.min_angle_rad, beams.max_angle_rad) = (axis(beams.samples).0, -axis(beams.samples).0);
        }
        let (ranges, _) = scan(&builder, lidar, Pose::IDENTITY);
        for (beam, range) in ranges.into_iter().enumerate() {
            let angle = |number: usize, samples: u32| axis(samples).0 + number as f64 * axis(samples).1;
            let (azimuth, elevation) = (angle(beam % 37, 37), angle(beam / 37, 5));
            let flat = elevation.cos();
            let direction = DVec3::new(flat * azimuth.cos(), flat * azimuth.sin(), elevation.sin());
            assert_range(range, expected(direction));
        }

        // With a model that makes a second pass over the frame, and without.
        let size = [41, 22];
        let config = depth_camera().camera(camera_of(size, 0.03)).max_depth_m(1000.0);
        let second = DepthModel::new().second_eye(SecondEye { right_m: 1e-9, half_view_rad: 1.0 });
        let focal = 0.5 * f64::from(size[0]) / 0.015_f64.tan();
        for config in [config, config.model(second)] {
            let depth = depth_frame(&builder, config, Pose::IDENTITY, 0);
            for (pixel, depth) in depth.into_iter().enumerate() {
                let (x, y) = (pixel % 41, pixel / 41);
                let slopes = DVec3::new(1.0, (20.0 - x as f64) / focal, (10.5 - y as f64) / focal);
                let direction = slopes.normalize();
                assert_range(depth, expected(direction) * direction.x);
            }
        }
    }
}

#[test]
fn a_mirror_that_reflects_nothing_is_only_seen_by_scattered_light() {
    for (reflectance, expected) in [(1.0, f32::INFINITY), (0.9, 3.0)] {
        let mut builder = SceneBuilder::new();
        let silver = glazing(&mut builder, reflectance, 0.0);
        let mirror = Flat { point: DVec3::X * 3.0, normal: DVec3::new(-1.0, 1.0, 0.0).normalize() };
        add(&mut builder, Shape::Rectangle { size: [1.0; 2] }, mirror.pose(), silver);
        let table = [Firing { time_s: 0.0, origin: DVec3::ZERO, direction: DVec3::X, laser: 0 }];
        let (ranges, _) = still(ScannerConfig::new(Pattern::Table(&table)), &builder);
        assert_eq!(ranges, [expected]);
        assert_eq!(scan(&builder, LIDAR, Pose::IDENTITY).0[360].is_finite(), expected.is_finite());
    }
}

/// The power that a lidar of unit power receives from a white surface.
fn power(light: f64, range: f64) -> f64 {
    0.7 * light / (range * range)
}

#[test]
fn glass_transmits_most_light_and_reflects_some() {
    // A pane that faces the sensor, a wall behind it, and one behind the sensor, which the pane reflects.
    for case in 0..8_u32 {
        let number = |index, range| random(50_000 + 10 * case + index, range);
        let (pane, wall, back) = (number(0, [2.0, 6.0]), number(1, [8.0, 12.0]), number(2, [5.0, 9.0]));
        let (mirrored, passed) = (number(3, [0.05, 0.2]), number(4, [0.6, 0.8]));
        let mut builder = SceneBuilder::new();
        let glass = glazing(&mut builder, mirrored as f32, passed as f32);
        let matt = glazing(&mut builder, 0.0, 0.0);
        let facing = |x: f64, normal: DVec3| Flat { point: DVec3::X * x, normal }.pose();
        let shape = Shape::Rectangle { size: [9.0; 2] };
        add(&mut builder, shape, facing(pane, DVec3::NEG_X), glass);
        add(&mut builder, shape, facing(wall, DVec3::NEG_X), matt);
        add(&mut builder, shape, facing(-back, DVec3::X), matt);
        let table = [Firing { time_s: 0.0, origin: DVec3::ZERO, direction: DVec3::X, laser: 0 }];
        let config = ScannerConfig::new(Pattern::Table(&table))
            .intensity(Intensity::Power)
            .receiver(Some(Receiver::new(1e3)))
            .range_max_m(100.0)
            .pulse_m(0.1);
        let mut expected = [
            (pane, power(1.0 - mirrored - passed, pane)),
            (wall, power(passed * passed, wall)),
            (2.0 * pane + back, power(mirrored * mirrored, 2.0 * pane + back)),
        ];
        expected.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (ranges, powers) = still(config.returns(Returns::Several(5)), &builder);
        for (index, (range, power)) in expected.into_iter().enumerate() {
            assert_range(ranges[index], range);
            assert!((f64::from(powers[index]) / power - 1.0).abs() < 1e-5, "{powers:?}, {expected:?}");
        }
        assert!(ranges[3..].iter().all(|range| *range == f32::INFINITY));

        // Velodyne's dual mode: the last return, and the strongest, or the second strongest if the last is the
        // strongest.
        let (ranges, _) = still(config.returns(Returns::Dual), &builder);
        let mut ranked = expected;
        ranked.sort_by(|a, b| b.1.total_cmp(&a.1));
        let strongest = if ranked[0] == expected[2] { ranked[1] } else { ranked[0] };
        assert_range(ranges[0], expected[2].0);
        assert_range(ranges[1], strongest.0);
        // A sensor that reports a single range and models no power sees through the pane.
        let near = ScannerConfig::new(Pattern::Table(&table));
        assert_range(still(near, &builder).0[0], wall);
        // None of 720 beams over half a turn is straight ahead.
        let aside = 0.5 * PI / 719.0;
        assert_range(scan(&builder, LIDAR.range_max_m(100.0), Pose::IDENTITY).0[360], wall / aside.cos());
        let depth = depth_frame(&builder, depth_camera().camera(camera_of([16, 16], 0.1)), Pose::IDENTITY, 0);
        assert!(depth.iter().all(|depth| (f64::from(*depth) - wall).abs() < 1e-5 * wall));
    }
}

#[test]
fn a_periscope_and_a_hall_of_mirrors() {
    let mut builder = SceneBuilder::new();
    let silver = glazing(&mut builder, 0.98, 0.0);
    let up = Flat { point: DVec3::X * 2.0, normal: DVec3::new(-1.0, 0.0, 1.0).normalize() };
    let on = Flat { point: DVec3::new(2.0, 0.0, 3.0), normal: DVec3::new(1.0, 0.0, -1.0).normalize() };
    for mirror in [up, on] {
        add(&mut builder, Shape::Rectangle { size: [1.0; 2] }, mirror.pose(), silver);
    }
    let wall = Flat { point: DVec3::new(7.5, 0.0, 3.0), normal: DVec3::NEG_X };
    let matt = glazing(&mut builder, 0.0, 0.0);
    add(&mut builder, Shape::Rectangle { size: [2.0; 2] }, wall.pose(), matt);
    let table = [Firing { time_s: 0.0, origin: DVec3::ZERO, direction: DVec3::X, laser: 0 }];
    let config = ScannerConfig::new(Pattern::Table(&table)).intensity(Intensity::Power);
    let (ranges, powers) = still(config, &builder);
    assert_range(ranges[0], 2.0 + 3.0 + 5.5);
    let expected = power(0.98_f64.powi(4), 10.5);
    assert!((f64::from(powers[0]) / expected - 1.0).abs() < 1e-5, "{powers:?}, {expected}");

    // Between two mirrors that face each other, light is reflected back and forth; following it ends nevertheless.
    let mut hall = SceneBuilder::new();
    let silver = glazing(&mut hall, 1.0, 0.0);
    for (x, normal) in [(3.0, DVec3::NEG_X), (-3.0, DVec3::X)] {
        add(
            &mut hall,
            Shape::Rectangle { size: [9.0; 2] },
            Flat { point: DVec3::X * x, normal }.pose(),
            silver,
        );
    }
    assert_eq!(still(ScannerConfig::new(Pattern::Table(&table)), &hall).0, [f32::INFINITY]);
}

#[test]
fn a_moving_mirror_is_at_its_pose_at_the_time_of_each_firing() {
    let mut builder = SceneBuilder::new();
    let silver = glazing(&mut builder, 0.95, 0.0);
    let mirror = Flat { point: DVec3::X * 4.0, normal: DVec3::NEG_X };
    let pane = InstanceConfig {
        shape: Shape::Rectangle { size: [3.0; 2] },
        world_from_instance: mirror.pose(),
        material: silver,
        ..Default::default()
    };
    builder.add_instance(&pane).unwrap();
    // Seen in the mirror behind the sensor.
    let wall = Flat { point: DVec3::NEG_X * 2.0, normal: DVec3::X };
    add_grey(&mut builder, Shape::Rectangle { size: [3.0; 2] }, wall.pose());
    let table: Vec<Firing> = (0..100)
        .map(|index| Firing {
            time_s: 1e-3 * f64::from(index),
            origin: DVec3::ZERO,
            direction: DVec3::X,
            laser: 0,
        })
        .collect();
    let speed = random(70_000, [-8.0, 8.0]);
    let places = |time: f64| {
        let moved = Flat { point: mirror.point + DVec3::X * (speed * time), ..mirror };
        vec![moved.pose(), wall.pose()]
    };
    let (first, last) = (places(0.0), places(0.1));
    let keyframes = [(0.0, &first), (0.1, &last)].map(|(time_s, places)| Keyframe {
        time_s,
        at: Moment { world_from_sensor: Pose::IDENTITY, world_from_instance: places },
    });
    let config = ScannerConfig::new(Pattern::Table(&table)).frame_time_ns(100_000_000);
    let (ranges, _) = fire(config, &builder, Shutter::Moving(&keyframes));
    for (firing, range) in table.iter().zip(ranges) {
        assert_range(range, 2.0 * (4.0 + speed * firing.time_s) + 2.0);
    }
}

#[test]
fn shares_of_more_than_all_light_are_refused() {
    let mut builder = SceneBuilder::new();
    for (specular_reflectance, transmittance) in [(1.1, 0.0), (-0.1, 0.0), (0.6, 0.5), (0.0, f32::NAN)] {
        let config = MaterialConfig { specular_reflectance, transmittance, ..MaterialConfig::default() };
        assert_eq!(builder.add_material(&config), Err(SceneError::BadShares));
    }
    let all = MaterialConfig { specular_reflectance: 0.1, transmittance: 0.9, ..MaterialConfig::default() };
    assert!(builder.add_material(&all).is_ok());
}
