//! The fuzz target: builds a scene from arbitrary bytes and casts rays in it from any position. It must neither panic
//! nor hang. The tests run it too, with their own bytes.

use belvedere_sensors::optics::{Optics, PinholeGrid, SphericalGrid};
use belvedere_sensors::scene::{InstanceConfig, MaterialConfig, MaterialId, Scene, SceneBuilder, Shape};
use belvedere_sensors::trace::rays::{Rays, cast_rays, occluded_rays, workspace_len};
use belvedere_sensors::trace::{CacheLine, Faces, Hits, WorkspaceBuf, cast_grid, grid_workspace_len};
use belvedere_sensors::{Moment, Pose};
use glam::{DQuat, DVec3};

/// The largest number of rays; more would take too long.
const MOST_RAYS: usize = 64;

/// Reads numbers from bytes; 0 after the last byte.
struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        let mut taken = [0; N];
        let length = N.min(self.0.len());
        taken[..length].copy_from_slice(&self.0[..length]);
        self.0 = &self.0[length..];
        taken
    }

    fn f32(&mut self) -> f32 {
        f32::from_le_bytes(self.take())
    }

    /// A coordinate of the size that simulators use.
    fn metres(&mut self) -> f32 {
        f32::from(i16::from_le_bytes(self.take())) * 1e-3
    }

    fn u8(&mut self) -> u8 {
        self.take::<1>()[0]
    }
}

/// The first byte selects a baked scene or one that is built.
pub(crate) fn sense(data: &[u8]) {
    let Some((&first, data)) = data.split_first() else { return };
    if first & 1 == 0 {
        let (rays, scene) = data.split_at(data.len().min(200));
        sense_scene(scene, rays);
    } else {
        sense_built(data);
    }
}

/// Interprets some bytes as a baked scene and others as rays.
pub(crate) fn sense_scene(scene: &[u8], rays: &[u8]) {
    let mut lines = vec![CacheLine::ZERO; scene.len().div_ceil(64)];
    let aligned: &mut [u8] = &mut bytemuck::cast_slice_mut(&mut lines)[..scene.len()];
    aligned.copy_from_slice(scene);
    if let Ok((scene, poses)) = Scene::from_baked(aligned) {
        cast(&scene, poses, Bytes(rays));
    }
}

/// Builds a scene from the bytes, without the parts that are refused.
fn sense_built(data: &[u8]) {
    let mut bytes = Bytes(data);
    let mut builder = SceneBuilder::new();
    let Ok(material) = builder.add_material(&MaterialConfig::default()) else { return };
    let exact = bytes.u8() & 1 == 0;
    let vertices: Vec<[f32; 3]> = (0..bytes.u8() & 63)
        .map(|_| [(); 3].map(|()| if exact { bytes.metres() } else { bytes.f32() }))
        .collect();
    let triangles: Vec<[u32; 3]> =
        (0..bytes.u8() & 127).map(|_| bytes.take::<3>().map(|index| u32::from(index & 63))).collect();
    let mut shapes = vec![Shape::Plane, Shape::Sphere { radius: f64::from(bytes.f32()) }];
    shapes.push(Shape::Box { size: [(); 3].map(|()| f64::from(bytes.metres())) });
    shapes.push(Shape::Cone { radius: f64::from(bytes.metres()), length: f64::from(bytes.metres()) });
    shapes.extend(builder.add_mesh(&vertices, &[], &triangles).ok().map(Shape::Mesh));
    for shape in shapes {
        let config = InstanceConfig { shape, material, scale: [1.0; 3], ..instance(&mut bytes, material) };
        // A refused instance is left out.
        let _ = builder.add_instance(&config);
    }
    cast(&builder.scene(), builder.poses(), bytes);
}

fn instance(bytes: &mut Bytes<'_>, material: MaterialId) -> InstanceConfig {
    let translation = DVec3::new(bytes.metres().into(), bytes.metres().into(), bytes.metres().into());
    let turn = DQuat::from_xyzw(bytes.metres().into(), bytes.metres().into(), bytes.metres().into(), 1.0);
    InstanceConfig { world_from_instance: Pose::new(translation, turn), material, ..Default::default() }
}

/// Casts rays of all kinds.
fn cast(scene: &Scene<'_>, world_from_instance: &[Pose], mut bytes: Bytes<'_>) {
    let place = DVec3::new(bytes.metres().into(), bytes.metres().into(), bytes.metres().into());
    let pose = Pose::from_xyz_rpy(place, DVec3::new(bytes.metres().into(), bytes.metres().into(), 0.0));
    let moment = Moment { world_from_sensor: pose, world_from_instance };
    let mut workspace = WorkspaceBuf::default();
    let steps = [bytes.metres().abs() * 0.05 + 1e-4, bytes.metres().abs() * 0.005 + 1e-4].map(f64::from);
    let grids = [
        Optics::Pinhole(PinholeGrid::from_fov(9, 7, 1.2).unwrap()),
        Optics::Spherical(SphericalGrid {
            columns: 21,
            rows: 5,
            first_azimuth_rad: f64::from(bytes.metres()) * 0.1,
            azimuth_step_rad: steps[0],
            first_elevation_rad: -0.3,
            elevation_step_rad: steps[1],
        }),
    ];
    let faces = if bytes.u8() & 1 == 0 { Faces::Front } else { Faces::Both };
    for grid in grids {
        let count = grid.size()[0] * grid.size()[1];
        let mut outputs = Outputs::new(count);
        let mut workspace = workspace.lend(grid_workspace_len(scene, &grid));
        // Invalid grids may be refused.
        let _ =
            cast_grid(scene, &moment, &grid, [1e-3, 1e6], u32::MAX, faces, &mut workspace, outputs.hits());
    }
    let (mut origins, mut directions, mut ranges) = (Vec::new(), Vec::new(), Vec::new());
    while !bytes.0.is_empty() && origins.len() < MOST_RAYS {
        let wild = bytes.u8().is_multiple_of(4);
        let mut vector = || [(); 3].map(|()| if wild { bytes.f32() } else { bytes.metres() });
        origins.push(vector());
        directions.push(vector());
        ranges.push([0.0, bytes.f32()]);
    }
    let rays = Rays { origins: &origins, directions: &directions, ranges: Some(&ranges) };
    let mut outputs = Outputs::new(origins.len());
    let mut occluded = vec![false; origins.len()];
    let mut workspace = workspace.lend(workspace_len(scene));
    cast_rays(scene, world_from_instance, place, &rays, u32::MAX, faces, &mut workspace, outputs.hits())
        .expect("outputs of the right size");
    occluded_rays(scene, world_from_instance, place, &rays, u32::MAX, faces, &mut workspace, &mut occluded)
        .expect("outputs of the right size");
}

struct Outputs {
    distance: Vec<f32>,
    normal: Vec<[f32; 3]>,
    instance: Vec<u32>,
    primitive: Vec<u32>,
    barycentrics: Vec<[f32; 2]>,
}

impl Outputs {
    fn new(count: usize) -> Self {
        Self {
            distance: vec![0.0; count],
            normal: vec![[0.0; 3]; count],
            instance: vec![0; count],
            primitive: vec![0; count],
            barycentrics: vec![[0.0; 2]; count],
        }
    }

    fn hits(&mut self) -> Hits<'_> {
        Hits {
            distance: Some(&mut self.distance),
            normal: Some(&mut self.normal),
            instance: Some(&mut self.instance),
            primitive: Some(&mut self.primitive),
            barycentrics: Some(&mut self.barycentrics),
        }
    }
}
