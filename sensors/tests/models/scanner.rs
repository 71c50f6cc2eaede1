//! Scanners: every firing uses the poses of the sensor and of the objects at its own time, against closed forms.

mod mems;
mod motion;
mod patterns;
mod prisms;

use crate::common::{add_grey, scenery};
use belvedere_sensors::lidar::{Beams, Lidar, LidarConfig, Scan};
use belvedere_sensors::noise::{GaussianNoise, GaussianNoiseConfig};
use belvedere_sensors::scanner::{
    Columns, Echoes, Firing, Laser, Pattern, Rosette, Scanner, ScannerConfig, Spinning, presets,
};
use belvedere_sensors::scene::{InstanceConfig, MaterialConfig, SceneBuilder, Shape};
use belvedere_sensors::trace::{Truth, WorkspaceBuf};
use belvedere_sensors::{Capture, Execution, Keyframe, Moment, Pose, SenseError, Sensor, Shutter, Slice};
use core::f64::consts::{FRAC_PI_2, PI, TAU};
use glam::DVec3;

/// Sixteen lasers that fire one after the other, each slightly above the one below, as in a VLP-16.
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

/// Lasers that fire together, from beside the axis and at slightly different azimuths, as in an OS1.
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

/// The ranges and points of a frame.
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

/// A drive at 15 m/s that climbs and turns at 2 rad/s, with a tilted sensor.
fn drive(time_s: f64) -> Pose {
    let place = DVec3::new(15.0 * time_s - 0.7, 0.4 - 2.0 * time_s, 0.3 * time_s);
    Pose::from_xyz_rpy(place, DVec3::new(0.03, -0.02, 2.0 * time_s + 0.3))
}

/// Poses of instances at keyframes, a millisecond apart, up to the end of the frame.
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

/// The directions and distances from the middle of a room to its walls, floor and ceiling.
const ROOM: [(DVec3, f64); 6] = [
    (DVec3::X, 6.0),
    (DVec3::NEG_X, 5.0),
    (DVec3::Y, 4.0),
    (DVec3::NEG_Y, 7.0),
    (DVec3::Z, 2.5),
    (DVec3::NEG_Z, 1.5),
];

/// The walls of the room as boxes, and as a single mesh.
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

/// The distance from a point in the room to its walls.
fn to_walls(origin: DVec3, direction: DVec3) -> f64 {
    ROOM.iter()
        .map(|(normal, distance)| (distance - origin.dot(*normal)) / direction.dot(*normal))
        .filter(|range| *range > 0.0)
        .fold(f64::INFINITY, f64::min)
}
