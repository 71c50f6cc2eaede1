//! A lidar that turns and moves while it scans: the range of each beam against that from the lidar's pose at its time.

use crate::common::{LIDAR, add_grey, scenery};
use belvedere_sensors::lidar::{Beams, Lidar, LidarConfig, Scan, Sweep};
use belvedere_sensors::noise::GaussianNoise;
use belvedere_sensors::scene::{Scene, SceneBuilder, Shape};
use belvedere_sensors::simd::Level;
use belvedere_sensors::trace::{Truth, WorkspaceBuf};
use belvedere_sensors::{Capture, Execution, Moment, Pose, SenseError, Sensor, Shutter, Slice};
use core::f64::consts::{PI, TAU};
use glam::DVec3;

fn take(
    lidar: &Lidar,
    scene: &Scene<'_>,
    capture: &Capture<'_>,
    output: Scan<'_>,
    execution: Execution,
) -> Result<(), SenseError> {
    let mut memory = WorkspaceBuf::default();
    memory.execution = execution;
    lidar.sense(scene, capture, &mut memory.lend(lidar.workspace_len(scene, capture)), output)
}

/// All outputs of a lidar except flow, bit by bit.
fn scan(lidar: &Lidar, scene: &Scene<'_>, capture: &Capture<'_>, execution: Execution) -> Vec<Vec<u32>> {
    let count = lidar.beams();
    let (mut ranges, mut intensities) = (vec![7.0_f32; count], vec![7.0_f32; count]);
    let mut points = vec![[7.0_f32; 3]; count];
    let (mut depth, mut range, mut incidence) =
        (vec![7.0_f32; count], vec![7.0_f32; count], vec![7.0_f32; count]);
    let (mut normal, mut instance, mut class) = (vec![[7.0_f32; 3]; count], vec![7; count], vec![7; count]);
    let truth = Truth::new()
        .depth(&mut depth)
        .range(&mut range)
        .normal(&mut normal)
        .instance(&mut instance)
        .class(&mut class)
        .incidence(&mut incidence);
    let output =
        Scan::new().ranges(&mut ranges).points(&mut points).intensities(&mut intensities).truth(truth);
    take(lidar, scene, capture, output, execution).unwrap();
    let bits = |values: &[f32]| values.iter().map(|value| value.to_bits()).collect();
    vec![
        bits(&ranges),
        bits(points.as_flattened()),
        bits(&intensities),
        bits(&depth),
        bits(&range),
        bits(normal.as_flattened()),
        bits(&incidence),
        instance,
        class,
    ]
}

fn slices<'a>(columns: u32, of: u32, at: impl Fn(u32) -> Moment<'a>) -> Vec<Slice<'a>> {
    let first = (0..of).step_by(columns as usize);
    first.map(|column| Slice { lines: column..(column + columns).min(of), at: at(column) }).collect()
}

/// A turn of 360 columns with this number of scan lines.
fn turn(rings: u32) -> LidarConfig {
    let step = TAU / 360.0;
    let vertical = Beams { samples: rings, min_angle_rad: -0.3, max_angle_rad: 0.25 };
    let vertical = if rings == 1 { Beams::ONE } else { vertical };
    LidarConfig::new(Beams { samples: 360, min_angle_rad: -PI, max_angle_rad: PI - step })
        .vertical(vertical)
        .range_max_m(100.0)
}

/// A room of four walls, seen by a lidar that drives at 15 m/s and turns at 3 rad/s; one scan takes a tenth of a
/// second.
#[test]
fn beams_start_at_the_pose_of_the_lidar_at_their_time() {
    let walls = [(DVec3::X, 6.0), (DVec3::NEG_X, 5.0), (DVec3::Y, 4.0), (DVec3::NEG_Y, 7.0)];
    let mut builder = SceneBuilder::new();
    for (normal, distance) in walls {
        let size = [0.2, 400.0, 400.0];
        let turned = DVec3::Z * normal.y.atan2(normal.x);
        add_grey(&mut builder, Shape::Box { size }, Pose::from_xyz_rpy(normal * (distance + 0.1), turned));
    }
    let scene = builder.scene();
    let pose_at = |column: u32| {
        let time = 0.1 * f64::from(column) / 360.0;
        Pose::from_xyz_rpy(DVec3::new(15.0 * time - 0.7, 0.4, 0.3 * time), DVec3::new(0.0, 0.02, 3.0 * time))
    };
    for (rings, columns) in [(1, 1), (16, 1), (33, 1), (16, 6), (64, 25)] {
        let lidar = Lidar::new(turn(rings)).unwrap();
        let slices = slices(columns, 360, |column| builder.moment(pose_at(column)));
        let capture = Capture::new(0, slices.as_slice());
        let mut ranges = vec![0.0; lidar.beams()];
        take(&lidar, &scene, &capture, Scan::new().ranges(&mut ranges), Execution::default()).unwrap();
        let mut worst = 0.0_f64;
        for (beam, &range) in ranges.iter().enumerate() {
            let (ring, column) = ((beam / 360) as u32, (beam % 360) as u32);
            let (azimuth, elevation) =
                (lidar.config().horizontal.angle(column), lidar.config().vertical.angle(ring));
            let beam =
                DVec3::new(azimuth.cos() * elevation.cos(), azimuth.sin() * elevation.cos(), elevation.sin());
            let pose = pose_at(column / columns * columns);
            let (origin, direction) = (pose.translation(), pose.rotation() * beam);
            let expected = walls
                .iter()
                .map(|(normal, distance)| (distance - origin.dot(*normal)) / direction.dot(*normal))
                .filter(|range| *range > 0.0)
                .fold(f64::INFINITY, f64::min);
            worst = worst.max((f64::from(range) / expected - 1.0).abs());
        }
        assert!(worst < 1e-6, "{rings} rings, {columns} columns a slice: {worst:e} off");
    }
    // With a single moment for all, the errors of beams are as large as the lidar's motion in a tenth of a second.
    let lidar = Lidar::new(turn(1)).unwrap();
    let mut ranges = vec![0.0; 360];
    let once = Capture::new(0, builder.moment(pose_at(0)));
    take(&lidar, &scene, &once, Scan::new().ranges(&mut ranges), Execution::default()).unwrap();
    let ahead = pose_at(180).translation().x - pose_at(0).translation().x;
    assert!((ahead - 0.75).abs() < 1e-9 && (ranges[180] - 6.7).abs() < 1e-2, "{}", ranges[180]);
}

/// A ball that moves across while the lidar stands still: it is hit at its position when the beams pass.
#[test]
fn objects_are_hit_at_their_poses_at_the_time_of_a_column() {
    let mut builder = SceneBuilder::new();
    add_grey(&mut builder, Shape::Sphere { radius: 0.5 }, Pose::IDENTITY);
    let scene = builder.scene();
    let lidar = Lidar::new(turn(1)).unwrap();
    let place = |column: u32| DVec3::new(4.0, 0.02 * (f64::from(column) - 180.0), 0.0);
    let poses: Vec<_> = (0..360).map(|column| [Pose::from_translation(place(column))]).collect();
    let moment = |column: u32| Moment {
        world_from_sensor: Pose::IDENTITY,
        world_from_instance: &poses[column as usize],
    };
    let slices = slices(1, 360, moment);
    let mut ranges = vec![0.0; 360];
    let capture = Capture::new(0, slices.as_slice());
    take(&lidar, &scene, &capture, Scan::new().ranges(&mut ranges), Execution::default()).unwrap();
    let mut met = 0;
    for column in 0..360 {
        let azimuth = lidar.config().horizontal.angle(column);
        let direction = DVec3::new(azimuth.cos(), azimuth.sin(), 0.0);
        let along = place(column).dot(direction);
        let squared = 0.25 - (place(column) - direction * along).length_squared();
        let range = f64::from(ranges[column as usize]);
        if along > 0.0 && squared > 1e-6 {
            met += 1;
            assert!((range - (along - squared.sqrt())).abs() < 1e-5, "column {column}: {range}");
        } else if squared < -1e-6 || along < 0.0 {
            assert_eq!(range, f64::INFINITY, "column {column}");
        }
    }
    // At one moment it is 14° wide; moving with the beams, it covers 20°.
    assert!((19..22).contains(&met), "{met} beams");
}

/// Columns at one moment, however they are divided, give the scan of that moment: every channel, including noise.
#[test]
fn columns_at_one_moment_give_the_scan_of_that_moment() {
    let mut builder = SceneBuilder::new();
    scenery(&mut builder);
    let scene = builder.scene();
    let pose = Pose::from_xyz_rpy(DVec3::new(-3.2, 0.3, 1.4), DVec3::new(0.1, 0.2, -0.05));
    let moment = builder.moment(pose);
    let noise = GaussianNoise::of_stddev(0.01).unwrap();
    let once = Capture::new(3, moment);
    for (config, columns) in [(LIDAR.noise(noise), 720), (turn(16).noise(noise), 360), (turn(40), 360)] {
        let lidar = Lidar::new(config).unwrap();
        let expected = scan(&lidar, &scene, &once, Execution::default());
        for cut in [1, 5, 16, 100, 719] {
            let slices = slices(cut, columns, |_| moment);
            let sliced = Capture::new(3, slices.as_slice());
            let rings = config.vertical.samples;
            let mut executions = vec![Execution::default()];
            if cut == 5 {
                executions.push(Execution::at(Level::baseline()));
                #[cfg(feature = "rayon")]
                executions.push(Execution::parallel());
            }
            for execution in executions {
                let channels = scan(&lidar, &scene, &sliced, execution);
                for (channel, (own, expected)) in channels.iter().zip(&expected).enumerate() {
                    assert!(own == expected, "channel {channel} of {rings} rings in slices of {cut}");
                }
            }
        }
    }
    // Overlapping lines belong to the first slice.
    let elsewhere = builder.moment(Pose::IDENTITY);
    let both = [Slice { lines: 0..360, at: moment }, Slice { lines: 17..360, at: elsewhere }];
    let lidar = Lidar::new(turn(1)).unwrap();
    let expected = scan(&lidar, &scene, &once, Execution::default());
    assert!(scan(&lidar, &scene, &Capture::new(3, &both[..]), Execution::default()) == expected);
    // A nodding lidar is divided by lines.
    let lidar = Lidar::new(turn(16).sweep(Sweep::Rows)).unwrap();
    let lines = slices(3, 16, |_| moment);
    let expected = scan(&lidar, &scene, &once, Execution::default());
    assert!(scan(&lidar, &scene, &Capture::new(3, lines.as_slice()), Execution::default()) == expected);
}

#[test]
fn invalid_slices_are_refused() {
    let builder = SceneBuilder::new();
    let scene = builder.scene();
    let moment = builder.moment(Pose::IDENTITY);
    let lidar = Lidar::new(turn(4)).unwrap();
    let refused = |shutter: Shutter<'_>, wants_flow: bool| {
        let (mut ranges, mut flow) = (vec![0.0; lidar.beams()], vec![[0.0; 2]; lidar.beams()]);
        let mut output = Scan::new().ranges(&mut ranges);
        if wants_flow {
            output = output.truth(Truth::new().flow_back(&mut flow));
        }
        let capture = Capture::new(0, shutter).before(moment);
        take(&lidar, &scene, &capture, output, Execution::default()).unwrap_err().to_string()
    };
    let short = slices(4, 356, |_| moment);
    let said = refused(Shutter::Slices(&short), false);
    assert_eq!(said, "slice 89 of the shutter must exist: no slice contains the last lines");
    let beyond = slices(4, 364, |_| moment);
    let said = refused(Shutter::Slices(&beyond), false);
    assert_eq!(
        said,
        "slice 90 of the shutter must have at least one line, and none beyond the frame's last line"
    );
    let gap = [Slice { lines: 0..10, at: moment }, Slice { lines: 11..360, at: moment }];
    let said = refused(Shutter::Slices(&gap), false);
    assert_eq!(said, "slice 1 of the shutter must begin no later than where the lines before it end");
    let whole = slices(4, 360, |_| moment);
    let said = refused(Shutter::Slices(&whole), true);
    assert!(said.starts_with("flow is not computed for a lidar whose columns"), "{said}");
    let said = refused(Shutter::Slices(&[]), false);
    assert_eq!(said, "slice 0 of the shutter must exist: no slice contains the last lines");
}
