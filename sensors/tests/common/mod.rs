//! What the tests of the sensors share.
#![allow(dead_code, reason = "each test uses its part")]

pub(crate) mod adversary;
pub(crate) mod brute;
pub(crate) mod exactness;
pub(crate) mod oracle;

use belvedere_sensors::camera::{Camera, CameraConfig, PixelFormat};
use belvedere_sensors::depth::{DepthCamera, DepthCameraConfig, DepthFrame, OutOfRange};
use belvedere_sensors::lidar::{Beams, Lidar, LidarConfig, TooNear};
use belvedere_sensors::noise::GaussianNoise;
use belvedere_sensors::scene::{
    InstanceConfig, InstanceId, LightConfig, LightKind, MaterialConfig, MaterialId, Scene, SceneBuilder,
    Shape,
};
use belvedere_sensors::trace::{Capture, WorkspaceBuf};
use belvedere_sensors::{Execution, Pose};
use glam::DVec3;

/// A camera of 640 × 480 pixels without noise.
pub(crate) const CAMERA: CameraConfig = CameraConfig {
    width: 640,
    height: 480,
    horizontal_fov_rad: 1.2,
    format: PixelFormat::Rgb8,
    near_m: 0.02,
    far_m: 300.0,
    exposure: 1.0,
    noise: GaussianNoise::NONE,
    seed: 1,
    sensor: 0,
};

/// A depth camera of that geometry, whose depths are limited by the clip distances alone.
pub(crate) const DEPTH_CAMERA: DepthCameraConfig = DepthCameraConfig {
    camera: CAMERA,
    min_depth_m: 0.0,
    max_depth_m: f64::INFINITY,
    out_of_range: OutOfRange::Infinite,
    noise: GaussianNoise::NONE,
};

/// A lidar in the plane, half a turn wide.
pub(crate) const LIDAR: LidarConfig = LidarConfig {
    horizontal: Beams {
        samples: 720,
        min_angle_rad: -core::f64::consts::FRAC_PI_2,
        max_angle_rad: core::f64::consts::FRAC_PI_2,
    },
    vertical: Beams::ONE,
    range_min_m: 0.1,
    range_max_m: 30.0,
    too_near: TooNear::Blocks,
    noise: GaussianNoise::NONE,
    seed: 1,
    sensor: 0,
};

/// A sensor at `eye` that looks at `target`, turned by `roll` about its axis.
pub(crate) fn look_at(eye: DVec3, target: DVec3, roll: f64) -> Pose {
    let ahead = (target - eye).normalize();
    Pose::from_xyz_rpy(eye, DVec3::new(roll, -ahead.z.asin(), ahead.y.atan2(ahead.x)))
}

/// A material that shines in one colour whatever the light.
pub(crate) fn glowing(builder: &mut SceneBuilder, colour: [f32; 3]) -> MaterialId {
    let config = MaterialConfig {
        emissive: colour,
        diffuse: [0.0; 3],
        ambient: [0.0; 3],
        ..MaterialConfig::default()
    };
    builder.add_material(&config).expect("a valid material")
}

/// Adds a shape that all sensors see.
pub(crate) fn add(builder: &mut SceneBuilder, shape: Shape, pose: Pose, material: MaterialId) -> InstanceId {
    let config = InstanceConfig { shape, world_from_instance: pose, material, ..Default::default() };
    builder.add_instance(&config).expect("a valid instance")
}

/// Adds one grey shape.
pub(crate) fn add_grey(builder: &mut SceneBuilder, shape: Shape, pose: Pose) -> InstanceId {
    let grey = glowing(builder, [0.5; 3]);
    add(builder, shape, pose, grey)
}

fn capture(pose: Pose, frame: u64) -> Capture {
    Capture { world_from_sensor: pose, frame }
}

/// Takes frame 0 of a depth camera.
pub(crate) fn depth_image(scene: &Scene<'_>, config: DepthCameraConfig, pose: Pose) -> Vec<f32> {
    depth_frame(scene, config, pose, 0)
}

/// Takes a frame of a depth camera.
pub(crate) fn depth_frame(scene: &Scene<'_>, config: DepthCameraConfig, pose: Pose, frame: u64) -> Vec<f32> {
    let camera = DepthCamera::new(config).expect("a valid camera");
    let mut depth = vec![0.0; camera.pixels()];
    let output = DepthFrame { depth_32fc1: Some(&mut depth), ..DepthFrame::default() };
    camera.sense(
        scene,
        &capture(pose, frame),
        &mut WorkspaceBuf::default().lend(scene, camera.rays()),
        output,
    );
    depth
}

/// Takes frame 0 of a colour camera.
pub(crate) fn picture(scene: &Scene<'_>, config: CameraConfig, pose: Pose) -> Vec<u8> {
    picture_with(scene, config, pose, 0, Execution::default())
}

/// Takes a frame of a colour camera in some way of execution.
pub(crate) fn picture_with(
    scene: &Scene<'_>,
    config: CameraConfig,
    pose: Pose,
    frame: u64,
    execution: Execution,
) -> Vec<u8> {
    let camera = Camera::new(config).expect("a valid camera");
    let mut pixels = vec![0; camera.frame_len()];
    let mut workspace = WorkspaceBuf::default();
    workspace.execution = execution;
    camera.sense(scene, &capture(pose, frame), &mut workspace.lend(scene, camera.rays()), &mut pixels);
    pixels
}

/// Takes frame 0 of a lidar: ranges and intensities.
pub(crate) fn scan(scene: &Scene<'_>, config: LidarConfig, pose: Pose) -> (Vec<f32>, Vec<f32>) {
    scan_frame(scene, config, pose, 0)
}

/// Takes a frame of a lidar: ranges and intensities.
pub(crate) fn scan_frame(
    scene: &Scene<'_>,
    config: LidarConfig,
    pose: Pose,
    frame: u64,
) -> (Vec<f32>, Vec<f32>) {
    let lidar = Lidar::new(config).expect("a valid lidar");
    let (mut ranges, mut intensities) = (vec![0.0; lidar.beams()], vec![0.0; lidar.beams()]);
    let mut workspace = WorkspaceBuf::default();
    lidar.sense(
        scene,
        &capture(pose, frame),
        &mut workspace.lend(scene, lidar.rays()),
        &mut ranges,
        &mut intensities,
    );
    (ranges, intensities)
}

/// A scene with every shape, texture and kind of lamp; returns an instance that may be moved.
pub(crate) fn scenery(builder: &mut SceneBuilder) -> InstanceId {
    let texels: Vec<[u8; 4]> =
        (0..60 * 44).map(|i| [(i * 7 % 256) as u8, (i / 60 * 5) as u8, (i % 60 * 4) as u8, 255]).collect();
    let texture = builder.add_texture(60, 44, &texels).expect("a valid texture");
    let plain = builder.add_material(&MaterialConfig::default()).expect("a valid material");
    let patterned = builder
        .add_material(&MaterialConfig {
            texture: Some(texture),
            texture_repeat: [3.0, 2.0],
            emissive: [0.02, 0.0, 0.05],
            ..MaterialConfig::default()
        })
        .expect("a valid material");
    let corners = [[-0.5, -0.5, -0.3], [0.5, -0.5, -0.3], [0.0, 0.6, -0.3], [0.0, 0.0, 0.7]];
    let uvs = [[0.0, 0.0], [1.0, 0.0], [0.5, 1.0], [0.5, 0.5]];
    let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let mesh = builder.add_mesh(&corners, &uvs, &faces).expect("a valid mesh");

    add(builder, Shape::Box { size: [12.0, 8.0, 0.1] }, Pose::from_translation(DVec3::Z * -0.05), patterned);
    let wall = Pose::from_xyz_rpy(DVec3::new(4.0, 0.0, 1.5), DVec3::new(0.0, -1.57, 0.1));
    add(builder, Shape::Rectangle { size: [3.0, 6.0] }, wall, plain);
    let shapes = [
        Shape::Box { size: [0.5, 0.4, 0.6] },
        Shape::Sphere { radius: 0.35 },
        Shape::Cylinder { radius: 0.25, length: 0.8 },
        Shape::Capsule { radius: 0.2, length: 0.5 },
        Shape::Mesh(mesh),
        Shape::Rectangle { size: [0.6, 0.9] },
    ];
    let mut last = InstanceId(0);
    for index in 0..24 {
        let i = f64::from(index);
        // Scattered without the platform's sine: the scene's bits are the same everywhere.
        let position =
            DVec3::new((i * 0.618).fract() * 5.0 - 2.0, (i * 0.414).fract() * 5.0 - 2.5, 0.3 + i * 0.06);
        let pose = Pose::from_xyz_rpy(position, DVec3::new(0.4 * i, 0.3 * i - 1.2, i));
        let material = if index % 3 == 0 { plain } else { patterned };
        last = add(builder, shapes[index as usize % shapes.len()], pose, material);
    }
    let position = [-1.0, 0.5, 2.6];
    for (kind, range_m) in [
        (LightKind::Point { position: [1.0, -1.5, 2.4] }, 5.0),
        (LightKind::Directional { direction: [0.4, 0.3, -1.0] }, f32::INFINITY),
        (LightKind::Spot { position, direction: [0.5, 0.0, -1.0], cos_inner: 0.95, cos_outer: 0.8 }, 20.0),
    ] {
        let attenuation = [0.9, 0.05, 0.02];
        builder.add_light(&LightConfig {
            kind,
            diffuse: [0.5, 0.45, 0.4],
            range_m,
            attenuation,
            cast_shadows: true,
        });
    }
    last
}
