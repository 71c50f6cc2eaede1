//! The memory that a frame works in: one buffer of the caller's.

use super::view::{Placed, ViewMemory, top_nodes};
use crate::execution::Execution;
use crate::memory::{CacheLine, Cutter, lines};
use crate::optics::rays::Fan;
use crate::scene::tree::{WIDTH, WideNode};
use crate::scene::{Aabb, Scene};
#[cfg(feature = "alloc")]
use bytemuck::Zeroable;

/// What a sensor needs to trace a frame, lent by the caller.
#[derive(Debug)]
pub struct Workspace<'a> {
    /// [`workspace_len`] cache lines at least.
    pub buffer: &'a mut [CacheLine],
    /// SIMD level and threads.
    pub execution: Execution,
}

/// Cache lines that a sensor of so many rays needs for a scene: about 14 bytes a ray and 400 an instance.
///
/// `rays` are those of a grid filled up to whole blocks, as the sensors' own `rays()` tell them.
pub const fn workspace_len(instances: usize, rays: usize) -> usize {
    let blocks = rays.div_ceil(WIDTH);
    // 1/t and slots, the farthest of each block, the tables of a grid, a depth camera's rays that are blocked, and the
    // marks of a picture.
    let traced = 2 * blocks + lines((blocks + BAND_MARGIN) * 4) + Fan::most_table_lines(rays);
    view_lines(instances) + traced + lines(blocks * 2) + blocks
}

/// `farthest` of each band is read up to sixteen past its end, and begins on a cache line of its own.
pub(super) const BAND_MARGIN: usize = 3 * WIDTH * super::grid::MOST_BANDS;

const fn view_lines(instances: usize) -> usize {
    lines(instances * size_of::<Placed>())
        + lines(instances * size_of::<Aabb>())
        + lines(instances * size_of::<u64>())
        + lines(top_nodes(instances) * size_of::<WideNode>())
}

impl<'a> Cutter<'a> {
    /// What a [`super::view::View`] of so many instances needs.
    pub(crate) fn view(&mut self, instances: usize) -> ViewMemory<'a> {
        ViewMemory {
            placed: self.take(instances),
            bounds: self.take(instances),
            order: self.take(instances),
            nodes: self.take(top_nodes(instances)),
        }
    }
}

impl Workspace<'_> {
    /// True when the buffer is long enough for a sensor of so many rays to see the scene.
    pub fn fits(&self, scene: &Scene<'_>, rays: usize) -> bool {
        self.buffer.len() >= workspace_len(scene.instances().len(), rays)
    }

    pub(crate) fn cut(&mut self, scene: &Scene<'_>, rays: usize) -> Cutter<'_> {
        assert!(self.fits(scene, rays), "the workspace is smaller than the scene and the sensor need");
        Cutter(self.buffer)
    }
}

/// An owned [`Workspace`]: allocates when a scene or sensor outgrows it, and never else.
#[cfg(feature = "alloc")]
#[derive(Debug, Default, Clone)]
pub struct WorkspaceBuf {
    buffer: alloc::vec::Vec<CacheLine>,
    /// SIMD level and threads.
    pub execution: Execution,
}

#[cfg(feature = "alloc")]
impl WorkspaceBuf {
    /// Lends it to a sensor of so many rays that sees the scene; grows first, if it is too small.
    pub fn lend(&mut self, scene: &Scene<'_>, rays: usize) -> Workspace<'_> {
        let need = workspace_len(scene.instances().len(), rays);
        if self.buffer.len() < need {
            self.buffer.resize(need, CacheLine::zeroed());
        }
        Workspace { buffer: &mut self.buffer, execution: self.execution }
    }
}
