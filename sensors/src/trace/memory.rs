//! The memory that a frame works in: one buffer of the caller's.

use super::error::SenseError;
use super::top::top_nodes;
use super::view::{Placed, ViewMemory};
use crate::execution::Execution;
use crate::memory::{CacheLine, Cutter, lines};
use crate::scene::Aabb;
use crate::scene::tree::WideNode;

/// What a sensor needs to take a frame, lent by the caller.
#[derive(Debug)]
pub struct Workspace<'a> {
    /// As many cache lines as the sensor's [`workspace_len`](crate::Sensor::workspace_len) says, or more.
    pub buffer: &'a mut [CacheLine],
    /// SIMD level and threads.
    pub execution: Execution,
}

/// Cache lines of so many views of so many instances, about 400 bytes an instance.
pub(crate) const fn view_lines(instances: usize, views: usize) -> usize {
    lines(views * instances * size_of::<Placed>())
        + lines(views * instances * size_of::<Aabb>())
        + lines(views * instances * size_of::<u64>())
        + lines(views * top_nodes(instances) * size_of::<WideNode>())
}

impl<'a> Cutter<'a> {
    /// What so many [`super::view::View`]s of so many instances need.
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
    /// The buffer, if it has so many cache lines.
    pub(crate) fn cut(&mut self, need: usize) -> Result<Cutter<'_>, SenseError> {
        let value = self.buffer.len();
        if value < need { Err(SenseError::Workspace { value, need }) } else { Ok(Cutter(self.buffer)) }
    }
}

/// An owned [`Workspace`]: allocates when a frame needs more than any before, and never else.
#[cfg(feature = "alloc")]
#[derive(Debug, Default, Clone)]
pub struct WorkspaceBuf {
    buffer: alloc::vec::Vec<CacheLine>,
    /// SIMD level and threads.
    pub execution: Execution,
}

#[cfg(feature = "alloc")]
impl WorkspaceBuf {
    /// Lends `len` cache lines or more; grows first, if it is too small.
    pub fn lend(&mut self, len: usize) -> Workspace<'_> {
        if self.buffer.len() < len {
            self.buffer.resize(len, CacheLine::ZERO);
        }
        Workspace { buffer: &mut self.buffer, execution: self.execution }
    }
}
