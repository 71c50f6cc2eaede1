//! Casts of ray sets, and their results.

use super::super::rays::{RaySet, Source};
use super::Built;
use belvedere_sensors::optics::{Intrinsics, Optics, Pinhole, PinholeGrid, SphericalGrid};
use belvedere_sensors::scene::visibility;
use belvedere_sensors::trace::rays::{Rays, cast_rays, workspace_len};
use belvedere_sensors::trace::{Faces, Hits, WorkspaceBuf, cast_grid, grid_workspace_len};
use belvedere_sensors::{Execution, Pose};
use core::f64::consts::PI;
use glam::DVec3;

/// The output of a cast.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wanted {
    /// Only the distance, to front faces, as for a depth camera.
    Distance,
    /// Distance, unit normal and triangle.
    All,
}

/// A ray set that is ready to be cast, with memory for its results.
pub struct Caster {
    work: Work,
    workspace: WorkspaceBuf,
    distances: Vec<f32>,
    normals: Vec<[f32; 3]>,
    triangles: Vec<u32>,
}

/// The rays that are cast.
enum Work {
    /// The frame of a sensor.
    Grid(Box<Optics<'static>>, Pose),
    /// Independent rays.
    Single { origins: Vec<[f32; 3]>, directions: Vec<[f32; 3]> },
}

impl Caster {
    pub fn new(rays: &RaySet, execution: Execution, wanted: Wanted) -> Self {
        let work = match &rays.source {
            Source::Pinhole { world_from_sensor, focal_px } => {
                Work::Grid(Box::new(lens(rays, *focal_px).into()), *world_from_sensor)
            }
            Source::Rings { world_from_sensor, elevations_rad } => {
                let azimuth_step_rad = -2.0 * PI / rays.width as f64;
                let grid = SphericalGrid {
                    columns: rays.width as u32,
                    rows: rays.height as u32,
                    first_azimuth_rad: 0.5 * azimuth_step_rad,
                    azimuth_step_rad,
                    first_elevation_rad: elevations_rad[0],
                    elevation_step_rad: elevations_rad.get(1).map_or(0.0, |next| next - elevations_rad[0]),
                };
                Work::Grid(Box::new(grid.into()), *world_from_sensor)
            }
            Source::Random => {
                Work::Single { origins: rays.origins.clone(), directions: rays.directions.clone() }
            }
        };
        let mut workspace = WorkspaceBuf::default();
        workspace.execution = execution;
        let details = if wanted == Wanted::All { rays.len() } else { 0 };
        Self {
            work,
            workspace,
            distances: vec![0.0; rays.len()],
            normals: vec![[0.0; 3]; details],
            triangles: vec![0; details],
        }
    }

    /// Casts all rays and returns the distances, which are infinite for misses.
    pub fn cast(&mut self, built: &Built) -> &[f32] {
        let details = !self.normals.is_empty();
        let hits = Hits {
            distance: Some(&mut self.distances),
            normal: details.then_some(&mut self.normals),
            primitive: details.then_some(&mut self.triangles),
            ..Hits::default()
        };
        let scene = built.builder.scene();
        let faces = if details { Faces::Both } else { Faces::Front };
        match &self.work {
            Work::Grid(grid, world_from_sensor) => cast_grid(
                &scene,
                &built.builder.moment(*world_from_sensor),
                grid,
                [0.0, f64::INFINITY],
                visibility::VISUAL,
                faces,
                &mut self.workspace.lend(grid_workspace_len(&scene, grid)),
                hits,
            ),
            Work::Single { origins, directions } => cast_rays(
                &scene,
                built.builder.poses(),
                DVec3::ZERO,
                &Rays { origins, directions, ranges: None },
                visibility::VISUAL,
                faces,
                &mut self.workspace.lend(workspace_len(&scene)),
                hits,
            ),
        }
        .expect("rays that can be cast");
        &self.distances
    }
}

/// Returns the pinhole grid of a ray set. Pixel centres are at integers here, and at halves in the ray sets; the middle
/// is the same.
fn lens(rays: &RaySet, focal_px: f64) -> PinholeGrid {
    let [cx, cy] = [rays.width, rays.height].map(|side| (side as f64 - 1.0) * 0.5);
    let lens = Pinhole::new(Intrinsics { fx: focal_px, fy: focal_px, cx, cy, skew: 0.0 });
    lens.and_then(|lens| PinholeGrid::new(rays.width as u32, rays.height as u32, lens)).expect("in range")
}
