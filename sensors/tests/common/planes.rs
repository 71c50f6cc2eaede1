//! Planes in front of depth cameras, and their measured depths.

use super::{add_grey, camera_of, depth_camera};
use belvedere_sensors::depth::{DepthCamera, DepthCameraConfig, DepthFrame};
use belvedere_sensors::scene::{SceneBuilder, Shape};
use belvedere_sensors::trace::{Truth, WorkspaceBuf};
use belvedere_sensors::{Capture, Pose, Sensor};
use core::f64::consts::FRAC_PI_2;
use glam::DVec3;

/// The axial noise of a Kinect v1 in metres: Nguyen, Izadi, Lovell, "Modeling Kinect Sensor Noise for Improved 3D
/// Reconstruction and Tracking", 2012.
pub(crate) fn nguyen_m(depth: f64, incidence: f64) -> f64 {
    let flat = 0.0012 + 0.0019 * (depth - 0.4).powi(2);
    let slant = incidence * incidence / (FRAC_PI_2 - incidence).powi(2);
    if incidence < 60_f64.to_radians() { flat } else { flat + 0.0001 / depth.sqrt() * slant }
}

/// A large plane that the axis of a camera at the origin hits at a depth, rotated by an angle about the vertical.
pub(crate) fn plane(depth: f64, angle: f64) -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    // A rectangle faces along its z, which points at the camera here.
    let pose = Pose::from_xyz_rpy(DVec3::X * depth, DVec3::new(0.0, -FRAC_PI_2, angle));
    add_grey(&mut builder, Shape::Rectangle { size: [100.0, 100.0] }, pose);
    builder
}

/// A camera with such a narrow view that all of its rays are almost the same.
pub(crate) fn narrow(size: [u32; 2]) -> DepthCameraConfig<'static> {
    depth_camera().camera(camera_of(size, 1e-3).far_m(1e3))
}

/// The measured depths, and the true depths and angles of incidence.
pub(crate) struct Frame {
    pub(crate) depth: Vec<f32>,
    pub(crate) true_depth: Vec<f32>,
    pub(crate) incidence: Vec<f32>,
}

pub(crate) fn take(builder: &SceneBuilder, config: DepthCameraConfig<'_>, frame: u64) -> Frame {
    let camera = DepthCamera::new(config).unwrap();
    let new = || vec![0.0; camera.pixels()];
    let mut taken = Frame { depth: new(), true_depth: new(), incidence: new() };
    let truth = Truth::new().depth(&mut taken.true_depth).incidence(&mut taken.incidence);
    let output = DepthFrame::new().depth_32fc1(&mut taken.depth).truth(truth);
    let (scene, capture) = (builder.scene(), Capture::new(frame, builder.moment(Pose::IDENTITY)));
    let mut memory = WorkspaceBuf::default();
    camera.sense(&scene, &capture, &mut memory.lend(camera.workspace_len(&scene, &capture)), output).unwrap();
    taken
}

/// The root mean square.
pub(crate) fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), x| (sum + x * x, count + 1.0));
    (sum / count).sqrt()
}

#[track_caller]
pub(crate) fn assert_near(found: f64, expected: f64, share: f64) {
    assert!((found / expected - 1.0).abs() < share, "{found} instead of {expected}");
}
