//! Casts of a scenario with all outputs.

use super::brute::Found;
use super::exactness::Scenario;
use belvedere_sensors::optics::Optics;
use belvedere_sensors::scene::visibility::VISUAL;
use belvedere_sensors::simd::Level;
use belvedere_sensors::trace::rays::{Rays, cast_rays, occluded_rays, workspace_len};
use belvedere_sensors::trace::{Faces, Hits, WorkspaceBuf, cast_grid, grid_workspace_len};
use belvedere_sensors::{Execution, Pose};
use glam::DVec3;

/// The outputs of a cast.
pub(crate) struct Answers {
    pub(crate) distance: Vec<f32>,
    normal: Vec<[f32; 3]>,
    instance: Vec<u32>,
    primitive: Vec<u32>,
    barycentrics: Vec<[f32; 2]>,
}

impl Answers {
    fn new(rays: usize) -> Self {
        Self {
            distance: vec![f32::NAN; rays],
            normal: vec![[f32::NAN; 3]; rays],
            instance: vec![7; rays],
            primitive: vec![7; rays],
            barycentrics: vec![[f32::NAN; 2]; rays],
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

    pub(crate) fn of(&self, ray: usize) -> Found {
        Found {
            distance: self.distance[ray],
            normal: self.normal[ray],
            instance: self.instance[ray],
            primitive: self.primitive[ray],
            barycentrics: self.barycentrics[ray],
        }
    }

    /// Returns each output with its name, as bytes.
    pub(crate) fn bytes(&self) -> [(&'static str, Vec<u8>); 5] {
        [
            ("distance", bytemuck::cast_slice(&self.distance).to_vec()),
            ("normal", bytemuck::cast_slice(&self.normal).to_vec()),
            ("instance", bytemuck::cast_slice(&self.instance).to_vec()),
            ("primitive", bytemuck::cast_slice(&self.primitive).to_vec()),
            ("barycentrics", bytemuck::cast_slice(&self.barycentrics).to_vec()),
        ]
    }
}

/// The hits of the rays of a grid.
pub(crate) fn cast(
    scenario: &Scenario,
    (grid, pose, range): (&Optics<'_>, &Pose, [f64; 2]),
    faces: Faces,
    execution: Execution,
) -> Answers {
    let scene = scenario.pair.builder.scene();
    let [width, height] = grid.size();
    let mut answers = Answers::new(width * height);
    let mut workspace = WorkspaceBuf::default();
    workspace.execution = execution;
    let moment = scenario.pair.builder.moment(*pose);
    let workspace = &mut workspace.lend(grid_workspace_len(&scene, grid));
    cast_grid(&scene, &moment, grid, range, VISUAL, faces, workspace, answers.hits())
        .expect("outputs of the right size");
    answers
}

/// The hits of independent rays, and whether they hit anything.
pub(crate) fn cast_each(
    scenario: &Scenario,
    reference: DVec3,
    rays: &Rays<'_>,
    faces: Faces,
    execution: Execution,
) -> (Answers, Vec<bool>) {
    let (scene, poses) = (scenario.pair.builder.scene(), scenario.pair.builder.poses());
    let mut answers = Answers::new(rays.directions.len());
    let mut occluded = vec![false; rays.directions.len()];
    let mut workspace = WorkspaceBuf::default();
    workspace.execution = execution;
    let workspace = &mut workspace.lend(workspace_len(&scene));
    cast_rays(&scene, poses, reference, rays, VISUAL, faces, workspace, answers.hits())
        .expect("outputs of the right size");
    occluded_rays(&scene, poses, reference, rays, VISUAL, faces, workspace, &mut occluded)
        .expect("outputs of the right size");
    (answers, occluded)
}

/// The levels of this architecture; `None` for those that this machine does not have.
pub(crate) fn levels() -> Vec<(&'static str, Option<Level>)> {
    let best = Level::new();
    #[cfg(target_arch = "x86_64")]
    return vec![
        ("SSE2", best.as_sse2().map(Level::Sse2)),
        ("AVX2", best.as_avx2().map(Level::Avx2)),
        ("AVX-512", best.as_avx512().map(Level::Avx512)),
    ];
    #[cfg(not(target_arch = "x86_64"))]
    return vec![("the baseline", Some(Level::baseline())), ("the best", Some(best))];
}
