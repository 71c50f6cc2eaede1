//! Code that the tests of the sensors share.
#![allow(dead_code, reason = "each test uses its part")]
#![allow(clippy::large_types_passed_by_value, reason = "configurations made where they are used read better")]

pub(crate) mod adversary;
pub(crate) mod brute;
pub(crate) mod casts;
pub(crate) mod exactness;
pub(crate) mod oracle;
pub(crate) mod planes;
pub(crate) mod random;

use belvedere_sensors::camera::{Camera, CameraConfig, Picture};
use belvedere_sensors::depth::{DepthCamera, DepthCameraConfig, DepthFrame};
use belvedere_sensors::lidar::{Beams, Lidar, LidarConfig, Scan, TooNear};
use belvedere_sensors::noise::GaussianNoise;
use belvedere_sensors::optics::{Optics, PinholeGrid};
use belvedere_sensors::scene::{
    InstanceConfig, InstanceId, LightConfig, LightKind, MaterialConfig, MaterialId, Scene, SceneBuilder,
    Shape,
};
use belvedere_sensors::trace::WorkspaceBuf;
use belvedere_sensors::{Capture, Execution, Moment, Pose, Sensor};
use glam::DVec3;

/// The size in pixels of the pictures of [`camera`].
pub(crate) const SIZE: [u32; 2] = [640, 480];

/// A camera of 640 × 480 pixels without noise, 1.2 rad wide.
pub(crate) fn camera() -> CameraConfig<'static> {
    camera_of(SIZE, 1.2)
}

/// The same with another size and angle of view.
pub(crate) fn camera_of([width, height]: [u32; 2], horizontal_fov_rad: f64) -> CameraConfig<'static> {
    CameraConfig::new(PinholeGrid::from_fov(width, height, horizontal_fov_rad).unwrap()).seed(1)
}

/// The pinhole of a camera; panics for another lens.
pub(crate) fn pinhole(config: &CameraConfig<'_>) -> PinholeGrid {
    match config.optics {
        Optics::Pinhole(lens) => lens,
        _ => panic!("the camera has another lens"),
    }
}

/// A depth camera with that geometry, whose depths are only limited by the clip distances.
pub(crate) fn depth_camera() -> DepthCameraConfig<'static> {
    DepthCameraConfig::new(camera())
}

/// A horizontal lidar with a field of view of half a turn.
pub(crate) const LIDAR: LidarConfig = LidarConfig::new(Beams {
    samples: 720,
    min_angle_rad: -core::f64::consts::FRAC_PI_2,
    max_angle_rad: core::f64::consts::FRAC_PI_2,
})
.vertical(Beams::ONE)
.range_min_m(0.1)
.range_max_m(30.0)
.too_near(TooNear::Blocks)
.noise(GaussianNoise::NONE)
.seed(1)
.sensor(0);

/// The pose of a sensor at `eye` that looks at `target`, rolled by `roll` about its axis.
pub(crate) fn look_at(eye: DVec3, target: DVec3, roll: f64) -> Pose {
    let ahead = (target - eye).normalize();
    Pose::from_xyz_rpy(eye, DVec3::new(roll, -ahead.z.asin(), ahead.y.atan2(ahead.x)))
}

/// Adds a material that emits one colour, whatever the light.
pub(crate) fn glowing(builder: &mut SceneBuilder, colour: [f32; 3]) -> MaterialId {
    let config = MaterialConfig {
        emissive: colour,
        diffuse: [0.0; 3],
        ambient: [0.0; 3],
        ..MaterialConfig::default()
    };
    builder.add_material(&config).expect("a valid material")
}

/// Adds a shape that is visible to all sensors.
pub(crate) fn add(builder: &mut SceneBuilder, shape: Shape, pose: Pose, material: MaterialId) -> InstanceId {
    let config = InstanceConfig { shape, world_from_instance: pose, material, ..Default::default() };
    builder.add_instance(&config).expect("a valid instance")
}

/// Adds one grey shape.
pub(crate) fn add_grey(builder: &mut SceneBuilder, shape: Shape, pose: Pose) -> InstanceId {
    let grey = glowing(builder, [0.5; 3]);
    add(builder, shape, pose, grey)
}

/// A scene, and the poses of its instances.
#[derive(Clone, Copy)]
pub(crate) struct Stage<'a> {
    pub(crate) scene: Scene<'a>,
    pub(crate) poses: &'a [Pose],
}

impl<'a> From<&'a SceneBuilder> for Stage<'a> {
    fn from(builder: &'a SceneBuilder) -> Self {
        Self { scene: builder.scene(), poses: builder.poses() }
    }
}

impl<'a> From<(Scene<'a>, &'a [Pose])> for Stage<'a> {
    fn from((scene, poses): (Scene<'a>, &'a [Pose])) -> Self {
        Self { scene, poses }
    }
}

impl<'a> Stage<'a> {
    /// The moment with a sensor at this pose.
    pub(crate) fn moment(&self, world_from_sensor: Pose) -> Moment<'a> {
        Moment { world_from_sensor, world_from_instance: self.poses }
    }

    fn capture(&self, pose: Pose, frame: u64) -> Capture<'a> {
        Capture::new(frame, self.moment(pose))
    }
}

/// Takes frame 0 of a depth camera.
pub(crate) fn depth_image<'a>(
    stage: impl Into<Stage<'a>>,
    config: DepthCameraConfig<'_>,
    pose: Pose,
) -> Vec<f32> {
    depth_frame(stage, config, pose, 0)
}

/// Takes a frame of a depth camera.
pub(crate) fn depth_frame<'a>(
    stage: impl Into<Stage<'a>>,
    config: DepthCameraConfig<'_>,
    pose: Pose,
    frame: u64,
) -> Vec<f32> {
    let stage = stage.into();
    let camera = DepthCamera::new(config).expect("a valid camera");
    let mut depth = vec![0.0; camera.pixels()];
    let output = DepthFrame::new().depth_32fc1(&mut depth);
    let capture = stage.capture(pose, frame);
    camera
        .sense(
            &stage.scene,
            &capture,
            &mut WorkspaceBuf::default().lend(camera.workspace_len(&stage.scene, &capture)),
            output,
        )
        .expect("outputs of the right size");
    depth
}

/// Takes frame 0 of a colour camera.
pub(crate) fn picture<'a>(stage: impl Into<Stage<'a>>, config: CameraConfig<'_>, pose: Pose) -> Vec<u8> {
    picture_with(stage, config, pose, 0, Execution::default())
}

/// Takes a frame of a colour camera with the given execution.
pub(crate) fn picture_with<'a>(
    stage: impl Into<Stage<'a>>,
    config: CameraConfig<'_>,
    pose: Pose,
    frame: u64,
    execution: Execution,
) -> Vec<u8> {
    let stage = stage.into();
    let camera = Camera::new(config).expect("a valid camera");
    let mut pixels = vec![0; camera.frame_len()];
    let mut workspace = WorkspaceBuf::default();
    workspace.execution = execution;
    let capture = stage.capture(pose, frame);
    camera
        .sense(
            &stage.scene,
            &capture,
            &mut workspace.lend(camera.workspace_len(&stage.scene, &capture)),
            Picture::new().colour(&mut pixels),
        )
        .expect("outputs of the right size");
    pixels
}

/// Takes frame 0 of a lidar and returns ranges and intensities.
pub(crate) fn scan<'a>(stage: impl Into<Stage<'a>>, config: LidarConfig, pose: Pose) -> (Vec<f32>, Vec<f32>) {
    scan_frame(stage, config, pose, 0)
}

/// Takes a frame of a lidar and returns ranges and intensities.
pub(crate) fn scan_frame<'a>(
    stage: impl Into<Stage<'a>>,
    config: LidarConfig,
    pose: Pose,
    frame: u64,
) -> (Vec<f32>, Vec<f32>) {
    let stage = stage.into();
    let lidar = Lidar::new(config).expect("a valid lidar");
    let (mut ranges, mut intensities) = (vec![0.0; lidar.beams()], vec![0.0; lidar.beams()]);
    let mut workspace = WorkspaceBuf::default();
    let capture = stage.capture(pose, frame);
    lidar
        .sense(
            &stage.scene,
            &capture,
            &mut workspace.lend(lidar.workspace_len(&stage.scene, &capture)),
            Scan::new().ranges(&mut ranges).intensities(&mut intensities),
        )
        .expect("outputs of the right size");
    (ranges, intensities)
}

/// Builds a scene with every shape, texture and kind of lamp, and returns an instance that may be moved.
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
        // Scattered without the platform's sine, so that the bits of the scene are the same on every machine.
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
        (spot(position, DVec3::new(0.5, 0.0, -1.0), [0.95, 0.8, 1.0]), 20.0),
    ] {
        let attenuation = [0.9, 0.05, 0.02];
        builder
            .add_light(&LightConfig {
                kind,
                diffuse: [0.5, 0.45, 0.4],
                range_m,
                attenuation,
                cast_shadows: true,
                ..LightConfig::default()
            })
            .unwrap();
    }
    last
}

/// A spot: the cosines of half its inner and outer angle, and its falloff.
pub(crate) fn spot(
    position: [f64; 3],
    direction: DVec3,
    [cos_inner, cos_outer, falloff]: [f32; 3],
) -> LightKind {
    LightKind::Spot { position, direction: direction.to_array(), cos_inner, cos_outer, falloff }
}
