//! Belvedere's side: the only place here that knows the tracing interface.

use super::rays::Source;
use super::{Mesh, RaySet};
use belvedere_sensors::camera::{CameraConfig, PixelFormat};
use belvedere_sensors::depth::{DepthCamera, DepthCameraConfig, DepthFrame, OutOfRange};
use belvedere_sensors::lidar::{Beams, Lidar, LidarConfig, TooNear};
use belvedere_sensors::noise::GaussianNoise;
use belvedere_sensors::scene::build::{Quality, Tree as WideTree};
use belvedere_sensors::scene::{InstanceConfig, InstanceId, MaterialConfig, SceneBuilder, Shape, visibility};
use belvedere_sensors::simd::Level;
use belvedere_sensors::trace::{Capture, WorkspaceBuf};
use belvedere_sensors::{Execution, Pose};
use core::f64::consts::PI;

/// One thread at that level.
pub fn execution(level: Level) -> Execution {
    Execution { level, ..Execution::default() }
}

/// The tree of a mesh alone.
pub struct Tree(WideTree);

impl Tree {
    pub fn new(mesh: &Mesh, level: Level) -> Self {
        let tree = WideTree::build(&mesh.vertices, &mesh.triangles, Quality::High, execution(level));
        Self(tree.expect("our own mesh"))
    }

    /// Follows vertices that moved.
    pub fn refit(&mut self, vertices: &[[f32; 3]], triangles: &[[u32; 3]], level: Level) {
        self.0.refit(vertices, triangles, execution(level)).expect("our own mesh");
    }
}

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

/// What a cast answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wanted {
    /// The distance alone.
    Distance,
    /// Distance, unit normal and triangle.
    All,
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
    pub fn new(rays: &RaySet, execution: Execution, _wanted: Wanted) -> Option<Self> {
        let mut workspace = WorkspaceBuf::default();
        workspace.execution = execution;
        let (sensor, world_from_sensor) = match &rays.source {
            Source::Pinhole { world_from_sensor, focal_px } => {
                let fov = 2.0 * libm::atan(rays.width as f64 * 0.5 / focal_px);
                (Sensor::Depth(depth_camera(fov, GaussianNoise::NONE)), *world_from_sensor)
            }
            Source::Rings { world_from_sensor, elevations_rad } => {
                let half_step = PI / rays.width as f64;
                let horizontal = Beams {
                    samples: rays.width as u32,
                    min_angle_rad: -PI + half_step,
                    max_angle_rad: PI - half_step,
                };
                let vertical = Beams {
                    samples: rays.height as u32,
                    min_angle_rad: elevations_rad[rays.height - 1],
                    max_angle_rad: elevations_rad[0],
                };
                (Sensor::Lidar(lidar(horizontal, vertical)), *world_from_sensor)
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
        self.workspace.fit(&scene);
        self.capture.frame += 1;
        let output = DepthFrame { depth_32fc1: Some(&mut self.depths), ..DepthFrame::default() };
        self.camera.sense(&scene, &self.capture, &mut self.workspace.lend(), output);
    }
}

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
            shape: Shape::Box { size: super::moving::SIZE },
            world_from_instance: Pose::IDENTITY,
            material,
            visibility: visibility::COLLISION,
            laser_retro: 0.0,
        };
        let mut add = || builder.add_instance(&instance).expect("our own instance");
        let boxes = (0..count).map(|_| add()).collect();
        let mut workspace = WorkspaceBuf::for_scene(&builder.scene());
        workspace.execution = execution(level);
        Self { builder, boxes, workspace, lidar: lidar(Beams::ONE, Beams::ONE) }
    }

    /// Moves them and casts one ray.
    pub fn frame(&mut self, poses: &[Pose]) {
        for (instance, pose) in self.boxes.iter().zip(poses) {
            self.builder.set_pose(*instance, *pose).expect("our own pose");
        }
        let capture = Capture { world_from_sensor: Pose::IDENTITY, frame: 0 };
        let mut range = [0.0];
        self.lidar.sense(&self.builder.scene(), &capture, &mut self.workspace.lend(), &mut range, &mut []);
        std::hint::black_box(range);
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
