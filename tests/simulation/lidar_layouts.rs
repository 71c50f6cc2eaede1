//! Clouds in the layouts of Livox's drivers, of a flash lidar, and of a head of 128 lasers.

use belvedere::description::load;
use belvedere::rig::FrameBuf;
use belvedere::simulation::{Simulation, SpawnOptions};
use belvedere_bridge::{Encoding, FrameHeader, Kind};
use belvedere_sensors::Pose;
use belvedere_sensors::scanner::presets;
use glam::DVec3;
use std::time::Duration;

/// The velocity of the sensor, which starts 6 m in front of a wall and faces its middle.
const SPEED: DVec3 = DVec3::new(5.0, 0.0, 0.0);
const START: DVec3 = DVec3::new(-1.0, 0.0, 6.0);
const WALL_X: f64 = 5.0;
const RETRO: f32 = 40.0;

/// A point of Livox's drivers.
struct Point {
    place: DVec3,
    intensity: f32,
    tag: u8,
    line: u8,
    time_ns: f64,
}

/// A cloud of a sensor that moves towards the wall.
fn cloud(own: &str, until_ms: u64) -> (FrameHeader, FrameBuf) {
    let wall = format!(
        "<sdf version='1.6'><model name='wall'><static>true</static><link name='l'><collision name='c'>
         <laser_retro>{RETRO}</laser_retro><pose>{} 0 0 0 0 0</pose>
         <geometry><box><size>1 60 60</size></box></geometry></collision></link></model></sdf>",
        WALL_X + 0.5
    );
    let robot = format!(
        "<sdf version='1.6'><model name='floating'><link name='l'><gravity>false</gravity><sensor name='s' type='ray'>
         <topic>lidar</topic><plugin filename='belvedere'>{own}</plugin></sensor></link></model></sdf>"
    );
    let mut simulation = Simulation::builder(load::world("empty").unwrap()).build().unwrap();
    simulation.spawn(&load::model(&wall).unwrap(), SpawnOptions::default()).unwrap();
    let sensor = simulation.spawn(&load::model(&robot).unwrap(), SpawnOptions::default()).unwrap();
    simulation.place(sensor, &Pose::from_translation(START), SPEED, DVec3::ZERO).unwrap();
    let mut frame = FrameBuf::default();
    // From now on, physics keeps a history of poses.
    simulation.render("lidar/points", &mut frame).unwrap();
    simulation.run_for(Duration::from_millis(until_ms));
    simulation.render("lidar/points", &mut frame).unwrap();
    (*frame.header(), frame)
}

fn livox(own: &str) -> (FrameHeader, Vec<Point>) {
    let (header, frame) = cloud(own, 300);
    assert_eq!((header.kind(), header.encoding()), (Some(Kind::PointCloud), Some(Encoding::LivoxPoint)));
    let view = frame.view();
    let points = view.numbers::<[u8; 26]>(view.rows()).map(|bytes| {
        let float = |at: usize| f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
        Point {
            place: DVec3::new(float(0).into(), float(4).into(), float(8).into()),
            intensity: float(12),
            tag: bytes[16],
            line: bytes[17],
            time_ns: f64::from_le_bytes(bytes[18..].try_into().unwrap()),
        }
    });
    (header, points.collect())
}

#[test]
fn a_mid_70_sends_the_cloud_of_livoxs_driver() {
    let (header, points) = livox("<preset>mid70</preset>");
    // Every 10 µs from the beginning of the scan; the whole cone hits the wall or the ground.
    assert_eq!(
        (header.stamp_ns, header.width, header.height, header.elem_stride),
        (200_000_000, 10_000, 1, 26)
    );
    assert_eq!(points.len(), 10_000);
    let (mut squares, mut off_stamp, mut count) = (0.0, 0.0_f64, 0.0);
    for (index, point) in points.iter().enumerate() {
        assert_eq!(point.time_ns, 2e8 + 1e4 * index as f64);
        assert_eq!((point.tag, point.line), (0, 0));
        assert!(point.place.normalize().x > 35.3_f64.to_radians().cos());
        let at = START + SPEED * point.time_ns * 1e-9;
        if (at + point.place).z < 0.3 {
            continue;
        }
        // Along the beam.
        let along = point.place.normalize().x;
        let off = ((at + point.place).x - WALL_X) / along;
        (squares, count) = (squares + off * off, count + 1.0);
        off_stamp = off_stamp.max((START + SPEED * 0.3 + point.place).x - WALL_X);
        assert_eq!(point.intensity, RETRO);
    }
    let stddev = f64::sqrt(squares / count);
    println!("σ {stddev:.4} m by each point's time, off by {off_stamp:.2} m by the end of the scan");
    assert!(count > 9000.0 && (stddev / 0.02 - 1.0).abs() < 0.03 && off_stamp > 0.4, "{stddev}");
}

/// Volleys of four lasers, 20 µs apart, some of which hit the wall and the ground; and six lasers that fire one after
/// the other.
#[test]
fn a_mid_360_and_a_hap_report_their_lasers_as_lines() {
    for (name, volley_ns, laser_ns, lasers) in [("mid360", 20_000.0, 0.0, 4_u8), ("hap", 13_274.0, 2212.0, 6)]
    {
        let (header, points) = livox(&format!("<preset>{name}</preset>"));
        assert_eq!((header.stamp_ns, header.height, header.elem_stride), (200_000_000, 1, 26));
        assert!(points.len() > 4000, "{name}: {}", points.len());
        let mut lines = [0; 6];
        for point in &points {
            assert!(point.line < lasers && point.tag == 0);
            lines[usize::from(point.line)] += 1;
            // Volleys continue independent of frames. This is the second frame, which begins 0.1 s after the first
            // volley.
            let since_first_ns = point.time_ns - header.stamp_ns as f64 + 1e8;
            let volley = (since_first_ns - laser_ns * f64::from(point.line)) / volley_ns;
            assert!((volley - volley.round()).abs() * volley_ns < 1.0, "{name}: {} ns", point.time_ns);
            let at = START + SPEED * point.time_ns * 1e-9;
            let off = ((at + point.place).x - WALL_X) / point.place.normalize().x;
            assert!((at + point.place).z < 0.3 || off.abs() < 0.15, "{name}: {}", point.place);
        }
        let lines = &lines[..usize::from(lasers)];
        let share = points.len() as f64 / lines.len() as f64;
        assert!(lines.iter().all(|line| (f64::from(*line) / share - 1.0).abs() < 0.2), "{name}: {lines:?}");
    }
}

/// Livox's scale of reflectivity: a diffuse surface of 40 % that faces the lidar has 60.
#[test]
fn livoxs_reflectivity_and_returns_are_on_its_scales() {
    let (_, points) = livox(
        "<preset>mid70</preset><intensity>reflectivity</intensity><returns>2</returns><pulse_length>0.2</pulse_length>",
    );
    assert!(points.len() >= 10_000, "{}", points.len());
    for point in points.iter().filter(|point| (START + SPEED * point.time_ns * 1e-9 + point.place).z > 1.0) {
        // The beam is 5 mrad high, and the angles of its rays at the wall differ by as much.
        let expected = 1.5 * f64::from(RETRO) * point.place.normalize().x;
        assert!((f64::from(point.intensity) / expected - 1.0).abs() < 0.01, "{}", point.intensity);
        assert_eq!(point.tag, 0);
    }
    assert!(points.iter().all(|point| point.tag == 0 || point.tag == 0x10));
}

/// All pixels have the timestamp of the frame, in rows.
#[test]
fn all_pixels_of_a_flash_lidar_have_the_same_time() {
    let (header, frame) = cloud("<preset>hfl110</preset>", 200);
    assert_eq!(header.encoding(), Some(Encoding::XyzIrtF32));
    let view = frame.view();
    let step = presets::HFL_110.resolution_m;
    let mut met = 0;
    for bytes in view.numbers::<[u8; 22]>(view.rows()) {
        let float = |at: usize| f64::from(f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()));
        let place = DVec3::new(float(0), float(4), float(8));
        assert_eq!(float(18), 0.0);
        let steps = place.length() / step;
        assert!((steps - steps.round()).abs() < 0.02, "{steps}");
        let elevation = place.z.atan2(place.truncate().length()).to_degrees();
        let ring = f64::from(u16::from_le_bytes([bytes[16], bytes[17]]));
        assert!((elevation - (-15.0 + 30.0 / 32.0 * (ring + 0.5))).abs() < 1e-3, "{elevation} {ring}");
        let off = ((START + SPEED * 0.2 + place).x - WALL_X) / place.normalize().x;
        assert!(off.abs() < 0.12 || (START + place).z < 0.3, "{place}");
        met += 1;
    }
    assert!(met > 3500, "{met}");
}

#[test]
fn a_vls_128_has_128_rings() {
    let (header, frame) = cloud("<preset>vls128</preset>", 200);
    assert_eq!(header.encoding(), Some(Encoding::XyzIrtF32));
    let view = frame.view();
    let mut seen = [0; 128];
    for bytes in view.numbers::<[u8; 22]>(view.rows()) {
        seen[usize::from(u16::from_le_bytes([bytes[16], bytes[17]]))] += 1;
        let float = |at: usize| f64::from(f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()));
        // At the timestamp, the head points ahead again; lasers point aside by up to 6.4°.
        let looks = -(float(18) / 0.1 * 360.0 + 360.0);
        let azimuth = float(4).atan2(float(0)).to_degrees();
        let aside = (azimuth - looks + 180.0).rem_euclid(360.0) - 180.0;
        assert!(aside.abs() < 6.36 && aside.abs() > 0.9, "{aside}");
    }
    // Each ring hits the wall.
    assert!(seen.iter().all(|points| *points > 400), "{seen:?}");
}
