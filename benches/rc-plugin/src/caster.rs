//! One mesh, ready to be cast at.

use crate::memory::Array;
use belvedere_sensors::Execution;
use belvedere_sensors::scene::build::{self, Quality, Scratch};
use belvedere_sensors::scene::tree::{TriangleBlock, WideNode};
use belvedere_sensors::simd::Level;
use belvedere_sensors::trace::rays::{Rays, Tree, cast_mesh};
use belvedere_sensors::trace::{Faces, Hits};

/// A mesh and its tree.
pub(crate) struct Caster {
    triangles: Vec<[u32; 3]>,
    nodes: Array<WideNode>,
    blocks: Array<TriangleBlock>,
    /// How many of each are in use.
    size: build::TreeSize,
    execution: Execution,
}

/// The level that the environment asks for, else the best.
fn level() -> Level {
    let best = Level::new();
    let wanted = std::env::var("BELVEDERE_SIMD").unwrap_or_default();
    #[cfg(target_arch = "x86_64")]
    let forced = match wanted.as_str() {
        "sse2" => best.as_sse2().map(Level::Sse2),
        "sse4.2" => best.as_sse4_2().map(Level::Sse4_2),
        "avx2" => best.as_avx2().map(Level::Avx2),
        "avx512" => best.as_avx512().map(Level::Avx512),
        _ => None,
    };
    #[cfg(not(target_arch = "x86_64"))]
    let forced = None;
    if forced.is_none() && !wanted.is_empty() {
        eprintln!("BELVEDERE_SIMD={wanted} is not to be had here; using {best:?}");
    }
    forced.unwrap_or(best)
}

impl Caster {
    /// `None`, with a line on stderr, when the mesh is not one.
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
            Ok(Self { triangles: triangles.to_vec(), nodes, blocks, size, execution })
        };
        made().inspect_err(|error| eprintln!("belvedere: {error}")).ok()
    }

    /// Takes moved vertices; whether it could.
    pub(crate) fn refit(&mut self, positions: &[[f32; 3]]) -> bool {
        let (nodes, blocks) = (self.nodes.as_mut_slice(), self.blocks.as_mut_slice());
        build::refit(
            positions,
            &self.triangles,
            self.execution,
            &mut nodes[..self.size.nodes],
            &mut blocks[..self.size.blocks],
        )
        .is_ok()
    }

    /// How many vertices the mesh has at least.
    pub(crate) fn vertices(&self) -> usize {
        self.triangles.iter().flatten().max().map_or(0, |&last| last as usize + 1)
    }

    /// Casts the rays, on so many threads.
    pub(crate) fn cast(
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
                || self.cast(origins, directions, t, normal, primitive, half),
                || self.cast(other_origins, other_directions, other_t, other_normal, other_primitive, half),
            );
            return;
        }
        let tree = Tree {
            nodes: &self.nodes.as_slice()[..self.size.nodes],
            blocks: &self.blocks.as_slice()[..self.size.blocks],
        };
        let rays = Rays { origins, directions, ranges: None };
        let mut hits =
            Hits { distance: Some(t), normal: Some(normal), primitive: Some(primitive), ..Hits::default() };
        cast_mesh(self.execution.level, tree, &rays, Faces::Both, &mut hits);
    }
}
