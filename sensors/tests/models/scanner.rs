//! Scanners: every firing from where sensor and things are at its own time, against closed forms.

use crate::common::{add_grey, scenery};
use belvedere_sensors::lidar::{Beams, Lidar, LidarConfig, Scan};
use belvedere_sensors::noise::GaussianNoise;
use belvedere_sensors::scanner::{
    Columns, Echoes, Firing, Laser, Pattern, Rosette, Scanner, ScannerConfig, Spinning, presets,
};
use belvedere_sensors::scene::{InstanceConfig, MaterialConfig, SceneBuilder, Shape};
use belvedere_sensors::trace::{Truth, WorkspaceBuf};
use belvedere_sensors::{Capture, Execution, Keyframe, Moment, Pose, SenseError, Sensor, Shutter, Slice};
use core::f64::consts::{FRAC_PI_2, PI, TAU};
use glam::DVec3;

/// Sixteen lasers that fire one after the other, each a little above the one below it, as a VLP-16's.
fn tower() -> Vec<Laser> {
    let laser = |id: u32| {
        let elevation = -15.0 + 2.0 * f64::from(id % 2 * 8 + id / 2);
        let height = -0.041_91 * elevation.to_radians().tan();
        Laser {
            origin_m: [0.0, 0.0, height],
            time_s: 2.304e-6 * f64::from(id),
            ..Laser::at_degrees(elevation, 0.0)
        }
    };
    (0..16).map(laser).collect()
}

/// Lasers that fire together, from beside the axis, each a little aside, as an OS1's.
fn drum() -> Vec<Laser> {
    let laser = |row: u32| Laser {
        origin_m: [0.0158, 0.0, 0.0],
        ..Laser::at_degrees(20.0 - 1.3 * f64::from(row), [4.2, 1.4, -1.4, -4.2][row as usize % 4])
    };
    (0..32).map(laser).collect()
}

fn tower_of(lasers: &[Laser]) -> Pattern<'_> {
    let columns = Columns::Every { time_ns: 55_296 };
    Pattern::Spinning(Spinning { lasers, columns, first_azimuth_rad: 0.0, clockwise: true })
}

fn drum_of(lasers: &[Laser]) -> Pattern<'_> {
    let columns = Columns::Turn { per_turn: 512, first: 0, count: 512 };
    Pattern::Spinning(Spinning { lasers, columns, first_azimuth_rad: PI, clockwise: true })
}

fn take(
    scanner: &Scanner<'_>,
    scene: &SceneBuilder,
    capture: &Capture<'_>,
    execution: Execution,
    output: Echoes<'_>,
) -> Result<(), SenseError> {
    let mut memory = WorkspaceBuf::default();
    memory.execution = execution;
    let scene = scene.scene();
    scanner.sense(&scene, capture, &mut memory.lend(scanner.workspace_len(&scene, capture)), output)
}

/// Ranges and points of a frame.
fn scan(
    scanner: &Scanner<'_>,
    scene: &SceneBuilder,
    capture: &Capture<'_>,
    execution: Execution,
) -> (Vec<f32>, Vec<[f32; 3]>) {
    let count = scanner.most_firings();
    let (mut ranges, mut points) = (vec![7.0; count], vec![[7.0; 3]; count]);
    let output = Echoes::new().ranges(&mut ranges).points(&mut points);
    take(scanner, scene, capture, execution, output).unwrap();
    (ranges, points)
}

/// Driving at 15 m/s, climbing, and turning at 2 rad/s, with the sensor askew.
fn drive(time_s: f64) -> Pose {
    let place = DVec3::new(15.0 * time_s - 0.7, 0.4 - 2.0 * time_s, 0.3 * time_s);
    Pose::from_xyz_rpy(place, DVec3::new(0.03, -0.02, 2.0 * time_s + 0.3))
}

/// Poses of instances at keyframes, a millisecond from one to the next, up to the frame's end.
struct Motion {
    steps: Vec<(f64, Pose, Vec<Pose>)>,
}

impl Motion {
    fn new(sensor: impl Fn(f64) -> Pose, things: impl Fn(f64) -> Vec<Pose>) -> Self {
        let times = (0..=100).map(|step| 1e-3 * f64::from(step));
        Self { steps: times.map(|time| (time, sensor(time), things(time))).collect() }
    }

    fn keyframes(&self) -> Vec<Keyframe<'_>> {
        self.steps
            .iter()
            .map(|(time_s, sensor, things)| Keyframe {
                time_s: *time_s,
                at: Moment { world_from_sensor: *sensor, world_from_instance: things },
            })
            .collect()
    }
}

/// Distances from the middle of a room to its walls, floor and ceiling, by their directions.
const ROOM: [(DVec3, f64); 6] = [
    (DVec3::X, 6.0),
    (DVec3::NEG_X, 5.0),
    (DVec3::Y, 4.0),
    (DVec3::NEG_Y, 7.0),
    (DVec3::Z, 2.5),
    (DVec3::NEG_Z, 1.5),
];

/// The walls of the room as boxes, and as one mesh.
fn rooms() -> [SceneBuilder; 2] {
    let mut boxes = SceneBuilder::new();
    for (normal, distance) in ROOM {
        let size = DVec3::splat(40.0) - normal.abs() * 39.8;
        add_grey(
            &mut boxes,
            Shape::Box { size: size.to_array() },
            Pose::from_translation(normal * (distance + 0.1)),
        );
    }
    let mut mesh = SceneBuilder::new();
    let (mut corners, mut faces) = (Vec::new(), Vec::new());
    for (normal, distance) in ROOM {
        let across = DVec3::new(normal.z.abs(), normal.x.abs(), normal.y.abs());
        let along = normal.cross(across);
        let first = corners.len() as u32;
        for [u, v] in [[-20.0, -20.0], [20.0, -20.0], [20.0, 20.0], [-20.0, 20.0]] {
            corners.push((normal * distance + across * u + along * v).as_vec3().to_array());
        }
        faces.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    let room = mesh.add_mesh(&corners, &vec![[0.0; 2]; corners.len()], &faces).unwrap();
    add_grey(&mut mesh, Shape::Mesh(room), Pose::IDENTITY);
    [boxes, mesh]
}

/// From a point in the room to its walls.
fn to_walls(origin: DVec3, direction: DVec3) -> f64 {
    ROOM.iter()
        .map(|(normal, distance)| (distance - origin.dot(*normal)) / direction.dot(*normal))
        .filter(|range| *range > 0.0)
        .fold(f64::INFINITY, f64::min)
}

#[test]
fn every_firing_starts_where_the_sensor_is_at_its_time() {
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
                // Taken back to the world by the pose of its time, each point lies on a wall.
                let point = pose.transform_point(DVec3::from(points[index].map(f64::from)));
                let wall = ROOM.iter().map(|(normal, distance)| (distance - point.dot(*normal)).abs());
                off = off.max(wall.fold(f64::INFINITY, f64::min));
            }
            println!("frame {number}: ranges {worst:e}, deskewed points {off:e} m off");
            assert!(worst < 1e-6 && off < 2e-6, "{worst:e} {off:e}");
            assert!(ranges[scanner.firings(number)..].iter().all(|range| range.is_nan()));
        }
        // At the first moment for all, points are as far off as the lidar goes and turns in a tenth of a second.
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
fn things_are_where_they_are_at_the_time_of_a_firing() {
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
        // Nearest of all, with how far from its edge, its normal, and the thing.
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

type Met = (Option<(f64, DVec3)>, f64);

/// Where a ray meets a ball, and how far it passes from its edge.
fn ball(origin: DVec3, direction: DVec3, radius: f64) -> Met {
    let along = -origin.dot(direction);
    let aside = (origin + direction * along).length();
    let range = along - (radius * radius - aside * aside).max(0.0).sqrt();
    let hit = (aside < radius && along > 0.0).then(|| (range, (origin + direction * range) / radius));
    (hit, (aside - radius).abs())
}

fn slabs(origin: DVec3, direction: DVec3, half: DVec3) -> Met {
    let (a, b) = ((-half - origin) / direction, (half - origin) / direction);
    let (enter, leave) = (a.min(b), a.max(b));
    let range = enter.max_element();
    let normal = DVec3::AXES
        .map(|axis| axis * -direction.dot(axis).signum() * f64::from(u8::from(enter.dot(axis) == range)));
    let margin = leave.min_element() - range;
    ((margin > 0.0 && range > 0.0).then_some((range, normal[0] + normal[1] + normal[2])), margin.abs())
}

/// A convex body of triangles that run counter-clockwise seen from outside.
fn planes(origin: DVec3, direction: DVec3, corners: &[DVec3; 4], faces: &[[u32; 3]; 4]) -> Met {
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

/// Beams of an even grid from one point at one moment are a lidar's.
#[test]
fn at_one_moment_a_scanner_is_a_lidar() {
    let mut builder = SceneBuilder::new();
    scenery(&mut builder);
    let heights: Vec<f32> = (0..24 * 24).map(|cell| 0.2 * ((cell * 7 % 13) as f32 / 13.0) - 0.8).collect();
    let field = builder.add_height_field(24, 24, [12.0, 12.0], &heights).unwrap();
    add_grey(&mut builder, Shape::HeightField(field), Pose::IDENTITY);
    let vertical = Beams { samples: 16, min_angle_rad: -0.4, max_angle_rad: 0.3 };
    let horizontal = Beams { samples: 360, min_angle_rad: 0.0, max_angle_rad: TAU * 359.0 / 360.0 };
    let lidar = Lidar::new(LidarConfig::new(horizontal).vertical(vertical)).unwrap();
    let pose = Pose::from_xyz_rpy(DVec3::new(-1.2, 0.3, 1.4), DVec3::new(0.1, 0.2, -0.05));
    let capture = Capture::new(0, builder.moment(pose));
    let mut expected = vec![0.0; lidar.beams()];
    let scene = builder.scene();
    let mut memory = WorkspaceBuf::default();
    let workspace = &mut memory.lend(lidar.workspace_len(&scene, &capture));
    lidar.sense(&scene, &capture, workspace, Scan::new().ranges(&mut expected)).unwrap();
    let lasers: Vec<_> = (0..16)
        .map(|row| Laser { elevation_rad: vertical.angle(row), ..Laser::at_degrees(0.0, 0.0) })
        .collect();
    let columns = Columns::Turn { per_turn: 360, first: 0, count: 360 };
    let pattern = Spinning { lasers: &lasers, columns, first_azimuth_rad: 0.0, clockwise: false };
    let config = ScannerConfig::new(Pattern::Spinning(pattern)).range_max_m(30.0);
    let scanner = Scanner::new(config).unwrap();
    let (ranges, _) = scan(&scanner, &builder, &capture, Execution::default());
    let mut differ = 0;
    for (index, range) in ranges.iter().enumerate() {
        let (row, column) = (index % 16, index / 16);
        let expected = expected[row * 360 + column];
        differ += usize::from(!(range == &expected || (range / expected - 1.0).abs() < 1e-5));
    }
    // Some beams pass an edge.
    assert!(differ <= 2, "{differ} of {}", ranges.len());
    let met = ranges.iter().filter(|range| range.is_finite()).count();
    assert!(met > 2500, "{met}");
}

/// Columns that are fired at fixed times go on from frame to frame without a gap, and the head with them.
#[test]
fn columns_at_fixed_times_go_on_from_frame_to_frame() {
    let tower = tower();
    let scanner = Scanner::new(ScannerConfig::new(tower_of(&tower))).unwrap();
    let mut before: Option<(f64, f64)> = None;
    let mut counts = Vec::new();
    for frame in 0..40 {
        let count = scanner.firings(frame);
        counts.push(count / 16);
        for index in (0..count).step_by(16) {
            let firing = scanner.firing(frame, index);
            let time = 0.1 * frame as f64 + firing.time_s;
            let azimuth = -firing.direction.y.atan2(firing.direction.x);
            if let Some((last, angle)) = before {
                assert!((time - last - 55.296e-6).abs() < 1e-12, "frame {frame}, firing {index}");
                let turned = (azimuth - angle).rem_euclid(TAU);
                assert!((turned - TAU * 55.296e-5).abs() < 1e-9, "frame {frame}, firing {index}: {turned}");
            }
            before = Some((time, azimuth));
        }
    }
    assert_eq!(counts.iter().sum::<usize>(), (4e9_f64 / 55_296.0).ceil() as usize);
    assert!(counts.iter().all(|count| [1808, 1809].contains(count)));
    assert_eq!(scanner.most_firings(), 1809 * 16);
}

/// Brazeal's model of a Mid-40 (2021) with a Mid-70's angle: everything within 35.2° of the axis, most of it near the rim
/// and the middle, over again after 30 s.
#[test]
fn two_prisms_draw_a_rosette() {
    let rosette = Rosette {
        firing_time_ns: 10_000,
        speeds_rpm: [7294, -4664],
        wedge_rad: 29.68_f64.to_radians(),
        refractive_index: 1.51,
    };
    let scanner = Scanner::new(ScannerConfig::new(Pattern::Rosette(rosette))).unwrap();
    assert_eq!(scanner.most_firings(), 10_000);
    let (mut most, mut near, mut all) = (0.0_f64, 0, 0);
    for frame in 0..300 {
        assert_eq!(scanner.firings(frame), 10_000);
        for index in (0..10_000).step_by(7) {
            let direction = scanner.firing(frame, index).direction;
            assert!((direction.length() - 1.0).abs() < 1e-12);
            let angle = direction.x.acos().to_degrees();
            most = most.max(angle);
            near += u32::from(angle < 5.0);
            all += 1;
        }
    }
    assert!((most - 35.2).abs() < 0.05, "{most}");
    let share = 100.0 * f64::from(near) / f64::from(all);
    assert!((share - 8.7).abs() < 0.1, "{share} % within 5° of the axis");
    let again = |frame| (0..100).map(|index| scanner.firing(frame, index).direction).collect::<Vec<_>>();
    assert_eq!(again(0), again(300));
    assert_ne!(again(0), again(150));
    // A small wedge bends by (n − 1) times its angle, each on its own.
    let thin = Rosette { wedge_rad: 1e-3, ..rosette };
    let thin = Scanner::new(ScannerConfig::new(Pattern::Rosette(thin))).unwrap();
    for index in 0..1000 {
        let firing = thin.firing(2, index);
        let turn = |rpm: f64| TAU * rpm / 60.0 * (0.2 + firing.time_s);
        let (a, b) = (turn(7294.0), turn(-4664.0));
        let expected = DVec3::new(0.0, a.cos() + b.cos(), a.sin() + b.sin()) * -0.51e-3;
        let off = (firing.direction - DVec3::X - expected).length();
        assert!(off < 2e-6, "{off}");
    }
}

/// From the middle of a ball of 8 m whose surface sends 40 back.
#[test]
fn ranges_have_the_noise_that_they_are_told() {
    let mut ball = SceneBuilder::new();
    let material = ball.add_material(&MaterialConfig::default()).unwrap();
    let config = InstanceConfig {
        shape: Shape::Sphere { radius: 8.0 },
        laser_retro: 40.0,
        material,
        ..Default::default()
    };
    ball.add_instance(&config).unwrap();
    let capture = Capture::new(3, ball.moment(Pose::IDENTITY));
    let noise = GaussianNoise::new(0.1, 0.02, 0.0, 0.0, 0.002).unwrap();
    let config = presets::VLP_16.config(100_000_000).noise(noise).seed(5);
    let scanner = Scanner::new(config).unwrap();
    let (count, most) = (scanner.firings(3), scanner.most_firings());
    let (mut ranges, mut points) = (vec![0.0; most], vec![[0.0; 3]; most]);
    let (mut intensities, mut times, mut lasers) = (vec![0.0; most], vec![0.0; most], vec![0; most]);
    let output = Echoes::new().ranges(&mut ranges).points(&mut points).intensities(&mut intensities);
    let output = output.times(&mut times).lasers(&mut lasers);
    take(&scanner, &ball, &capture, Execution::default(), output).unwrap();
    let (mut sum, mut squares) = (0.0, 0.0);
    for index in 0..count {
        let firing = scanner.firing(3, index);
        let range = f64::from(ranges[index]);
        let point = firing.origin + firing.direction * range;
        assert!((point - DVec3::from(points[index].map(f64::from))).length() < 1e-6);
        assert!((range / 0.002 - (range / 0.002).round()).abs() < 1e-3, "{range}");
        assert_eq!((intensities[index], times[index], lasers[index]), (40.0, firing.time_s, firing.laser));
        // Origins are beside the middle by up to 11 mm.
        let truth = -firing.origin.dot(firing.direction)
            + (64.0 + firing.origin.dot(firing.direction).powi(2) - firing.origin.length_squared()).sqrt();
        let error = range - truth;
        (sum, squares) = (sum + error, squares + error * error);
    }
    let mean = sum / count as f64;
    let stddev = (squares / count as f64 - mean * mean).sqrt();
    // The rounding to 2 mm adds its own.
    let expected = (0.02_f64.powi(2) + 0.002_f64.powi(2) / 12.0).sqrt();
    assert!((mean - 0.1).abs() < 4.0 * 0.02 / (count as f64).sqrt(), "{mean}");
    assert!((stddev / expected - 1.0).abs() < 0.02, "{stddev}");
    assert!(count < most && times[count..].iter().all(|time| time.is_nan()));
    // Beyond its largest range there is nothing, and nearer than its smallest no measuring.
    let limited = |range: [f64; 2]| {
        let config = config.range_min_m(range[0]).range_max_m(range[1]);
        scan(&Scanner::new(config).unwrap(), &ball, &capture, Execution::default()).0[..count].to_vec()
    };
    assert!(limited([0.0, 7.9]).iter().all(|range| *range == f32::INFINITY));
    assert!(limited([8.1, 9.0]).iter().all(|range| *range == f32::NEG_INFINITY));
}

/// Rings of the manuals' tables, and what leaves the window of a VLP-16: beams meet behind it.
#[test]
fn presets_are_as_their_manuals_say() {
    let elevations = |preset: &presets::Preset| {
        let Pattern::Spinning(head) = preset.pattern else { panic!() };
        let degrees = head.lasers.iter().map(|laser| laser.elevation_rad.to_degrees());
        (degrees.collect::<Vec<_>>(), head.lasers.to_vec())
    };
    let (vlp, lasers) = elevations(&presets::VLP_16);
    assert!(
        (0..16).all(|id| (vlp[id] - if id % 2 == 0 { id as f64 - 15.0 } else { id as f64 }).abs() < 1e-12)
    );
    for (laser, id) in lasers.iter().zip(0..) {
        assert!((laser.time_s - 2.304e-6 * f64::from(id)).abs() < 1e-15);
        assert!((laser.origin_m[2] + 0.041_91 * laser.elevation_rad.tan()).abs() < 1e-7);
    }
    let (hdl, lasers) = elevations(&presets::HDL_32E);
    for id in 0..32 {
        let expected = if id % 2 == 0 { -92.0 / 3.0 } else { -28.0 / 3.0 } + (id / 2) as f64 * 4.0 / 3.0;
        assert!((hdl[id] - expected).abs() < 0.0034, "{id}: {}", hdl[id]);
        assert!((lasers[id].time_s - 1.152e-6 * id as f64).abs() < 1e-15);
    }
    assert!(
        (lasers[0].origin_m[2] - 0.017_17).abs() < 1e-5 && (lasers[31].origin_m[2] + 0.005_45).abs() < 1e-5
    );
    // 753.5 packets of 384 firings a second, 1808.4 (at 46.08 µs) for the other.
    let rate = |preset: &presets::Preset| {
        let scanner = Scanner::new(preset.config(100_000_000)).unwrap();
        (0..100).map(|frame| scanner.firings(frame)).sum::<usize>() as f64 / 384.0 / 10.0
    };
    assert!((rate(&presets::VLP_16) - 753.5).abs() < 0.1, "{}", rate(&presets::VLP_16));
    assert!((rate(&presets::HDL_32E) - 1808.4).abs() < 0.1, "{}", rate(&presets::HDL_32E));
    assert_eq!(presets::named("vlp16"), Some(presets::VLP_16));
    assert_eq!(presets::named("vlp17"), None);
}

#[test]
fn what_cannot_be_is_refused() {
    let drum = drum();
    let said = |config: ScannerConfig<'_>| Scanner::new(config).unwrap_err().to_string();
    let with = |change: &dyn Fn(&mut Vec<Laser>)| {
        let mut lasers = drum.clone();
        change(&mut lasers);
        said(ScannerConfig::new(drum_of(&lasers)))
    };
    assert_eq!(
        with(&|lasers| lasers[3].elevation_rad = f64::NAN),
        "a scanner's elevation_rad of laser 3 is NaN; it must be -π/2 to π/2"
    );
    assert_eq!(
        with(&|lasers| lasers[2].time_s = 1e-6),
        "a scanner's time_s of laser 3 is 0; it must be not before that of the laser before, and less than a column's"
    );
    assert!(with(&|lasers| lasers[31].time_s = 1e-3).starts_with("a scanner's time_s of laser 31 is 0.001"));
    assert!(
        with(&|lasers| lasers[5].origin_m[1] = f64::INFINITY)
            .starts_with("a scanner's origin_m of laser 5 is inf")
    );
    assert!(
        with(&|lasers| lasers[5].azimuth_rad = f64::NAN).starts_with("a scanner's azimuth_rad of laser 5")
    );
    assert_eq!(with(&Vec::clear), "a scanner's lasers is 0; it must be 1 to 4096 of them");
    let many = vec![Laser::at_degrees(0.0, 0.0); 4096];
    let columns = |per_turn| Columns::Turn { per_turn, first: 0, count: per_turn };
    let head = |lasers, columns| Spinning { lasers, columns, first_azimuth_rad: 0.0, clockwise: true };
    let of = |spinning| said(ScannerConfig::new(Pattern::Spinning(spinning)));
    assert_eq!(
        of(head(&many, columns(4097))),
        "a scanner's firings of a frame is 16781312; it must be 1 to 16777216"
    );
    assert!(of(head(&many, columns(0))).starts_with("a scanner's per_turn is 0"));
    assert!(
        of(head(&many, Columns::Turn { per_turn: 9, first: 5, count: 5 }))
            .starts_with("a scanner's first + count is 10")
    );
    assert!(of(head(&many, Columns::Every { time_ns: 0 })).starts_with("a scanner's time_ns is 0"));
    let ahead = Firing { time_s: 0.0, origin: DVec3::ZERO, direction: DVec3::X, laser: 0 };
    let table = |firings: &[Firing]| said(ScannerConfig::new(Pattern::Table(firings)));
    assert!(table(&[]).starts_with("a scanner's firings of a frame is 0"));
    assert!(
        table(&[ahead, Firing { direction: DVec3::ZERO, ..ahead }])
            .starts_with("a scanner's length of the direction of firing 1 is 0")
    );
    assert!(
        table(&[Firing { time_s: 0.01, ..ahead }, ahead]).starts_with("a scanner's time_s of firing 1 is 0")
    );
    assert!(table(&[Firing { time_s: 0.1, ..ahead }]).starts_with("a scanner's time_s of firing 0 is 0.1"));
    let table = [ahead];
    let plain = ScannerConfig::new(Pattern::Table(&table));
    assert_eq!(
        said(plain.range_min_m(f64::NAN)),
        "a scanner's range_min_m is NaN; it must be 0 or more, and finite"
    );
    assert!(said(plain.range_min_m(100.0)).starts_with("a scanner's range_max_m is 100"));
    assert!(said(plain.frame_time_ns(0)).starts_with("a scanner's frame_time_ns is 0"));
    let rosette =
        Rosette { firing_time_ns: 1000, speeds_rpm: [1, 2], wedge_rad: FRAC_PI_2, refractive_index: 1.5 };
    assert!(said(plain.pattern(Pattern::Rosette(rosette))).starts_with("a scanner's wedge_rad is 1.57"));

    let scanner = Scanner::new(plain).unwrap();
    let builder = SceneBuilder::new();
    let at = builder.moment(Pose::IDENTITY);
    let refused = |shutter: Shutter<'_>| {
        let mut ranges = [0.0];
        let output = Echoes::new().ranges(&mut ranges);
        take(&scanner, &builder, &Capture::new(0, shutter), Execution::default(), output)
            .unwrap_err()
            .to_string()
    };
    let keys = |times: &[f64]| times.iter().map(|&time_s| Keyframe { time_s, at }).collect::<Vec<_>>();
    let moving = |times: &[f64]| refused(Shutter::Moving(&keys(times)));
    assert_eq!(moving(&[0.0]), "keyframe 1 of the shutter must be there: motion is between two at least");
    assert_eq!(moving(&[0.0, 0.1, 0.1]), "keyframe 2 of the shutter must be later than that before it");
    assert_eq!(moving(&[0.0, f64::NAN]), "keyframe 1 of the shutter must have a time that is finite");
    assert_eq!(
        moving(&[0.01, 0.1]),
        "keyframe 0 of the shutter must be at the beginning of the frame, 0 s, or before"
    );
    assert_eq!(moving(&[0.0, 0.09]), "keyframe 1 of the shutter must be at the end of the frame or after");
    let slices = [Slice { lines: 0..1, at }];
    assert!(refused(Shutter::Slices(&slices)).starts_with("the shutter must be one moment or keyframes"));
    let lost = Moment { world_from_sensor: Pose::from_translation(DVec3::NAN), ..at };
    assert_eq!(refused(Shutter::Global(lost)), "the sensor's pose must be finite numbers");
    let short =
        take(&scanner, &builder, &Capture::new(0, at), Execution::default(), Echoes::new().ranges(&mut []));
    assert_eq!(short.unwrap_err().to_string(), "the output ranges holds 0 elements; the frame has 1");
    let mut flow = [[0.0; 2]];
    let flow = Echoes::new().truth(Truth::new().flow(&mut flow));
    let flow = take(&scanner, &builder, &Capture::new(0, at), Execution::default(), flow);
    assert!(flow.unwrap_err().to_string().starts_with("flow is not worked out where each ray"));
    // A lidar's beams have no times.
    let lidar = Lidar::new(LidarConfig::new(Beams::ONE)).unwrap();
    let (keyframes, mut ranges) = (keys(&[0.0, 1.0]), [0.0]);
    let (scene, capture) = (builder.scene(), Capture::new(0, keyframes.as_slice()));
    let mut memory = WorkspaceBuf::default();
    let workspace = &mut memory.lend(lidar.workspace_len(&scene, &capture));
    let said = lidar.sense(&scene, &capture, workspace, Scan::new().ranges(&mut ranges)).unwrap_err();
    assert_eq!(
        said.to_string(),
        "the shutter must be one moment or slices: this sensor's rays have no times"
    );
}
