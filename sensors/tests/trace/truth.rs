//! Ground truth of each pixel: channels that agree with each other and with grids at single moments, and flow against
//! the projection of the same points in double precision, through lenses and rolling shutters.
#![allow(clippy::large_types_passed_by_value, reason = "configurations made where they are used read better")]

use crate::common;

use crate::common::{camera_of, scenery};
use belvedere_sensors::camera::{Camera, CameraConfig, Picture};
use belvedere_sensors::optics::{Intrinsics, KannalaBrandt, Lens, Optics, Pinhole, RayTableBuf};
use belvedere_sensors::scene::{InstanceConfig, Scene, SceneBuilder, Shape, visibility};
use belvedere_sensors::simd::{Level, best_level};
use belvedere_sensors::trace::{
    Faces, Hits, SeenBox, Truth, WorkspaceBuf, cast_grid, grid_workspace_len, seen_boxes,
};
use belvedere_sensors::{Capture, Moment, Pose, SenseError, Sensor, Slice};
use glam::{DVec2, DVec3, Vec3};

const SIZE: [u32; 2] = [163, 121];
const NOTHING: u32 = u32::MAX;

/// All channels of a frame.
struct Known {
    depth: Vec<f32>,
    range: Vec<f32>,
    normal: Vec<[f32; 3]>,
    instance: Vec<u32>,
    class: Vec<u32>,
    incidence: Vec<f32>,
    flow: Vec<[f32; 2]>,
    flow_back: Vec<[f32; 2]>,
}

fn truth(scene: &Scene<'_>, config: CameraConfig<'_>, capture: &Capture<'_>) -> Known {
    truth_at(best_level(), scene, config, capture)
}

fn truth_at(level: Level, scene: &Scene<'_>, config: CameraConfig<'_>, capture: &Capture<'_>) -> Known {
    let camera = Camera::new(config).unwrap();
    let rays = camera.size().iter().product();
    let mut known = Known {
        depth: vec![7.0; rays],
        range: vec![7.0; rays],
        normal: vec![[7.0; 3]; rays],
        instance: vec![7; rays],
        class: vec![7; rays],
        incidence: vec![7.0; rays],
        flow: vec![[7.0; 2]; rays],
        flow_back: vec![[7.0; 2]; rays],
    };
    let mut channels = Truth::new()
        .depth(&mut known.depth)
        .range(&mut known.range)
        .normal(&mut known.normal)
        .instance(&mut known.instance)
        .class(&mut known.class)
        .incidence(&mut known.incidence);
    if capture.after.is_some() {
        channels = channels.flow(&mut known.flow);
    }
    if capture.before.is_some() {
        channels = channels.flow_back(&mut known.flow_back);
    }
    let mut memory = WorkspaceBuf::default();
    memory.execution.level = level;
    camera.sense_in(&mut memory, scene, capture, Picture::new().truth(channels)).unwrap();
    known
}

/// Range, normal and instance of a grid at one moment, from the interface of the tracer.
fn cast(
    scene: &Scene<'_>,
    optics: &Optics<'_>,
    at: &Moment<'_>,
    range: [f64; 2],
) -> (Vec<f32>, Vec<[f32; 3]>, Vec<u32>) {
    let rays = optics.size().iter().product();
    let mut found = (vec![0.0; rays], vec![[0.0; 3]; rays], vec![0; rays]);
    let hits = Hits {
        distance: Some(&mut found.0),
        normal: Some(&mut found.1),
        instance: Some(&mut found.2),
        ..Hits::default()
    };
    let mut memory = WorkspaceBuf::default();
    let workspace = &mut memory.lend(grid_workspace_len(scene, optics));
    cast_grid(scene, at, optics, range, visibility::VISUAL, Faces::Front, workspace, hits).unwrap();
    found
}

/// A scene with a class for each instance, and its poses at three times.
struct Story {
    builder: SceneBuilder,
    moving: usize,
}

impl Story {
    fn new() -> Self {
        let mut builder = SceneBuilder::new();
        let moving = scenery(&mut builder).0 as usize;
        builder
            .add_instance(&InstanceConfig {
                shape: Shape::Cylinder { radius: 0.3, length: 1.0 },
                world_from_instance: Pose::from_translation(DVec3::new(1.0, -1.0, 1.0)),
                class: 42,
                ..Default::default()
            })
            .unwrap();
        Self { builder, moving }
    }

    fn poses(&self, time: f64) -> Vec<Pose> {
        let mut poses = self.builder.poses().to_vec();
        let turn = Pose::from_xyz_rpy(DVec3::new(0.05, -0.1, 0.02) * time, DVec3::new(0.1, 0.02, 0.2) * time);
        let moved = poses[self.moving];
        poses[self.moving] =
            Pose::new(moved.translation() + turn.translation(), turn.rotation() * moved.rotation());
        poses
    }

    fn sensor(time: f64) -> Pose {
        let at = DVec3::new(-3.2, 0.3, 1.4) + DVec3::new(0.06, 0.04, -0.03) * time;
        Pose::from_xyz_rpy(at, DVec3::new(0.1 + 0.03 * time, 0.2, -0.05 - 0.04 * time))
    }
}

fn fisheye() -> KannalaBrandt {
    let lens = Intrinsics { fx: 52.0, fy: 51.0, cx: 80.5, cy: 61.0, skew: 0.0 };
    KannalaBrandt::new(lens, [0.02, -0.004, 0.001, 0.0]).unwrap()
}

#[test]
fn channels_agree() {
    let story = Story::new();
    let (scene, poses) = (story.builder.scene(), story.poses(0.3));
    let table = RayTableBuf::from_lens(SIZE[0], SIZE[1], &fisheye()).unwrap();
    let rolling: Vec<_> = (0..SIZE[1]).map(|row| f64::from(row) / f64::from(SIZE[1])).collect();
    let poses_of: Vec<_> = rolling.iter().map(|&time| story.poses(time)).collect();
    let at = |row: usize| Moment {
        world_from_sensor: Story::sensor(rolling[row]),
        world_from_instance: &poses_of[row],
    };
    for config in [camera_of(SIZE, 1.4), CameraConfig::new(&table)] {
        let is_table = matches!(config.optics, Optics::Table(_));
        // For a table in blocks of 4 × 4, each slice has four rows.
        let lines = if is_table { 4 } else { 1 };
        let slices: Vec<_> = (0..SIZE[1])
            .step_by(lines)
            .map(|row| Slice { lines: row..(row + lines as u32).min(SIZE[1]), at: at(row as usize) })
            .collect();
        let once = Moment { world_from_sensor: Story::sensor(0.3), world_from_instance: &poses };
        for capture in [Capture::new(0, once), Capture::new(0, slices.as_slice())] {
            let known = truth(&scene, config, &capture);
            let is_rolling = matches!(capture.shutter, belvedere_sensors::Shutter::Slices(_));
            let width = SIZE[0] as usize;
            let mut hits = 0;
            for row in 0..SIZE[1] as usize {
                let moment = if is_rolling { at(row / lines * lines) } else { once };
                if row % if is_rolling { lines } else { SIZE[1] as usize } == 0 {
                    // Checked below for the rows that the moment covers.
                    let last =
                        if is_rolling { (row + lines).min(SIZE[1] as usize) } else { SIZE[1] as usize };
                    let (range, normal, instance) =
                        cast(&scene, &config.optics, &moment, [config.near_m, config.far_m]);
                    let rays = row * width..last * width;
                    assert!(known.range[rays.clone()] == range[rays.clone()], "row {row}");
                    assert!(known.instance[rays.clone()] == instance[rays.clone()], "row {row}");
                    assert!(known.normal[rays.clone()] == normal[rays], "row {row}");
                }
                for column in 0..width {
                    let ray = row * width + column;
                    let instance = known.instance[ray];
                    assert_eq!(instance == NOTHING, known.range[ray] == f32::INFINITY);
                    assert_eq!(instance == NOTHING, known.depth[ray] == f32::INFINITY);
                    assert_eq!(instance == NOTHING, known.incidence[ray].is_nan());
                    if instance == NOTHING {
                        assert_eq!((known.class[ray], known.normal[ray]), (0, [0.0; 3]));
                        continue;
                    }
                    hits += 1;
                    let is_post = instance as usize + 1 == scene.instances().len();
                    assert_eq!(known.class[ray], if is_post { 42 } else { 0 });
                    let pixel = DVec2::new(column as f64, row as f64);
                    let optical = if is_table {
                        fisheye().unproject(pixel).unwrap()
                    } else {
                        common::pinhole(&config).lens().unproject(pixel).unwrap()
                    }
                    .normalize();
                    let cosine = f64::from(known.depth[ray]) / f64::from(known.range[ray]);
                    assert!((cosine - optical.z).abs() < 1e-5, "{cosine} {}", optical.z);
                    let in_world = moment
                        .world_from_sensor
                        .transform_vector(DVec3::new(optical.z, -optical.x, -optical.y));
                    let facing = -in_world.dot(Vec3::from_array(known.normal[ray]).as_dvec3());
                    assert!((f64::from(known.incidence[ray]).cos() - facing).abs() < 1e-5);
                }
            }
            assert!(hits > 5000, "{hits} pixels hit something");
        }
    }
}

#[test]
fn same_bits_at_every_level() {
    let story = Story::new();
    let (scene, [now, then]) = (story.builder.scene(), [0.0, 1.0].map(|time| story.poses(time)));
    let table = RayTableBuf::from_lens(SIZE[0], SIZE[1], &fisheye()).unwrap();
    let at = |time, poses| Moment { world_from_sensor: Story::sensor(time), world_from_instance: poses };
    let capture = Capture::new(0, at(0.0, &now)).after(at(1.0, &then));
    let best = best_level();
    let mut levels = vec![best];
    #[cfg(target_arch = "x86_64")]
    levels.extend(best.as_avx2().map(Level::Avx2));
    for config in [camera_of(SIZE, 1.4), CameraConfig::new(&table)] {
        let bytes = |level| {
            let known = truth_at(level, &scene, config, &capture);
            let lengths = [known.depth, known.range, known.incidence].concat();
            let vectors = [known.normal.into_flattened(), known.flow.into_flattened()].concat();
            let numbers = [known.instance, known.class].concat();
            let bits = lengths.into_iter().chain(vectors).map(f32::to_bits);
            bits.chain(numbers).collect::<Vec<_>>()
        };
        let expected = bytes(Level::baseline());
        assert!(levels.iter().all(|&level| bytes(level) == expected));
    }
}

/// The pixel that sees the point of another pixel at another moment, in double precision.
fn flow_of(
    lens: &dyn Lens,
    pixel: DVec2,
    range: f64,
    now: (&Pose, &Pose),
    then: (&Pose, &Pose),
) -> Option<DVec2> {
    let optical = lens.unproject(pixel)?.normalize() * range;
    let in_sensor = DVec3::new(optical.z, -optical.x, -optical.y);
    let in_instance = now.1.inverse().transform_point(now.0.transform_point(in_sensor));
    let moved = then.0.inverse().transform_point(then.1.transform_point(in_instance));
    lens.project(DVec3::new(-moved.y, -moved.z, moved.x)).map(|to| to - pixel)
}

#[test]
fn flow_leads_to_the_same_point() {
    let story = Story::new();
    let scene = story.builder.scene();
    let table = RayTableBuf::from_lens(SIZE[0], SIZE[1], &fisheye()).unwrap();
    let pinhole_config = camera_of(SIZE, 1.4);
    let pinhole = Pinhole::new(common::pinhole(&pinhole_config).intrinsics()).unwrap();
    let fisheye = fisheye();
    let [now, before, after] = [0.0, -1.0, 1.0].map(|time| story.poses(time));
    let global = |time: f64, poses: &'static [Pose]| Moment {
        world_from_sensor: Story::sensor(time),
        world_from_instance: poses,
    };
    // The poses are leaked, so that they live as long as the test.
    let [now, before, after] = [now, before, after].map(|poses| &*poses.leak());
    let rows = SIZE[1];
    let rolling_poses: Vec<Vec<Pose>> =
        (0..rows).map(|row| story.poses(1.0 + 0.5 * f64::from(row) / f64::from(rows))).collect();
    let rolling: Vec<_> = (0..rows)
        .map(|row| {
            let world_from_sensor = Story::sensor(1.0 + 0.5 * f64::from(row) / f64::from(rows));
            let at = Moment { world_from_sensor, world_from_instance: &rolling_poses[row as usize] };
            Slice { lines: row..row + 1, at }
        })
        .collect();
    let lenses: [(CameraConfig<'_>, &dyn Lens); 2] =
        [(pinhole_config, &pinhole), (CameraConfig::new(&table), &fisheye)];
    for (config, lens) in lenses {
        let capture =
            Capture::new(0, global(0.0, now)).before(global(-1.0, before)).after(global(1.0, after));
        let known = truth(&scene, config, &capture);
        let rolled = truth(&scene, config, &Capture::new(0, global(0.0, now)).after(rolling.as_slice()));
        let (mut worst, mut compared, mut lost) = ([0.0_f64; 3], 0, 0);
        for ray in 0..known.range.len() {
            let pixel = DVec2::new((ray % SIZE[0] as usize) as f64, (ray / SIZE[0] as usize) as f64);
            if known.instance[ray] == NOTHING {
                assert!(known.flow[ray][0].is_nan() && known.flow_back[ray][0].is_nan());
                continue;
            }
            let index = known.instance[ray] as usize;
            let range = f64::from(known.range[ray]);
            let from = (&Story::sensor(0.0), &now[index]);
            let inside = |to: DVec2| {
                let at = to + pixel;
                at.cmpge(DVec2::ZERO).all() && at.cmple(DVec2::new(162.0, 120.0)).all()
            };
            for (side, found, time, poses) in
                [(0, &known.flow, 1.0, after), (1, &known.flow_back, -1.0, before)]
            {
                let to = flow_of(lens, pixel, range, from, (&Story::sensor(time), &poses[index]));
                let Some(to) = to.filter(|&to| inside(to)) else { continue };
                let found = DVec2::new(found[ray][0].into(), found[ray][1].into());
                lost += u32::from(found.is_nan());
                if !found.is_nan() {
                    worst[side] = worst[side].max((found - to).length());
                    compared += 1;
                }
            }
            // The row of the other frame at which the point is seen, and the moment of that row, at the same time.
            let seen = DVec2::new(rolled.flow[ray][0].into(), rolled.flow[ray][1].into());
            let row = (seen.y + pixel.y + 0.5).floor();
            if !seen.is_nan() && (0.0..f64::from(rows)).contains(&row) {
                // A point between two rows may have crossed over between their moments; either row is accepted.
                let rows = (row as usize).saturating_sub(1)..(row as usize + 2).min(rolling.len());
                let off = |row: usize| {
                    let at = &rolling[row].at;
                    let to = (&at.world_from_sensor, &at.world_from_instance[index]);
                    (seen - flow_of(lens, pixel, range, from, to).unwrap()).length()
                };
                worst[2] = worst[2].max(rows.map(off).fold(f64::INFINITY, f64::min));
            }
        }
        println!("{compared} points, {worst:?} px at worst, {lost} not found");
        assert!(compared > 10_000 && lost == 0 && worst.iter().all(|&worst| worst < 0.01));
    }
}

#[test]
fn seen_boxes_match_the_pixels_and_the_bounds_of_instances() {
    let story = Story::new();
    let scene = story.builder.scene();
    let moment = story.builder.moment(Story::sensor(0.0));
    let config = camera_of(SIZE, 1.4);
    let lens = Pinhole::new(common::pinhole(&config).intrinsics()).unwrap();
    let known = truth(&scene, config, &Capture::new(0, moment));
    let mut boxes = vec![SeenBox::EMPTY; scene.instances().len()];
    seen_boxes(&known.instance, SIZE[0] as usize, &mut boxes);
    let pixels = || {
        let place = |ray: usize| [ray as u32 % SIZE[0], ray as u32 / SIZE[0]];
        known.instance.iter().enumerate().map(move |(ray, &instance)| (ray, place(ray), instance as usize))
    };
    let mut seen = 0;
    for (index, found) in boxes.iter().enumerate() {
        let mut expected = SeenBox::EMPTY;
        let [low, high] = scene.bounds(index).unwrap();
        for (ray, [x, y], _) in pixels().filter(|&(.., instance)| instance == index) {
            expected.min = [expected.min[0].min(x), expected.min[1].min(y)];
            expected.max = [expected.max[0].max(x), expected.max[1].max(y)];
            expected.pixels += 1;
            // The point itself, in the axes of the object.
            let optical = lens.unproject(DVec2::new(x.into(), y.into())).unwrap();
            let ahead = optical / optical.z * f64::from(known.depth[ray]);
            let in_world = moment.world_from_sensor.transform_point(DVec3::new(ahead.z, -ahead.x, -ahead.y));
            let point = story.builder.poses()[index].inverse().transform_point(in_world);
            let slack = DVec3::splat(1e-4);
            assert!(point.cmpge(low - slack).all() && point.cmple(high + slack).all(), "{index}: {point}");
        }
        assert_eq!(*found, expected, "{index}");
        seen += u32::from(!found.is_empty());
    }
    assert!(seen > 5, "{seen} things are seen");
    assert_eq!(scene.bounds(boxes.len()), None);
}

#[test]
fn errors_name_what_is_missing() {
    let story = Story::new();
    let scene = story.builder.scene();
    let moment = story.builder.moment(Pose::IDENTITY);
    let camera = Camera::new(camera_of(SIZE, 1.4)).unwrap();
    let mut flow = vec![[0.0; 2]; (SIZE[0] * SIZE[1]) as usize];
    let sense = |capture: Capture<'_>, flow: &mut [[f32; 2]]| {
        let mut memory = WorkspaceBuf::default();
        camera.sense_in(&mut memory, &scene, &capture, Picture::new().truth(Truth::new().flow(flow)))
    };
    let alone = Capture::new(0, moment);
    assert_eq!(sense(alone, &mut flow), Err(SenseError::OtherMoment { parameter: "after" }));
    assert_eq!(sense(alone.before(moment), &mut flow), Err(SenseError::OtherMoment { parameter: "after" }));
    assert_eq!(sense(alone.after(moment), &mut flow), Ok(()));
    let elsewhere = Moment { world_from_instance: &[], ..moment };
    assert!(matches!(sense(alone.after(elsewhere), &mut flow), Err(SenseError::Poses { value: 0, .. })));
    let short = sense(alone.after(moment), &mut flow[1..]);
    assert!(matches!(short, Err(SenseError::Output { parameter: "flow", .. })));
}
