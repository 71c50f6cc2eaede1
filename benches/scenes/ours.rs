//! Belvedere's side: the only place here that knows the tracing interface.

use super::rays::Source;
use super::{Mesh, RaySet};
use belvedere_sensors::Pose;
use belvedere_sensors::camera::{CameraConfig, PixelFormat};
use belvedere_sensors::depth::{DepthCamera, DepthCameraConfig, DepthFrame, OutOfRange};
use belvedere_sensors::lidar::{Beams, Lidar, LidarConfig, TooNear};
use belvedere_sensors::noise::GaussianNoise;
use belvedere_sensors::scene::{InstanceConfig, MaterialConfig, SceneBuilder, Shape, visibility};
use belvedere_sensors::simd::Level;
use belvedere_sensors::trace::{Capture, WorkspaceBuf};
use core::f64::consts::PI;

/// A scene of one mesh.
pub struct Built {
    builder: SceneBuilder,
}

impl Built {
    /// Builds its tree.
    pub fn new(mesh: &Mesh) -> Self {
        let mut builder = SceneBuilder::new();
        let material = builder.add_material(&MaterialConfig::default()).expect("a plain material");
        let mesh = builder.add_mesh(&mesh.vertices, &[], &mesh.triangles).expect("our own mesh");
        let instance = InstanceConfig {
            shape: Shape::Mesh(mesh),
            world_from_instance: Pose::IDENTITY,
            material,
            visibility: visibility::VISUAL | visibility::COLLISION,
            laser_retro: 0.0,
        };
        builder.add_instance(&instance).expect("our own instance");
        Self { builder }
    }
}

/// A ray set ready to be cast, with the memory for its answers.
pub struct Caster {
    sensor: Sensor,
    capture: Capture,
    workspace: WorkspaceBuf,
    distances: Vec<f32>,
}

enum Sensor {
    Depth(DepthCamera),
    Lidar(Lidar),
}

impl Caster {
    /// None for rays that nothing casts yet.
    pub fn new(rays: &RaySet, level: Level) -> Option<Self> {
        let mut workspace = WorkspaceBuf::default();
        workspace.execution.level = level;
        let (sensor, world_from_sensor) = match &rays.source {
            Source::Pinhole { world_from_sensor, focal_px } => {
                let fov = 2.0 * libm::atan(rays.width as f64 * 0.5 / focal_px);
                (Sensor::Depth(depth_camera(fov, GaussianNoise::NONE)), *world_from_sensor)
            }
            Source::Rings { world_from_sensor, elevations_rad } => {
                let half_step = PI / rays.width as f64;
                let config = LidarConfig {
                    horizontal: Beams {
                        samples: rays.width as u32,
                        min_angle_rad: -PI + half_step,
                        max_angle_rad: PI - half_step,
                    },
                    vertical: Beams {
                        samples: rays.height as u32,
                        min_angle_rad: elevations_rad[rays.height - 1],
                        max_angle_rad: elevations_rad[0],
                    },
                    range_min_m: 0.0,
                    range_max_m: 1e6,
                    too_near: TooNear::Blocks,
                    noise: GaussianNoise::NONE,
                    seed: 0,
                    sensor: 0,
                };
                (Sensor::Lidar(Lidar::new(config).expect("in range")), *world_from_sensor)
            }
            Source::Random => return None,
        };
        let capture = Capture { world_from_sensor, frame: 0 };
        Some(Self { sensor, capture, workspace, distances: vec![0.0; rays.len()] })
    }

    /// Casts them all.
    pub fn cast(&mut self, built: &Built) {
        let scene = built.builder.scene();
        self.workspace.fit(&scene);
        let workspace = &mut self.workspace.lend();
        match &self.sensor {
            Sensor::Depth(camera) => {
                let output = DepthFrame { depth_32fc1: Some(&mut self.distances), ..DepthFrame::default() };
                camera.sense(&scene, &self.capture, workspace, output);
            }
            Sensor::Lidar(lidar) => {
                lidar.sense(&scene, &self.capture, workspace, &mut self.distances, &mut []);
            }
        }
    }
}

/// A depth camera of 640 × 480 pixels that sees without end.
pub fn depth_camera(horizontal_fov_rad: f64, noise: GaussianNoise) -> DepthCamera {
    let camera = CameraConfig {
        width: 640,
        height: 480,
        horizontal_fov_rad,
        format: PixelFormat::Rgb8,
        near_m: 1e-3,
        far_m: 1e6,
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
