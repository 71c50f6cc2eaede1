//! [`Caster`]: a mesh with its tree, on which rays are cast.

use crate::memory::Array;
use crate::sensor::Sensors;
use belvedere_sensors::Execution;
use belvedere_sensors::scene::MeshScene;
use belvedere_sensors::scene::build::{self, Quality, Scratch};
use belvedere_sensors::scene::tree::{Facet, TriangleBlock, WideNode};
use belvedere_sensors::simd::Level;
use belvedere_sensors::simd::WIDTH;
use belvedere_sensors::trace::rays::{MeshTree, Rays, cast_mesh};
use belvedere_sensors::trace::{CacheLine, Faces, Hits, Workspace, cast_grid, grid_workspace_len};

/// A mesh and its tree.
pub(crate) struct Caster {
    triangles: Vec<[u32; 3]>,
    /// The number of vertices of the given mesh.
    pub(crate) vertices: usize,
    nodes: Array<WideNode>,
    blocks: Array<TriangleBlock>,
    facets: Array<Facet>,
    /// The numbers of nodes, blocks and facets that are used.
    size: build::TreeSize,
    execution: Execution,
    sensors: Sensors,
    workspace: Array<CacheLine>,
}

/// Returns the level that the environment variable names, otherwise the best one.
fn level() -> Level {
    let best = Level::new();
    let wanted = std::env::var("BELVEDERE_SIMD").unwrap_or_default();
    #[cfg(target_arch = "x86_64")]
    let forced = match wanted.as_str() {
        "sse2" => best.as_sse2().map(Level::Sse2),
        "avx2" => best.as_avx2().map(Level::Avx2),
        "avx512" => best.as_avx512().map(Level::Avx512),
        _ => None,
    };
    #[cfg(not(target_arch = "x86_64"))]
    let forced = None;
    if forced.is_none() && !wanted.is_empty() {
        eprintln!("BELVEDERE_SIMD={wanted} is not available here; using {best:?}");
    }
    forced.unwrap_or(best)
}

impl Caster {
    /// Returns `None`, with a line on stderr, if the mesh is invalid.
    pub(crate) fn new(positions: &[[f32; 3]], triangles: &[[u32; 3]], threads: usize) -> Option<Self> {
        let execution = Execution { level: level(), parallel: threads > 1 };
        let most = build::max_size(triangles.len());
        let made = || -> Result<Self, Box<dyn std::error::Error>> {
            let mut scratch: Array<Scratch> = Array::new(build::scratch_len(triangles.len()))?;
            let mut nodes = Array::new(most.nodes)?;
            let mut blocks = Array::new(most.blocks)?;
            let size = build::build(
                positions,
                triangles,
                Quality::High,
                execution,
                scratch.as_mut_slice(),
                nodes.as_mut_slice(),
                blocks.as_mut_slice(),
            )?;
            let mut facets = Array::new(size.blocks * WIDTH)?;
            build::fill_facets(&blocks.as_slice()[..size.blocks], execution, facets.as_mut_slice());
            let triangles = triangles.to_vec();
            let (sensors, workspace) = (Sensors::default(), Array::new(0)?);
            let vertices = positions.len();
            Ok(Self { triangles, vertices, nodes, blocks, facets, size, execution, sensors, workspace })
        };
        made().inspect_err(|error| eprintln!("belvedere: {error}")).ok()
    }

    /// Refits to moved vertices. Returns true on success.
    pub(crate) fn refit(&mut self, positions: &[[f32; 3]]) -> bool {
        let (nodes, blocks) = (self.nodes.as_mut_slice(), self.blocks.as_mut_slice());
        let (nodes, blocks) = (&mut nodes[..self.size.nodes], &mut blocks[..self.size.blocks]);
        let done = build::refit(positions, &self.triangles, self.execution, nodes, blocks).is_ok();
        build::fill_facets(blocks, self.execution, self.facets.as_mut_slice());
        done
    }

    /// Casts rays in rows ([columns, rows]), on the given number of threads.
    #[allow(clippy::too_many_arguments, reason = "what the benchmark gives, and where answers go")]
    pub(crate) fn cast(
        &mut self,
        rows: [usize; 2],
        origins: &[[f32; 3]],
        directions: &[[f32; 3]],
        t: &mut [f32],
        normal: &mut [[f32; 3]],
        primitive: &mut [u32],
        threads: usize,
    ) {
        let shared = if origins.len() == 1 { self.sensors.find(rows, directions) } else { None };
        let Some(sensor) = shared else {
            self.cast_rays(origins, directions, t, normal, primitive, threads);
            return;
        };
        let mesh = MeshScene::new(
            &self.nodes.as_slice()[..self.size.nodes],
            &self.blocks.as_slice()[..self.size.blocks],
            self.facets.as_slice(),
        );
        let Ok(mesh) = mesh.inspect_err(|error| eprintln!("belvedere: {error}")) else { return };
        let scene = mesh.scene();
        let need = grid_workspace_len(&scene, &sensor.grid);
        if self.workspace.as_slice().len() < need {
            match Array::new(need) {
                Ok(workspace) => self.workspace = workspace,
                Err(error) => {
                    eprintln!("belvedere: {error}");
                    return;
                }
            }
        }
        let execution = Execution { parallel: threads > 1, ..self.execution };
        let mut workspace = Workspace { buffer: self.workspace.as_mut_slice(), execution };
        let hits =
            Hits { distance: Some(t), normal: Some(normal), primitive: Some(primitive), ..Hits::default() };
        let cast = cast_grid(
            &scene,
            &mesh.moment(sensor.pose(origins[0])),
            &sensor.grid,
            [0.0, f64::INFINITY],
            u32::MAX,
            Faces::Both,
            &mut workspace,
            hits,
        );
        if let Err(error) = cast {
            eprintln!("belvedere: {error}");
        }
    }

    /// Casts independent rays.
    fn cast_rays(
        &self,
        origins: &[[f32; 3]],
        directions: &[[f32; 3]],
        t: &mut [f32],
        normal: &mut [[f32; 3]],
        primitive: &mut [u32],
        threads: usize,
    ) {
        if threads > 1 && directions.len() > 1 {
            let middle = directions.len() / 2;
            let shared = origins.len() == 1;
            let (origins, other_origins) = if shared { (origins, origins) } else { origins.split_at(middle) };
            let (directions, other_directions) = directions.split_at(middle);
            let (t, other_t) = t.split_at_mut(middle);
            let (normal, other_normal) = normal.split_at_mut(middle);
            let (primitive, other_primitive) = primitive.split_at_mut(middle);
            let half = threads / 2;
            rayon::join(
                || self.cast_rays(origins, directions, t, normal, primitive, half),
                || {
                    self.cast_rays(
                        other_origins,
                        other_directions,
                        other_t,
                        other_normal,
                        other_primitive,
                        half,
                    );
                },
            );
            return;
        }
        let tree = MeshTree {
            nodes: &self.nodes.as_slice()[..self.size.nodes],
            blocks: &self.blocks.as_slice()[..self.size.blocks],
        };
        let rays = Rays { origins, directions, ranges: None };
        let mut hits =
            Hits { distance: Some(t), normal: Some(normal), primitive: Some(primitive), ..Hits::default() };
        cast_mesh(self.execution.level, tree, &rays, Faces::Both, &mut hits)
            .expect("outputs of the right size");
    }
}
