//! The working memory of a frame: one buffer that the caller provides.

use crate::execution::Execution;
use crate::memory::{CacheLine, Cutter, lines};
use crate::scene::Aabb;
use crate::scene::tree::WideNode;
use crate::trace::error::SenseError;
use crate::trace::placed::top::top_nodes;
use crate::trace::placed::view::{Placed, ViewMemory};

/// The working memory and the execution settings of a frame, lent by the caller.
#[derive(Debug)]
pub struct Workspace<'a> {
    /// At least as many cache lines as the sensor's [`workspace_len`](crate::Sensor::workspace_len) returns.
    pub buffer: &'a mut [CacheLine],
    /// The SIMD level and the threads.
    pub execution: Execution,
}

/// The number of cache lines for `views` views of `instances` instances, about 400 bytes per instance.
pub(crate) const fn view_lines(instances: usize, views: usize) -> usize {
    lines(views * instances * size_of::<Placed>())
        + lines(views * instances * size_of::<Aabb>())
        + lines(views * instances * size_of::<u64>())
        + lines(views * top_nodes(instances) * size_of::<WideNode>())
}

impl<'a> Cutter<'a> {
    /// The memory for `views` [`crate::trace::placed::view::View`]s of `instances` instances.
    pub(crate) fn views(&mut self, instances: usize, views: usize) -> ViewMemory<'a> {
        ViewMemory {
            placed: self.take(views * instances),
            bounds: self.take(views * instances),
            order: self.take(views * instances),
            nodes: self.take(views * top_nodes(instances)),
        }
    }
}

impl Workspace<'_> {
    /// The buffer, if it has at least `need` cache lines.
    pub(crate) fn cut(&mut self, need: usize) -> Result<Cutter<'_>, SenseError> {
        let value = self.buffer.len();
        if value < need { Err(SenseError::Workspace { value, need }) } else { Ok(Cutter(self.buffer)) }
    }
}

/// An owned [`Workspace`]. It allocates only if a frame needs more memory than all frames before.
#[cfg(feature = "alloc")]
#[derive(Debug, Default, Clone)]
pub struct WorkspaceBuf {
    buffer: alloc::vec::Vec<CacheLine>,
    /// The SIMD level and the threads.
    pub execution: Execution,
}

#[cfg(feature = "alloc")]
impl WorkspaceBuf {
    /// Lends at least `len` cache lines, growing the buffer first if it is too small.
    pub fn lend(&mut self, len: usize) -> Workspace<'_> {
        if self.buffer.len() < len {
            self.buffer.resize(len, CacheLine::ZERO);
        }
        Workspace { buffer: &mut self.buffer, execution: self.execution }
    }
}
