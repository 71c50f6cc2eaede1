//! Bodies whose triangles are smaller than a pixel, over a terrain, like a robot in a small image.

use super::noise::octaves;
use super::solids::Solids;
use super::{Mesh, ours};
use belvedere_sensors::Pose;
use belvedere_sensors::camera::CameraConfig;
use belvedere_sensors::depth::{DepthCamera, DepthCameraConfig, DepthFrame};
use belvedere_sensors::optics::PinholeGrid;
use belvedere_sensors::scene::{InstanceConfig, LightConfig, LightKind, MaterialConfig, SceneBuilder, Shape};
use belvedere_sensors::simd::Level;
use belvedere_sensors::trace::{Faces, WorkspaceBuf};
use belvedere_sensors::{Capture, Execution, Sensor};
use glam::DVec3;

const BODIES: u32 = 31;
/// Cells along an edge of each face of the cube that is projected onto a body: 4,800 triangles.
const CELLS: u32 = 20;
/// Heights along each side of the terrain.
const HEIGHTS: u32 = 65;
/// Pixels of an image along each side.
const PIXELS: u32 = 64;

/// A depth camera that looks at them.
pub struct FineMeshes {
    builder: SceneBuilder,
    camera: DepthCamera<'static>,
    workspace: WorkspaceBuf,
    depths: Vec<f32>,
    colours: Vec<u8>,
}

impl FineMeshes {
    pub fn new(level: Level) -> Self {
        let mut builder = SceneBuilder::new();
        let material = builder.add_material(&MaterialConfig::default()).expect("a plain material");
        let mesh = body();
        let mesh = builder.add_mesh(&mesh.vertices, &[], &mesh.triangles).expect("our own mesh");
        let heights: Vec<f32> = (0..HEIGHTS * HEIGHTS)
            .map(|index| {
                let (row, column) = (f64::from(index / HEIGHTS), f64::from(index % HEIGHTS));
                0.3 * octaves(DVec3::new(row * 0.2, column * 0.2, 0.5), 3, 7, 0.5) as f32
            })
            .collect();
        let field = builder.add_height_field(HEIGHTS, HEIGHTS, [8.0; 2], &heights).expect("our own terrain");
        let mut add = |shape, world_from_instance| {
            let config = InstanceConfig { shape, world_from_instance, material, ..InstanceConfig::default() };
            builder.add_instance(&config).expect("our own instance");
        };
        add(Shape::HeightField(field), Pose::IDENTITY);
        for body in 0..BODIES {
            let i = f64::from(body);
            let (sin, cos) = libm::sincos(i);
            let at = DVec3::new(2.5 + 0.2 * cos, 0.3 * sin, 0.3 + 0.05 * i);
            add(Shape::Mesh(mesh), Pose::from_xyz_rpy(at, DVec3::new(i, 0.5 * i, 0.0)));
        }
        let kind = LightKind::Directional { direction: [0.4, 0.2, -1.0] };
        let lamp = LightConfig { kind, diffuse: [0.7; 3], cast_shadows: false, ..Default::default() };
        builder.add_light(&lamp).expect("our own lamp");
        let lens = PinholeGrid::from_fov(PIXELS, PIXELS, 1.2).expect("in range");
        let camera = DepthCamera::new(DepthCameraConfig::new(CameraConfig::new(lens)).faces(Faces::Front))
            .expect("in range");
        let mut workspace = WorkspaceBuf::default();
        workspace.execution = Execution::at(level);
        let (pixels, bytes) = (camera.pixels(), camera.camera().frame_len());
        let mut made =
            Self { builder, camera, workspace, depths: vec![0.0; pixels], colours: vec![0; bytes] };
        // Allocates.
        made.sense();
        made
    }

    /// Renders an image of depths and colours.
    pub fn sense(&mut self) {
        let scene = self.builder.scene();
        let pose = Pose::from_translation(DVec3::new(0.0, 0.0, 1.0));
        let capture = Capture::new(0, self.builder.moment(pose));
        let output = DepthFrame::new().depth_32fc1(&mut self.depths).colour(&mut self.colours);
        self.camera
            .sense_in(&mut self.workspace, &scene, &capture, output)
            .expect("outputs of the right size");
    }
}

/// A ball of 0.1 m with a rough surface.
fn body() -> Mesh {
    let mut solids = Solids::default();
    let along = |i: usize| i as f64 / f64::from(CELLS) * 2.0 - 1.0;
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            solids.grid(CELLS, side < 0.0, |i, j| {
                let mut on_cube = DVec3::ZERO;
                on_cube[axis] = side;
                on_cube[(axis + 1) % 3] = along(i);
                on_cube[(axis + 2) % 3] = along(j);
                let direction = on_cube / on_cube.dot(on_cube).sqrt();
                direction * (0.1 + 0.01 * octaves(direction * 6.0 + 40.0, 2, 11, 0.5))
            });
        }
    }
    solids.finish()
}
