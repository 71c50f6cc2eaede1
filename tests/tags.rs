//! The main job's point: detectors that nobody here wrote, in another process than the simulator, find every code
//! on the ceiling, and the robot's place from them.

mod eyes;
mod live;

use belvedere_bridge::{Frame, Intrinsics};
use belvedere_sensors::Pose;
use eyes::{Seen, april_tags, listed, qr_codes};
use glam::{DQuat, DVec3};
use image::GrayImage;
use live::{Simulator, next_frame};
use nalgebra::{Matrix6, Vector6};
use std::collections::HashMap;

const POSES: usize = 20;
/// The robot goes that far from one pose to the next.
const APART_M: f64 = 0.5;
const POSITION_TOLERANCE_M: f64 = 0.005;
const ANGLE_TOLERANCE_DEG: f64 = 0.3;
/// A corner nearer to the edge of the picture has lost part of the white that the detector finds it by.
const CLEAR_OF_EDGE_PX: f64 = 4.0;

#[test]
fn every_code_is_found_and_tells_where_the_camera_is() {
    let codes = listed();
    // In real time, so that this process gets every frame and the same ones are picked in each run. Noise is on.
    let simulator = Simulator::start(&[]);
    let mut subscriber = simulator.subscribe("/image_raw");
    let mut views = Vec::new();
    while views.len() < POSES {
        let frame = next_frame(&mut subscriber);
        let truth = true_pose(&frame);
        let last: Option<&(Pose, Intrinsics, GrayImage)> = views.last();
        if last.is_none_or(|(last, ..)| last.translation().distance(truth.translation()) >= APART_M) {
            views.push((truth, *frame.header().intrinsics().unwrap(), grey(&frame)));
        }
    }
    drop(simulator);

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
        // The search begins well off, so that it is the picture that finds the pose.
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

/// Pose of the camera (x forward, y left, z up) that the frame itself tells.
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

/// Pixel of a point of the world.
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

/// The camera's pose that brings the points nearest to where they were seen: least squares by Gauss and Newton.
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
