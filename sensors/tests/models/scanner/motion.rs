//! Every firing uses the poses of the sensor and of the objects at its own time.

use super::*;

#[test]
fn every_firing_starts_at_the_pose_of_the_sensor_at_its_time() {
    let (tower, drum) = (tower(), drum());
    for room in rooms() {
        let motion = Motion::new(drive, |_| room.poses().to_vec());
        let keyframes = motion.keyframes();
        for (pattern, number) in [(tower_of(&tower), 0), (tower_of(&tower), 7), (drum_of(&drum), 0)] {
            let scanner = Scanner::new(ScannerConfig::new(pattern)).unwrap();
            let capture = Capture::new(number, keyframes.as_slice());
            let (ranges, points) = scan(&scanner, &room, &capture, Execution::default());
            let (mut worst, mut off) = (0.0_f64, 0.0_f64);
            for index in 0..scanner.firings(number) {
                let firing = scanner.firing(number, index);
                let pose = drive(firing.time_s);
                let (origin, direction) =
                    (pose.transform_point(firing.origin), pose.transform_vector(firing.direction));
                let expected = to_walls(origin, direction);
                worst = worst.max((f64::from(ranges[index]) / expected - 1.0).abs());
                // Transformed to the world by the pose at its time, each point is on a wall.
                let point = pose.transform_point(DVec3::from(points[index].map(f64::from)));
                let wall = ROOM.iter().map(|(normal, distance)| (distance - point.dot(*normal)).abs());
                off = off.max(wall.fold(f64::INFINITY, f64::min));
            }
            println!("frame {number}: ranges {worst:e}, deskewed points {off:e} m off");
            assert!(worst < 1e-6 && off < 2e-6, "{worst:e} {off:e}");
            assert!(ranges[scanner.firings(number)..].iter().all(|range| range.is_nan()));
        }
        // With a single moment for all, errors of the points are as large as the motion of the lidar in a tenth of a
        // second.
        let scanner = Scanner::new(ScannerConfig::new(tower_of(&tower))).unwrap();
        let still =
            Capture::new(0, Moment { world_from_sensor: drive(0.0), world_from_instance: room.poses() });
        let (_, points) = scan(&scanner, &room, &still, Execution::default());
        let worst = (0..scanner.firings(0)).map(|index| {
            let pose = drive(scanner.firing(0, index).time_s);
            let point = pose.transform_point(DVec3::from(points[index].map(f64::from)));
            let wall = ROOM.iter().map(|(normal, distance)| (distance - point.dot(*normal)).abs());
            wall.fold(f64::INFINITY, f64::min)
        });
        let worst = worst.fold(0.0, f64::max);
        assert!(worst > 0.5, "{worst}");
    }
}

/// A ball that flies past, a box that spins and a tetrahedron that tumbles, while the sensor drives and turns.
#[test]
fn objects_are_hit_at_their_poses_at_the_time_of_a_firing() {
    let mut builder = SceneBuilder::new();
    add_grey(&mut builder, Shape::Sphere { radius: 0.5 }, Pose::IDENTITY);
    add_grey(&mut builder, Shape::Box { size: [0.2, 3.0, 8.0] }, Pose::IDENTITY);
    let corners = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
    let faces = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];
    let mesh = builder.add_mesh(&corners, &[[0.0; 2]; 4], &faces).unwrap();
    let material = builder.add_material(&MaterialConfig::default()).unwrap();
    let scale = [1.0, 1.5, 0.7];
    let config = InstanceConfig { shape: Shape::Mesh(mesh), scale, material, ..Default::default() };
    builder.add_instance(&config).unwrap();
    let sensor = |time: f64| Pose::from_xyz_rpy(DVec3::new(time, 0.0, 0.1), DVec3::new(0.0, 0.0, 1.5 * time));
    let things = |time: f64| {
        vec![
            Pose::from_translation(DVec3::new(4.0, 20.0 * time - 1.0, 0.0)),
            Pose::from_xyz_rpy(DVec3::new(-4.0, 1.0 - 8.0 * time, 0.3), DVec3::new(0.1, 0.0, 40.0 * time)),
            Pose::from_xyz_rpy(DVec3::new(0.0, 4.0 + 3.0 * time, 0.0), DVec3::new(0.4, 0.2, 0.0))
                * Pose::from_xyz_rpy(DVec3::ZERO, DVec3::X * 30.0 * time),
        ]
    };
    let motion = Motion::new(sensor, things);
    let drum = drum();
    let scanner = Scanner::new(ScannerConfig::new(drum_of(&drum))).unwrap();
    let count = scanner.most_firings();
    let (mut ranges, mut normal, mut instance) = (vec![0.0; count], vec![[0.0; 3]; count], vec![0; count]);
    let mut incidence = vec![0.0; count];
    let truth = Truth::new().normal(&mut normal).instance(&mut instance).incidence(&mut incidence);
    let keyframes = motion.keyframes();
    let output = Echoes::new().ranges(&mut ranges).truth(truth);
    take(&scanner, &builder, &Capture::new(0, keyframes.as_slice()), Execution::default(), output).unwrap();
    let mut met = [0; 3];
    for index in 0..count {
        let firing = scanner.firing(0, index);
        let pose = sensor(firing.time_s);
        let (origin, direction) =
            (pose.transform_point(firing.origin), pose.transform_vector(firing.direction));
        // The nearest hit: its range and distance from an edge, its normal, and the object.
        let mut nearest = (f64::INFINITY, DVec3::ZERO, u32::MAX);
        let mut is_close = false;
        for (number, thing) in things(firing.time_s).iter().enumerate() {
            let back = thing.inverse();
            let (o, d) = (back.transform_point(origin), back.transform_vector(direction));
            let (hit, margin) = match number {
                0 => ball(o, d, 0.5),
                1 => slabs(o, d, DVec3::new(0.1, 1.5, 4.0)),
                _ => planes(
                    o,
                    d,
                    &corners.map(|corner| DVec3::from(corner.map(f64::from)) * DVec3::from(scale)),
                    &faces,
                ),
            };
            is_close |= margin < 1e-3;
            if let Some((range, normal)) = hit
                && range < nearest.0
            {
                nearest = (range, thing.transform_vector(normal), number as u32);
            }
        }
        if is_close {
            continue;
        }
        assert_eq!(instance[index], nearest.2, "firing {index}");
        if nearest.2 == u32::MAX {
            assert_eq!(ranges[index], f32::INFINITY);
            continue;
        }
        met[nearest.2 as usize] += 1;
        assert!((f64::from(ranges[index]) - nearest.0).abs() < 1e-5, "{} {nearest:?}", ranges[index]);
        let found = DVec3::from(normal[index].map(f64::from));
        assert!((found - nearest.1).length() < 1e-4, "{found} {nearest:?}");
        assert!((f64::from(incidence[index]).cos() + nearest.1.dot(direction)).abs() < 1e-4);
    }
    assert!(met.iter().all(|count| *count > 100), "{met:?}");
}

type SurfaceHit = (Option<(f64, DVec3)>, f64);

/// The hit of a ray on a ball, and its distance from the edge.
fn ball(origin: DVec3, direction: DVec3, radius: f64) -> SurfaceHit {
    let along = -origin.dot(direction);
    let aside = (origin + direction * along).length();
    let range = along - (radius * radius - aside * aside).max(0.0).sqrt();
    let hit = (aside < radius && along > 0.0).then(|| (range, (origin + direction * range) / radius));
    (hit, (aside - radius).abs())
}

fn slabs(origin: DVec3, direction: DVec3, half: DVec3) -> SurfaceHit {
    let (a, b) = ((-half - origin) / direction, (half - origin) / direction);
    let (enter, leave) = (a.min(b), a.max(b));
    let range = enter.max_element();
    let normal = DVec3::AXES
        .map(|axis| axis * -direction.dot(axis).signum() * f64::from(u8::from(enter.dot(axis) == range)));
    let margin = leave.min_element() - range;
    ((margin > 0.0 && range > 0.0).then_some((range, normal[0] + normal[1] + normal[2])), margin.abs())
}

/// A convex body of triangles that are counter-clockwise seen from outside.
fn planes(origin: DVec3, direction: DVec3, corners: &[DVec3; 4], faces: &[[u32; 3]; 4]) -> SurfaceHit {
    let (mut enter, mut leave, mut normal) = (f64::NEG_INFINITY, f64::INFINITY, DVec3::ZERO);
    for face in faces {
        let [a, b, c] = face.map(|corner| corners[corner as usize]);
        let outwards = (b - a).cross(c - a).normalize();
        let (along, above) = (outwards.dot(direction), outwards.dot(a - origin));
        let range = above / along;
        if along < 0.0 && range > enter {
            (enter, normal) = (range, outwards);
        }
        if along > 0.0 && range < leave {
            leave = range;
        }
    }
    ((leave > enter && enter > 0.0).then_some((enter, normal)), (leave - enter).abs())
}
