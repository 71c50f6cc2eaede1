//! Whole frames, and scenes that move.

use super::super::rays::{RaySet, Source};
use super::{Built, execution};
use belvedere_sensors::camera::{CameraConfig, PixelFormat};
use belvedere_sensors::depth::{DepthCamera, DepthCameraConfig, DepthFrame, OutOfRange};
use belvedere_sensors::lidar::{Beams, Lidar, LidarConfig, TooNear};
use belvedere_sensors::noise::GaussianNoise;
use belvedere_sensors::scene::{InstanceConfig, InstanceId, MaterialConfig, SceneBuilder, Shape, visibility};
use belvedere_sensors::simd::Level;
use belvedere_sensors::trace::{Capture, WorkspaceBuf};
use belvedere_sensors::{Execution, Pose};

/// A depth camera with the rays of R1.
pub struct DepthFrames {
    camera: DepthCamera,
    capture: Capture,
    workspace: WorkspaceBuf,
    depths: Vec<f32>,
}

impl DepthFrames {
    /// # Panics
    /// When the rays are not a pinhole's.
    pub fn new(rays: &RaySet, noise: GaussianNoise, execution: Execution) -> Self {
        let Source::Pinhole { world_from_sensor, focal_px } = &rays.source else {
            panic!("{} are not the rays of a camera", rays.name)
        };
        let fov = 2.0 * libm::atan(rays.width as f64 * 0.5 / focal_px);
        let mut workspace = WorkspaceBuf::default();
        workspace.execution = execution;
        let capture = Capture { world_from_sensor: *world_from_sensor, frame: 0 };
        Self { camera: depth_camera(fov, noise), capture, workspace, depths: vec![0.0; rays.len()] }
    }

    /// Takes the next frame.
    pub fn sense(&mut self, built: &Built) {
        let scene = built.builder.scene();
        self.capture.frame += 1;
        let output = DepthFrame { depth_32fc1: Some(&mut self.depths), ..DepthFrame::default() };
        let workspace = &mut self.workspace.lend(&scene, self.camera.rays());
        self.camera.sense(&scene, &self.capture, workspace, output);
    }
}

/// Few enough rays that what is timed is the scene, not the cast.
const FAN: Beams = Beams { samples: 16, min_angle_rad: -0.05, max_angle_rad: 0.05 };

/// Boxes that move.
pub struct Moving {
    builder: SceneBuilder,
    boxes: Vec<InstanceId>,
    workspace: WorkspaceBuf,
    lidar: Lidar,
}

impl Moving {
    /// So many boxes.
    pub fn new(count: usize, level: Level) -> Self {
        let mut builder = SceneBuilder::new();
        let material = builder.add_material(&MaterialConfig::default()).expect("a plain material");
        let instance = InstanceConfig {
            shape: Shape::Box { size: super::super::moving::SIZE },
            world_from_instance: Pose::IDENTITY,
            scale: [1.0; 3],
            material,
            visibility: visibility::COLLISION,
            laser_retro: 0.0,
        };
        let mut add = || builder.add_instance(&instance).expect("our own instance");
        let boxes = (0..count).map(|_| add()).collect();
        let mut workspace = WorkspaceBuf::default();
        workspace.execution = execution(level);
        Self { builder, boxes, workspace, lidar: lidar(FAN, Beams::ONE) }
    }

    /// Moves them and casts a few rays.
    pub fn frame(&mut self, poses: &[Pose]) {
        for (instance, pose) in self.boxes.iter().zip(poses) {
            self.builder.set_pose(*instance, *pose).expect("our own pose");
        }
        let capture = Capture { world_from_sensor: Pose::IDENTITY, frame: 0 };
        let mut ranges = [0.0; FAN.samples as usize];
        let scene = self.builder.scene();
        let workspace = &mut self.workspace.lend(&scene, self.lidar.rays());
        self.lidar.sense(&scene, &capture, workspace, &mut ranges, &mut []);
        std::hint::black_box(ranges);
    }
}

/// A depth camera of 640 × 480 pixels that sees without end.
fn depth_camera(horizontal_fov_rad: f64, noise: GaussianNoise) -> DepthCamera {
    let camera = CameraConfig {
        width: 640,
        height: 480,
        horizontal_fov_rad,
        format: PixelFormat::Rgb8,
        near_m: 1e-3,
        far_m: 1e6,
        exposure: 1.0,
        noise: GaussianNoise::NONE,
        seed: 1,
        sensor: 0,
    };
    let config = DepthCameraConfig {
        camera,
        min_depth_m: 0.0,
        max_depth_m: f64::INFINITY,
        out_of_range: OutOfRange::Infinite,
        noise,
    };
    DepthCamera::new(config).expect("in range")
}

/// A lidar that sees without end.
fn lidar(horizontal: Beams, vertical: Beams) -> Lidar {
    let config = LidarConfig {
        horizontal,
        vertical,
        range_min_m: 0.0,
        range_max_m: 1e6,
        too_near: TooNear::Blocks,
        noise: GaussianNoise::NONE,
        seed: 0,
        sensor: 0,
    };
    Lidar::new(config).expect("in range")
}
