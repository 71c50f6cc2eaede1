//! The main purpose: in another process than the simulator, independent detectors find every code on the ceiling, and
//! the robot's pose is computed from them.

use crate::eyes::{Seen, april_tags, listed, qr_codes};
use crate::live::control::step;
use crate::live::{PATIENCE, Simulator};
use belvedere_bridge::payload::{BoundingBox, TagDetection};
use belvedere_bridge::{Frame, Intrinsics, SimulationControl, Synchronizer};
use belvedere_sensors::Pose;
use glam::{DQuat, DVec3};
use image::GrayImage;
use nalgebra::{Matrix6, Vector6};
use std::collections::{BTreeMap, HashMap};
use std::time::Instant;

const POSES: usize = 20;
/// The same, for the test of ground truth.
const TRUE_POSES: usize = 12;
/// The distance that the robot drives from one pose to the next.
const APART_M: f64 = 0.5;
const POSITION_TOLERANCE_M: f64 = 0.005;
const ANGLE_TOLERANCE_DEG: f64 = 0.3;
/// A corner nearer to the edge of the picture lacks a part of the white margin that the detector needs.
const CLEAR_OF_EDGE_PX: f64 = 4.0;

/// A robot that drives its loop in steps, so that only the needed pictures are rendered.
struct Drive {
    simulator: Simulator,
    control: SimulationControl,
    step_ns: u64,
}

impl Drive {
    fn start(arguments: &[&str]) -> Self {
        let simulator = Simulator::start(&[&["--rate", "max", "--paused"], arguments].concat());
        let mut control = SimulationControl::open(&simulator.node()).unwrap();
        let first_ns = step(&mut control, 1);
        let step_ns = step(&mut control, 1) - first_ns;
        Self { simulator, control, step_ns }
    }

    /// Drives for half a second.
    fn on(&mut self) {
        step(&mut self.control, 500_000_000 / self.step_ns);
    }

    /// Drives frame by frame until `take` returns something.
    fn until<T>(&mut self, mut take: impl FnMut() -> Option<T>) -> T {
        let started = Instant::now();
        loop {
            step(&mut self.control, 40_000_000 / self.step_ns);
            if let Some(taken) = take() {
                return taken;
            }
            assert!(started.elapsed() < PATIENCE, "nothing comes");
        }
    }
}

#[test]
fn every_code_is_found_and_gives_the_pose_of_the_camera() {
    let codes = listed();
    // With noise.
    let mut drive = Drive::start(&[]);
    let mut views = Vec::new();
    while views.len() < POSES {
        let mut subscriber = drive.simulator.subscribe("/image_raw");
        let frame = drive.until(|| subscriber.take().unwrap());
        let truth = true_pose(&frame);
        let last: Option<&(Pose, Intrinsics, GrayImage)> = views.last();
        if last.is_none_or(|(last, ..)| last.translation().distance(truth.translation()) >= APART_M) {
            views.push((truth, *frame.header().intrinsics().unwrap(), grey(&frame)));
        }
        drop((frame, subscriber));
        drive.on();
    }
    drop(drive);

    let (mut tags, mut qrs) = (0, 0);
    for (pose, (truth, intrinsics, picture)) in (1..).zip(views) {
        let seen_tags = april_tags(&picture);
        let seen_qrs = qr_codes(&picture);
        let seen: HashMap<&str, &Seen> =
            seen_tags.iter().chain(&seen_qrs).map(|seen| (seen.says.as_str(), seen)).collect();
        for code in codes.iter().filter(|code| lie_in_picture(&code.plate(), 0.0, &truth, &intrinsics)) {
            assert!(seen.contains_key(code.says.as_str()), "pose {pose}: {} was not found", code.name);
            if code.is_qr { qrs += 1 } else { tags += 1 }
        }

        let points: Vec<(DVec3, [f64; 2])> = codes
            .iter()
            .filter(|code| {
                !code.is_qr && lie_in_picture(&code.corners, CLEAR_OF_EDGE_PX, &truth, &intrinsics)
            })
            .filter_map(|code| Some((code, seen.get(code.says.as_str())?)))
            .flat_map(|(code, seen)| code.corners.into_iter().zip(seen.corners))
            .collect();
        // The search starts from a distant pose, so that the result comes from the picture.
        let nudge = Pose::from_xyz_rpy(DVec3::new(0.1, -0.1, 0.1), DVec3::new(0.05, 0.05, -0.1));
        let found = solve_pose(truth * nudge, &points, &intrinsics);
        let off_m = found.translation().distance(truth.translation());
        let off_deg = found.rotation().angle_between(truth.rotation()).to_degrees();
        println!("pose {pose}: {} corners, {:.2} mm, {off_deg:.3} degrees", points.len(), off_m * 1e3);
        assert!(off_m < POSITION_TOLERANCE_M, "pose {pose}: {:.2} mm off", off_m * 1e3);
        assert!(off_deg < ANGLE_TOLERANCE_DEG, "pose {pose}: {off_deg:.3} degrees off");
    }
    println!("{tags} AprilTags and {qrs} QR codes lay wholly in {POSES} pictures; all were found");
    assert!(tags >= 60 && qrs >= 40, "only {tags} AprilTags and {qrs} QR codes lay in the pictures");
}

/// A picture with its ground truth.
struct Known {
    camera: Pose,
    lens: Intrinsics,
    picture: GrayImage,
    tags: Vec<TagDetection>,
    boxes: Vec<BoundingBox>,
    instance: Vec<u32>,
}

/// The ground truth of each picture against detections in it: corners of tags against the AprilTag library, zbar and
/// the projected list of corners; boxes against the picture of instances, pixel by pixel.
#[test]
fn ground_truth_agrees_with_detectors_and_pixels() {
    let codes = listed();
    let mut drive = Drive::start(&["--truth"]);
    let streams = ["image_raw", "image_raw/truth/tags", "image_raw/truth/boxes", "image_raw/truth/instance"];
    let mut views: Vec<Known> = Vec::new();
    while views.len() < TRUE_POSES {
        let mut frames = Synchronizer::exact(&drive.simulator.node(), streams).unwrap();
        let set = drive.until(|| frames.take().unwrap());
        let camera = true_pose(&set[0]);
        let moved = |last: &Known| last.camera.translation().distance(camera.translation());
        if views.last().is_none_or(|last| moved(last) >= APART_M) {
            let [picture, tags, boxes, instance] = &set;
            views.push(Known {
                camera,
                lens: *picture.header().intrinsics().unwrap(),
                picture: grey(picture),
                tags: tags.view().structs().unwrap().collect(),
                boxes: boxes.view().structs().unwrap().collect(),
                instance: instance
                    .payload()
                    .as_chunks()
                    .0
                    .iter()
                    .map(|bytes| u32::from_le_bytes(*bytes))
                    .collect(),
            });
        }
        drop((set, frames));
        drive.on();
    }
    drop(drive);

    let (mut off_px, mut qr_off_px, mut listed_off_px) = (Vec::new(), Vec::new(), 0.0_f64);
    let (mut hidden, mut boxes_seen) = (0, 0);
    for Known { camera, lens, picture, tags, boxes, instance } in &views {
        let find =
            |family: &str, id: u32| tags.iter().find(|tag| tag.family.as_str() == family && tag.id == id);
        // Each detection is in the ground truth, at the same position.
        for (family, seen) in april_tags(picture)
            .iter()
            .map(|seen| ("tag36h11", seen))
            .chain(qr_codes(picture).iter().map(|seen| ("qr", seen)))
        {
            let id = seen.says.trim_start_matches("BV-").parse().unwrap();
            let tag = find(family, id)
                .unwrap_or_else(|| panic!("{family} {id} is detected, but not in the ground truth"));
            // Ground truth is clockwise from the top left; the detectors begin at the bottom left and go
            // counter-clockwise.
            for ((found, visible), truth) in
                [3, 2, 1, 0].map(|at| seen.corners[at]).iter().zip(tag.visible).zip(tag.corners)
            {
                let off = (found[0] - truth[0]).hypot(found[1] - truth[1]);
                if visible == 1 {
                    if family == "qr" { qr_off_px.push(off) } else { off_px.push(off) }
                }
            }
        }
        // Each code in the list is in the ground truth too, exactly, with its pose.
        for code in &codes {
            let id = code.says.trim_start_matches("BV-").parse().unwrap();
            let corners = [3, 2, 1, 0].map(|at| project(code.corners[at], camera, lens));
            let inside = corners.map(|[x, y]| (-0.5..639.5).contains(&x) && (-0.5..479.5).contains(&y));
            let Some(tag) = find(if code.is_qr { "qr" } else { "tag36h11" }, id) else {
                assert!(
                    !inside.contains(&true),
                    "{} is in the picture, but not in the ground truth",
                    code.name
                );
                continue;
            };
            assert!((tag.size - code.edge_m).abs() < 1e-9);
            let pose = Pose::new(DVec3::from_array(tag.position), DQuat::from_array(tag.orientation));
            for (at, [right, up]) in
                [[-0.5, 0.5], [0.5, 0.5], [0.5, -0.5], [-0.5, -0.5]].into_iter().enumerate()
            {
                let (reported, expected) = (tag.corners[at], corners[at]);
                listed_off_px =
                    listed_off_px.max((reported[0] - expected[0]).hypot(reported[1] - expected[1]));
                let edge = expected[0].min(639.0 - expected[0]).min(expected[1]).min(479.0 - expected[1]);
                assert!((tag.visible[at] == 1) == inside[at] || (edge + 0.5).abs() < 0.1, "{}", code.name);
                hidden += u32::from(tag.visible[at] == 0);
                // Its pose projects to the same pixel.
                let p = pose.transform_point(DVec3::new(right, up, 0.0) * tag.size);
                let by_pose = [lens.fx * p.x / p.z + lens.cx, lens.fy * p.y / p.z + lens.cy];
                let off = (reported[0] - by_pose[0]).hypot(reported[1] - by_pose[1]);
                assert!(off < 1e-6, "{}: its pose is {off} px off", code.name);
            }
        }

        let mut expected: BTreeMap<u32, (u32, [u32; 2], [u32; 2])> = BTreeMap::new();
        for (at, &thing) in instance.iter().enumerate().filter(|(_, thing)| **thing != u32::MAX) {
            let [x, y] = [at as u32 % 640, at as u32 / 640];
            let (count, min, max) = expected.entry(thing).or_insert((0, [x, y], [x, y]));
            (*count, *min, *max) =
                (*count + 1, [min[0].min(x), min[1].min(y)], [max[0].max(x), max[1].max(y)]);
        }
        let reported: BTreeMap<_, _> =
            boxes.iter().map(|thing| (thing.instance, (thing.pixels, thing.min, thing.max))).collect();
        assert_eq!(reported, expected);
        boxes_seen += boxes.len();
        // The box of the whole object contains its visible part.
        for thing in boxes {
            let pose = Pose::new(DVec3::from_array(thing.position), DQuat::from_array(thing.orientation));
            let corner = |at: usize| DVec3::from_array([0, 1, 2].map(|axis| (at >> axis & 1) as f64 - 0.5));
            let corners = [0, 1, 2, 3, 4, 5, 6, 7]
                .map(|at| pose.transform_point(corner(at) * DVec3::from_array(thing.size)));
            if corners.iter().any(|corner| corner.z < 0.05) {
                continue;
            }
            let pixels = corners.map(|p| [lens.fx * p.x / p.z + lens.cx, lens.fy * p.y / p.z + lens.cy]);
            for axis in 0..2 {
                let least = pixels.iter().map(|pixel| pixel[axis]).fold(f64::INFINITY, f64::min);
                let most = pixels.iter().map(|pixel| pixel[axis]).fold(f64::NEG_INFINITY, f64::max);
                assert!(
                    f64::from(thing.min[axis]) >= least - 0.01 && f64::from(thing.max[axis]) <= most + 0.01,
                    "{thing:?}"
                );
            }
        }
    }
    let mean = |off: &[f64]| off.iter().sum::<f64>() / off.len() as f64;
    let most = |off: &[f64]| off.iter().copied().fold(0.0, f64::max);
    println!(
        "AprilTag: {} corners, {:.3} px off on average, {:.3} at most; zbar: {}, {:.2}, {:.2}",
        off_px.len(),
        mean(&off_px),
        most(&off_px),
        qr_off_px.len(),
        mean(&qr_off_px),
        most(&qr_off_px)
    );
    println!("list: {listed_off_px:.1e} px at most; {hidden} corners out of the picture; {boxes_seen} boxes");
    assert!(off_px.len() >= 200 && mean(&off_px) < 0.2 && most(&off_px) < 1.0);
    // zbar returns whole pixels.
    assert!(qr_off_px.len() >= 100 && mean(&qr_off_px) < 1.5);
    assert!(listed_off_px < 0.01 && hidden > 0 && boxes_seen > 100);
}

/// The pose of the camera (x forward, y left, z up) in the header of the frame.
fn true_pose(frame: &Frame) -> Pose {
    let header = frame.header();
    let orientation = header.orientation.map(f64::from);
    Pose::new(DVec3::from_array(header.position), DQuat::from_array(orientation))
}

fn grey(frame: &Frame) -> GrayImage {
    let header = frame.header();
    assert_eq!(frame.payload().len(), header.width as usize * header.height as usize * 3);
    GrayImage::from_fn(header.width, header.height, |x, y| {
        let at = (y * header.row_stride + x * 3) as usize;
        let [r, g, b] = [0, 1, 2].map(|channel| u32::from(frame.payload()[at + channel]));
        image::Luma([((r * 299 + g * 587 + b * 114 + 500) / 1000) as u8])
    })
}

/// The pixel of a point of the world.
fn project(point: DVec3, world_from_camera: &Pose, lens: &Intrinsics) -> [f64; 2] {
    let p = world_from_camera.inverse().transform_point(point);
    [lens.cx - lens.fx * p.y / p.x, lens.cy - lens.fy * p.z / p.x]
}

fn lie_in_picture(points: &[DVec3], margin_px: f64, world_from_camera: &Pose, lens: &Intrinsics) -> bool {
    points.iter().all(|point| {
        let [x, y] = project(*point, world_from_camera, lens);
        let inside = |value: f64, last: f64| (margin_px..=last - margin_px).contains(&value);
        inside(x, 639.0) && inside(y, 479.0)
    })
}

/// The camera's pose for which the points are nearest to where they were seen: least squares by Gauss–Newton.
fn solve_pose(start: Pose, points: &[(DVec3, [f64; 2])], lens: &Intrinsics) -> Pose {
    let moved = |pose: &Pose, by: &Vector6<f64>| {
        *pose * Pose::from_xyz_rpy(DVec3::new(by[0], by[1], by[2]), DVec3::new(by[3], by[4], by[5]))
    };
    let mut pose = start;
    for _ in 0..20 {
        let (mut normal, mut gradient) = (Matrix6::zeros(), Vector6::zeros());
        for (point, seen) in points {
            let here = project(*point, &pose, lens);
            let mut rows = [Vector6::zeros(); 2];
            for parameter in 0..6 {
                let mut step = Vector6::zeros();
                step[parameter] = 1e-6;
                let there = project(*point, &moved(&pose, &step), lens);
                for axis in 0..2 {
                    rows[axis][parameter] = (there[axis] - here[axis]) / 1e-6;
                }
            }
            for axis in 0..2 {
                normal += rows[axis] * rows[axis].transpose();
                gradient += rows[axis] * (seen[axis] - here[axis]);
            }
        }
        let step = normal.cholesky().expect("the corners determine the pose").solve(&gradient);
        pose = moved(&pose, &step);
        if step.norm() < 1e-12 {
            break;
        }
    }
    pose
}
