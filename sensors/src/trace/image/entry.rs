//! The parts of the trees that are still to be visited.

use super::single;
use crate::scene::tree;
use crate::simd::WIDTH;
use crate::trace::placed::view;

/// An upper bound on the waiting entries for the deepest trees: fifteen siblings per level, and, where the rays of a
/// node are first tested one by one, all its children for each ray.
pub(super) const STACK: usize =
    15 * (tree::MAX_DEPTH + view::MAX_DEPTH) + single::MOST_RAYS as usize * WIDTH + 2;

/// A subtree to visit.
#[derive(Clone, Copy)]
pub(super) struct Entry {
    /// The child's index; see [`WideNode::child`](tree::WideNode::child).
    pub(super) child: u32,
    /// The instance whose tree it belongs to, or the tree over the instances.
    pub(super) placed: u32,
    /// An upper bound on 1/t.
    pub(super) nearest: f32,
    /// Among siblings, greater values are visited sooner.
    pub(super) order: f32,
    /// The first and last column and row of the rays that may hit it.
    pub(super) columns: [u16; 2],
    pub(super) rows: [u16; 2],
}

impl Entry {
    #[inline(always)]
    pub(super) fn is_of_one_ray(&self) -> bool {
        self.columns[0] == self.columns[1] && self.rows[0] == self.rows[1]
    }

    /// Returns true if its rays are better tested one by one.
    #[inline(always)]
    pub(super) fn is_of_few_rays(&self) -> bool {
        let across = u32::from(self.columns[1] - self.columns[0] + 1);
        across * u32::from(self.rows[1] - self.rows[0] + 1) <= single::MOST_RAYS
    }

    /// Column and row.
    #[inline(always)]
    pub(super) fn first_ray(&self) -> [u16; 2] {
        [self.columns[0], self.rows[0]]
    }
}

/// Inserts an entry among those from `first` on, with the first to visit on top, and returns the number of entries.
#[inline(always)]
pub(super) fn insert(stack: &mut [Entry; STACK], first: usize, waiting: usize, entry: Entry) -> usize {
    // There are few, so a linear search is enough.
    let mut at = waiting;
    while at > first && stack[at - 1].order > entry.order {
        stack[at] = stack[at - 1];
        at -= 1;
    }
    stack[at] = entry;
    waiting + 1
}
