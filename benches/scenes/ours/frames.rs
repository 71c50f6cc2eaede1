//! Whole frames, and scenes that move.

use super::super::rays::{RaySet, Source};
use super::Built;
use belvedere_sensors::camera::CameraConfig;
use belvedere_sensors::depth::{DepthCamera, DepthCameraConfig, DepthFrame};
use belvedere_sensors::lidar::{Beams, Lidar, LidarConfig, Scan, TooNear};
use belvedere_sensors::noise::GaussianNoise;
use belvedere_sensors::optics::PinholeGrid;
use belvedere_sensors::scene::{InstanceConfig, InstanceId, MaterialConfig, SceneBuilder, Shape, visibility};
use belvedere_sensors::simd::Level;
use belvedere_sensors::trace::{Faces, WorkspaceBuf};
use belvedere_sensors::{Capture, Execution, Pose, Sensor};

/// A depth camera with the rays of R1.
pub struct DepthFrames {
    camera: DepthCamera<'static>,
    world_from_sensor: Pose,
    frame: u64,
    workspace: WorkspaceBuf,
    depths: Vec<f32>,
}

impl DepthFrames {
    /// # Panics
    /// If the rays are not those of a pinhole.
    pub fn new(rays: &RaySet, noise: GaussianNoise, execution: Execution) -> Self {
        let Source::Pinhole { world_from_sensor, focal_px } = &rays.source else {
            panic!("{} are not the rays of a camera", rays.name)
        };
        let fov = 2.0 * libm::atan(rays.width as f64 * 0.5 / focal_px);
        let mut workspace = WorkspaceBuf::default();
        workspace.execution = execution;
        Self {
            camera: depth_camera(fov, noise),
            world_from_sensor: *world_from_sensor,
            frame: 0,
            workspace,
            depths: vec![0.0; rays.len()],
        }
    }

    /// Renders the next frame.
    pub fn sense(&mut self, built: &Built) {
        let scene = built.builder.scene();
        self.frame += 1;
        let capture = Capture::new(self.frame, built.builder.moment(self.world_from_sensor));
        let output = DepthFrame::new().depth_32fc1(&mut self.depths);
        self.camera
            .sense_in(&mut self.workspace, &scene, &capture, output)
            .expect("outputs of the right size");
    }
}

/// The number of rays: so few that the time is that of the scene, not of the cast.
const FAN: Beams = Beams { samples: 16, min_angle_rad: -0.05, max_angle_rad: 0.05 };

/// Boxes that move.
pub struct Moving {
    builder: SceneBuilder,
    boxes: Vec<InstanceId>,
    workspace: WorkspaceBuf,
    lidar: Lidar,
}

impl Moving {
    /// Creates a number of boxes.
    pub fn new(count: usize, level: Level) -> Self {
        let mut builder = SceneBuilder::new();
        let material = builder.add_material(&MaterialConfig::default()).expect("a plain material");
        let instance = InstanceConfig {
            shape: Shape::Box { size: super::super::moving::SIZE },
            world_from_instance: Pose::IDENTITY,
            scale: [1.0; 3],
            material,
            visibility: visibility::COLLISION,
            ..InstanceConfig::default()
        };
        let mut add = || builder.add_instance(&instance).expect("our own instance");
        let boxes = (0..count).map(|_| add()).collect();
        let mut workspace = WorkspaceBuf::default();
        workspace.execution = Execution::at(level);
        Self { builder, boxes, workspace, lidar: lidar(FAN, Beams::ONE) }
    }

    /// Moves the boxes and casts a few rays.
    pub fn frame(&mut self, poses: &[Pose]) {
        for (instance, pose) in self.boxes.iter().zip(poses) {
            self.builder.set_pose(*instance, *pose).expect("our own pose");
        }
        let capture = Capture::new(0, self.builder.moment(Pose::IDENTITY));
        let mut ranges = [0.0; FAN.samples as usize];
        let scene = self.builder.scene();
        self.lidar
            .sense_in(&mut self.workspace, &scene, &capture, Scan::new().ranges(&mut ranges))
            .expect("outputs of the right size");
        std::hint::black_box(ranges);
    }
}

/// Creates a depth camera of 640 × 480 pixels with unlimited range.
fn depth_camera(horizontal_fov_rad: f64, noise: GaussianNoise) -> DepthCamera<'static> {
    let lens = PinholeGrid::from_fov(640, 480, horizontal_fov_rad).expect("in range");
    let camera = CameraConfig::new(lens).near_m(1e-3).far_m(1e6).seed(1);
    DepthCamera::new(DepthCameraConfig::new(camera).model(noise).faces(Faces::Front)).expect("in range")
}

/// Creates a lidar with unlimited range.
fn lidar(horizontal: Beams, vertical: Beams) -> Lidar {
    let config = LidarConfig::new(horizontal)
        .vertical(vertical)
        .range_min_m(0.0)
        .range_max_m(1e6)
        .too_near(TooNear::Blocks)
        .noise(GaussianNoise::NONE)
        .seed(0)
        .sensor(0);
    Lidar::new(config).expect("in range")
}
