//! Clouds of lidars whose beams have individual times: transformed to the world by the pose of the sensor at each
//! point's time, they are on the walls.

use belvedere::description::load;
use belvedere::description::model::{CloudLayout, Lidar, SensorKind};
use belvedere::rig::FrameBuf;
use belvedere::simulation::{Simulation, SpawnOptions};
use belvedere_bridge::{Encoding, FrameHeader, Kind};
use belvedere_sensors::Pose;
use belvedere_sensors::scanner::{Pattern, presets};
use glam::DVec3;
use std::f64::consts::{PI, TAU};
use std::time::Duration;

/// The velocity and the angular rate of the sensor.
const SPEED: DVec3 = DVec3::new(5.0, -2.0, 0.0);
const TURN: DVec3 = DVec3::new(0.0, 0.0, 3.0);
const START: DVec3 = DVec3::new(-1.0, 0.5, 1.5);

/// The inner faces of a room: outward normals, and distances from the origin.
const ROOM: [(DVec3, f64); 6] = [
    (DVec3::X, 6.0),
    (DVec3::NEG_X, 5.0),
    (DVec3::Y, 4.0),
    (DVec3::NEG_Y, 7.0),
    (DVec3::Z, 4.0),
    (DVec3::NEG_Z, 0.0),
];

fn room() -> String {
    let walls = ROOM[..5].iter().enumerate().map(|(index, (normal, distance))| {
        let (at, size) = (*normal * (distance + 0.5), DVec3::splat(30.0) - normal.abs() * 29.0);
        let shape = format!("<geometry><box><size>{} {} {}</size></box></geometry>", size.x, size.y, size.z);
        format!(
            "<collision name='c{index}'><laser_retro>{}</laser_retro><pose>{} {} {} 0 0 0</pose>{shape}</collision>",
            10 * (index + 1), at.x, at.y, at.z
        )
    });
    let walls = walls.collect::<String>();
    format!(
        "<sdf version='1.6'><model name='room'><static>true</static><link name='l'>{walls}</link></model></sdf>"
    )
}

/// A floating sensor, with this description of its beams.
fn floating(beams: &str) -> String {
    format!(
        "<sdf version='1.6'><model name='floating'><link name='l'><gravity>false</gravity>
         <sensor name='s' type='ray'>{beams}</sensor></link></model></sdf>"
    )
}

fn plugin(parameters: &str) -> String {
    format!(
        "<plugin name='p' filename='libgazebo_ros_velodyne_laser.so'><topicName>points</topicName>{parameters}</plugin>"
    )
}

/// Beams of a `<ray>` over half a turn.
fn grid(parameters: &str) -> String {
    format!(
        "<update_rate>10</update_rate><ray><scan>
         <horizontal><samples>91</samples><min_angle>-1.5707963267948966</min_angle><max_angle>1.5707963267948966</max_angle></horizontal>
         <vertical><samples>8</samples><min_angle>-0.35</min_angle><max_angle>0.35</max_angle></vertical></scan>
         <range><min>0.1</min><max>20</max></range></ray>{}", plugin(parameters)
    )
}

fn own(name: &str) -> String {
    format!("<plugin filename='belvedere'><preset>{name}</preset></plugin>")
}

fn preset(name: &str, parameters: &str) -> String {
    own(name) + &plugin(parameters)
}

struct Point {
    place: DVec3,
    intensity: f32,
    ring: u16,
    time_s: f64,
}

fn points(frame: &FrameBuf) -> Vec<Point> {
    let view = frame.view();
    view.numbers::<[u8; 22]>(view.rows())
        .map(|bytes| {
            let float = |at: usize| f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
            Point {
                place: DVec3::new(float(0).into(), float(4).into(), float(8).into()),
                intensity: float(12),
                ring: u16::from_le_bytes([bytes[16], bytes[17]]),
                time_s: float(18).into(),
            }
        })
        .collect()
}

/// The cloud of a sensor that has moved and turned for 0.35 s, with another of its topics at the same moment.
fn cloud(beams: &str, gazebo_compat: bool, also: &str) -> (FrameHeader, Vec<Point>, FrameBuf) {
    let world = load::world("empty").unwrap();
    let mut simulation = Simulation::builder(world).gazebo_compat(gazebo_compat).build().unwrap();
    simulation.spawn(&load::model(&room()).unwrap(), SpawnOptions::default()).unwrap();
    let sensor = simulation.spawn(&load::model(&floating(beams)).unwrap(), SpawnOptions::default()).unwrap();
    simulation.place(sensor, &Pose::from_translation(START), SPEED, TURN).unwrap();
    let (mut frame, mut other) = (FrameBuf::default(), FrameBuf::default());
    // From now on, physics keeps a history of poses.
    simulation.render("points", &mut frame).unwrap();
    simulation.run_for(Duration::from_millis(350));
    simulation.render("points", &mut frame).unwrap();
    simulation.render(also, &mut other).unwrap();
    let at = simulation.pose(sensor).unwrap();
    assert!((at.translation() - world_from_sensor(0.35).translation()).length() < 1e-4, "{at:?}");
    (*frame.header(), points(&frame), other)
}

/// The pose of the sensor this many seconds after the beginning.
fn world_from_sensor(time_s: f64) -> Pose {
    Pose::from_xyz_rpy(START + SPEED * time_s, TURN * time_s)
}

/// The distance from a point in the room to the hit of a ray.
fn to_wall(origin: DVec3, direction: DVec3) -> f64 {
    ROOM.iter()
        .map(|(normal, distance)| (distance - origin.dot(*normal)) / direction.dot(*normal))
        .filter(|range| *range > 0.0)
        .fold(f64::INFINITY, f64::min)
}

/// The distance of a point of the world from the nearest wall, and the wall's index.
fn from_wall(point: DVec3) -> (f64, usize) {
    let off = ROOM.map(|(normal, distance)| (distance - point.dot(normal)).abs());
    (0..6).map(|wall| (off[wall], wall)).min_by(|one, other| one.0.total_cmp(&other.0)).unwrap()
}

/// The largest distances of points from walls if each is transformed by the pose at its own time, or all by that at the
/// timestamp.
fn skew(points: &[Point]) -> [f64; 2] {
    let most = |time: fn(&Point) -> f64| {
        let off = points.iter().filter(|point| !point.place.is_nan());
        off.map(|point| from_wall(world_from_sensor(0.35 + time(point)).transform_point(point.place)).0)
            .fold(0.0, f64::max)
    };
    [most(|point| point.time_s), most(|_| 0.0)]
}

#[test]
fn beams_of_velodynes_plugin_have_individual_times_and_origins() {
    let (header, points, truth) = cloud(&grid(""), false, "points/truth/range");
    assert_eq!((header.kind(), header.encoding()), (Some(Kind::PointCloud), Some(Encoding::XyzIrtF32)));
    assert_eq!((header.width, header.height, header.elem_stride), (91 * 8, 1, 22));
    let [own, stamp] = skew(&points);
    println!("off by {own:.2e} m each by its time, {stamp:.2} m all by the stamp's");
    assert!(own < 5e-5 && stamp > 0.5);
    let truth = truth.view();
    let ranges: Vec<f32> = truth.numbers::<f32>(truth.rows()).collect();
    for (index, point) in points.iter().enumerate() {
        let (column, row) = (index / 8, index % 8);
        // From the left, clockwise: half a turn in half of the tenth of a second.
        assert!((point.time_s - (-0.1 + 0.05 * column as f64 / 90.0)).abs() < 1e-8, "{}", point.time_s);
        let azimuth = std::f64::consts::FRAC_PI_2 * (1.0 - column as f64 / 45.0);
        assert!((point.place.y.atan2(point.place.x) - azimuth).abs() < 1e-6);
        let up = (point.place.z / point.place.length()).asin();
        assert!((up - (-0.35 + 0.1 * row as f64)).abs() < 1e-6 && usize::from(point.ring) == row);
        assert!((point.place.length() / f64::from(ranges[index]) - 1.0).abs() < 1e-5);
        let (_, wall) = from_wall(world_from_sensor(0.35 + point.time_s).transform_point(point.place));
        assert_eq!(point.intensity, if wall == 5 { 0.0 } else { 10.0 * (wall + 1) as f32 });
    }
    // In Gazebo mode, all beams have the same time.
    let (_, points, _) = cloud(&grid(""), true, "points");
    let [own, _] = skew(&points);
    assert!(own < 3e-4 && points.iter().all(|point| point.time_s == 0.0), "{own}");
}

#[test]
fn invalid_points_are_left_out_or_nan() {
    // The ground returns no light.
    let (header, dense, _) = cloud(&grid("<min_intensity>1</min_intensity>"), false, "points");
    assert_eq!((header.height, header.width as usize), (1, dense.len()));
    let organized = grid("<min_intensity>1</min_intensity><organize_cloud>true</organize_cloud>");
    let (header, all, _) = cloud(&organized, false, "points");
    assert_eq!((header.width, header.height, all.len()), (8, 91, 8 * 91));
    let there: Vec<_> = all.iter().filter(|point| !point.place.is_nan()).collect();
    assert!(dense.len() < all.len() && dense.len() > 300, "{}", dense.len());
    assert_eq!(there.len(), dense.len());
    assert!(there.iter().zip(&dense).all(|(one, other)| one.place == other.place && one.ring == other.ring));
    // Nothing is in range.
    let (header, none, _) = cloud(&grid("<max_range>0.2</max_range>"), false, "points");
    assert_eq!((header.width, none.len()), (0, 0));
}

#[test]
fn presets_fire_as_in_their_manuals() {
    for (name, lasers, column_s, period_s) in
        [("vlp16", 16, 55.296e-6, 2.304e-6), ("hdl32e", 32, 46.08e-6, 1.152e-6)]
    {
        let (header, points, _) = cloud(&preset(name, ""), false, "points");
        assert!(header.width as usize == points.len() && points.len() > 1700 * lasers, "{}", points.len());
        let head = presets::named(name).unwrap();
        let Pattern::Spinning(head) = head.pattern else { panic!() };
        let mut order: Vec<_> = (0..lasers).collect();
        order.sort_by(|a, b| head.lasers[*a].elevation_rad.total_cmp(&head.lasers[*b].elevation_rad));
        let (mut squares, mut worst) = (0.0, 0.0_f64);
        for point in &points {
            let id = order[usize::from(point.ring)];
            let laser = &head.lasers[id];
            // A whole number of columns from one of the lasers.
            let columns = (point.time_s - points[0].time_s - period_s * id as f64) / column_s;
            let first = order[usize::from(points[0].ring)];
            let columns = columns + period_s * first as f64 / column_s;
            assert!((columns - columns.round()).abs() < 1e-3, "{columns}");
            let up = laser.origin_m[2] + point.place.truncate().length() * laser.elevation_rad.tan();
            assert!((point.place.z - up).abs() < 1e-5, "{} {up}", point.place.z);
            let pose = world_from_sensor(0.35 + point.time_s);
            let origin = DVec3::from(laser.origin_m);
            let direction = (point.place - origin).normalize();
            let truth = to_wall(pose.transform_point(origin), pose.transform_vector(direction));
            let error = (point.place - origin).length() - truth;
            squares += error * error;
            worst = worst.max(error.abs());
        }
        let stddev = (squares / points.len() as f64).sqrt();
        println!("{name}: {} points, σ {stddev:.4} m, at most {worst:.3} m", points.len());
        let device = presets::named(name).unwrap();
        // The contribution of the rounding of ranges.
        let expected = device.stddev_m.hypot(device.resolution_m / f64::sqrt(12.0));
        assert!((stddev / expected - 1.0).abs() < 0.02 && worst < 6.0 * expected, "{stddev} {worst}");
    }
}

/// An image whose rows are lasers and whose columns are directions, from a sensor that moves and turns.
#[test]
fn ousters_clouds_are_images_of_directions() {
    for (name, lasers, columns) in [("os0_128", 128, 1024), ("os1_64", 64, 512)] {
        let own = format!(
            "<plugin filename='belvedere'><preset>{name}</preset><columns>{columns}</columns></plugin>"
        );
        let (header, _, frame) = cloud(&(own + &plugin("")), false, "points");
        assert_eq!(header.encoding(), Some(Encoding::OusterPoint));
        assert_eq!((header.width, header.height, header.elem_stride), (columns, lasers, 48));
        assert_eq!(header.stamp_ns, 250_000_000);
        let Pattern::Spinning(head) = presets::named(name).unwrap().pattern else { panic!() };
        let (mut count, mut squares, mut seen) = (0.0, 0.0, [0; 6]);
        let view = frame.view();
        for (pixel, bytes) in view.numbers::<[u8; 48]>(view.rows()).enumerate() {
            let (row, column) = (pixel / columns as usize, pixel % columns as usize);
            let f32_at = |at: usize| f64::from(f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()));
            let u32_at = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
            let u16_at = |at: usize| u16::from_le_bytes(bytes[at..at + 2].try_into().unwrap());
            assert_eq!(usize::from(u16_at(26)), row);
            let (laser, time_s) = (&head.lasers[row], f64::from(u32_at(20)) * 1e-9);
            let turned = time_s / 0.1 * f64::from(columns);
            assert!((turned - turned.round()).abs() < 1e-5 && turned < f64::from(columns) - 0.5);
            // Clockwise from behind: within half a column of the column's direction.
            let looks = PI - TAU * time_s / 0.1;
            let off = looks + laser.azimuth_rad - (PI - TAU * column as f64 / f64::from(columns));
            let off = (off + PI).rem_euclid(TAU) - PI;
            assert!(off.abs() < (0.5 + 1e-5) * TAU / f64::from(columns), "{off}");
            let point = DVec3::new(f32_at(0), f32_at(4), f32_at(8));
            if point.is_nan() {
                assert_eq!(u32_at(32), 0);
                continue;
            }
            let [along, _, up] = laser.origin_m;
            let origin = DVec3::new(along * looks.cos(), along * looks.sin(), up);
            let direction = (point - origin).normalize();
            assert!((direction.z.asin() - laser.elevation_rad).abs() < 1e-5);
            let azimuth = direction.y.atan2(direction.x) - looks - laser.azimuth_rad;
            assert!(((azimuth + PI).rem_euclid(TAU) - PI).abs() < 1e-5);
            let (measured, pose) = ((point - origin).length(), world_from_sensor(0.25 + time_s));
            // Measured from the axis.
            assert!((f64::from(u32_at(32)) * 1e-3 - measured - along).abs() < 0.51e-3);
            let truth = to_wall(pose.transform_point(origin), pose.transform_vector(direction));
            (count, squares) = (count + 1.0, squares + (measured - truth).powi(2));
            let intensity = f32_at(16);
            seen[(intensity / 10.0) as usize] += 1;
            assert_eq!(f64::from(u16_at(24)), intensity);
        }
        let stddev = (squares / count).sqrt();
        println!("{name}: {count} points, σ {stddev:.5} m; {seen:?}");
        assert!(count > 0.9 * f64::from(lasers * columns) && seen.iter().all(|wall| *wall > 100));
        assert!((stddev / 0.015 - 1.0).abs() < 0.02, "{stddev}");
    }
}

/// Ranges of a scan, from the pose of the sensor at the time of each ray.
#[test]
fn scanners_of_one_beam_send_scans() {
    let laser = "<plugin name='p' filename='libgazebo_ros_laser.so'><topicName>points</topicName></plugin>";
    for (name, beams, first_deg, step_deg, rate_hz) in [
        ("urg04lx", 682, -340.0 * 360.0 / 1024.0, 360.0 / 1024.0, 10.0),
        ("utm30lx", 1081, -135.0, 0.25, 40.0),
        ("lms111", 1081, -135.0, 0.25, 25.0),
        ("rplidar_a1", 360, -180.0, 1.0, 5.5),
        ("rplidar_a2", 800, -180.0, 0.45, 10.0),
    ] {
        let head = presets::named(name).unwrap();
        let (header, _, frame) = cloud(&format!("{}{laser}", own(name)), false, "points");
        let geometry = header.scan_geometry().unwrap();
        assert_eq!((header.kind(), header.width, header.height), (Some(Kind::LaserScan), beams, 1));
        assert!((geometry.angle_min.to_degrees() - first_deg).abs() < 1e-9);
        assert!((geometry.angle_increment.to_degrees() - step_deg).abs() < 1e-12);
        assert!((geometry.scan_time - 1.0 / rate_hz).abs() < 1e-8);
        assert!((geometry.time_increment - step_deg / 360.0 / rate_hz).abs() < 1e-11);
        let view = frame.view();
        let ranges: Vec<f32> = view.numbers::<f32>(view.rows()).collect();
        let (mut sum, mut squares, mut count) = (0.0, 0.0, 0.0);
        for (ray, range) in ranges.into_iter().enumerate() {
            let time_s = header.stamp_ns as f64 * 1e-9 + geometry.time_increment * ray as f64;
            let pose = world_from_sensor(time_s);
            let azimuth = geometry.angle_min + geometry.angle_increment * ray as f64;
            let direction = pose.transform_vector(DVec3::new(azimuth.cos(), azimuth.sin(), 0.0));
            let truth = ROOM
                .iter()
                .map(|(normal, distance)| {
                    (distance - pose.translation().dot(*normal)) / direction.dot(*normal)
                })
                .filter(|range| *range > 0.0)
                .fold(f64::INFINITY, f64::min);
            if truth < head.range_m[1] - 0.2 {
                let spread = |r: f64| match name {
                    "urg04lx" => 0.01 / 3.0 * r.max(1.0),
                    "utm30lx" => {
                        if r < 10.0 {
                            0.01
                        } else {
                            0.03
                        }
                    }
                    "lms111" => 0.012,
                    "rplidar_a1" => 3.3e-4 * r * r,
                    _ => 0.01 / 3.0 * r,
                };
                let error = (f64::from(range) - truth) / spread(truth);
                (sum, squares, count) = (sum + error, squares + error * error, count + 1.0);
            }
        }
        let mean = sum / count;
        let stddev = (squares / count - mean * mean).sqrt();
        println!("{name}: {count} rays, {mean:.3} ± {stddev:.3} σ");
        // Four standard errors for this many rays; systematic errors are up to three of their own standard deviations.
        let systematic = 3.0 * head.bias_stddev_m / 0.012;
        assert!(mean.abs() < 4.0 / f64::sqrt(count) + systematic, "{name}: {mean}");
        assert!((stddev - 1.0).abs() < 4.0 / f64::sqrt(2.0 * count), "{name}: {stddev}");
    }
}

#[test]
fn the_preset_of_a_file_selects_the_scanner() {
    let plugin =
        "<plugin name='p' filename='libgazebo_ros_velodyne_gpu_laser.so'><ros><namespace>/car</namespace>
        <remapping>~/out:=points</remapping></ros><frame_name>velodyne</frame_name>
        <organize_cloud>true</organize_cloud><min_intensity>3</min_intensity></plugin>";
    let read = |beams: &str| load::model(&floating(beams)).map(|mut model| model.sensors.remove(0));
    // Without an <update_rate> it has its default rate; ranges and noise are its own.
    let sensor = read(&format!("{}{plugin}", own("vlp16"))).unwrap();
    assert_eq!(sensor.effective_rate_hz(), Some(10.0));
    let SensorKind::Ray(Lidar { ray, plugin: Some(laser), preset: Some(device), .. }) = sensor.kind else {
        panic!()
    };
    assert_eq!(device.name, "vlp16");
    assert_eq!((ray.range_min_m, ray.range_max_m, ray.noise.precision), (1.0, 100.0, 0.002));
    assert_eq!((laser.topic.as_str(), laser.frame_name.as_str()), ("/car/points", "velodyne"));
    assert_eq!(laser.cloud, Some(CloudLayout { is_organized: true, min_intensity: 3.0 }));
    // As in gz-sim.
    let sensor =
        read(&format!("<topic>lidar</topic><update_rate>20</update_rate>{}", own("hdl32e"))).unwrap();
    let SensorKind::Ray(Lidar { plugin: Some(laser), .. }) = sensor.kind else { panic!() };
    assert_eq!((laser.topic.as_str(), laser.cloud), ("/lidar/points", Some(CloudLayout::default())));
    // Columns and rates from the available choices.
    let columns = |name: &str, columns: &str, rate: &str| {
        let own = own(name).replace("</preset>", &format!("</preset><columns>{columns}</columns>"));
        format!("<update_rate>{rate}</update_rate>{own}")
    };
    for (text, rate_hz, samples) in [
        (own("os1_32"), 10.0, 1024),
        (columns("os1_32", "512", "20"), 20.0, 512),
        (format!("<update_rate>20</update_rate>{}", own("os1_32")), 20.0, 1024),
        (own("lms511"), 25.0, 1141),
        (format!("<update_rate>50</update_rate>{}", own("lms111")), 50.0, 541),
    ] {
        let sensor = read(&text).unwrap();
        assert_eq!(sensor.effective_rate_hz(), Some(rate_hz));
        let SensorKind::Ray(Lidar { ray, .. }) = sensor.kind else { panic!() };
        assert_eq!(ray.horizontal.samples, samples);
    }
    for (text, expected) in [
        (own("vlp-16"), "<preset> of sensor 's' is 'vlp-16', which does not exist; did you mean 'vlp16'?"),
        (format!("<update_rate>30</update_rate>{}", own("vlp16")), "<update_rate> of sensor 's' is 30"),
        (
            columns("os2_32", "2048", "20"),
            "<columns> of sensor 's' is 2048, <update_rate> of sensor 's' is 20, which is not a mode of os2_32; \
             choose from 1024 columns at 10 Hz, 1024 columns at 20 Hz, 512 columns at 10 Hz",
        ),
        (columns("lms511", "1e3", "25"), "<columns> of sensor 's' is 1e3"),
        (columns("vlp16", "1800", "10"), "write a rate from 5 to 20 Hz, or none for 10 Hz, and no <columns>"),
        (
            own("os1_32").replace("</plugin>", "<udp_profile_lidar>RNG20</udp_profile_lidar></plugin>"),
            "<udp_profile_lidar> of sensor 's' is 'RNG20', which is not a profile of it; choose from LEGACY",
        ),
    ] {
        let refused = read(&text).unwrap_err().to_string();
        assert!(refused.contains(expected), "{refused}");
    }
}
