//! What of the trees is still to be visited.

use super::single;
use crate::scene::tree;
use crate::simd::WIDTH;
use crate::trace::placed::view;

/// More than the deepest trees leave waiting: fifteen siblings a level, and where a node is asked ray by ray for the
/// first time, all its children for each ray.
pub(super) const STACK: usize =
    15 * (tree::MAX_DEPTH + view::MAX_DEPTH) + single::MOST_RAYS as usize * WIDTH + 2;

/// A subtree to visit.
#[derive(Clone, Copy)]
pub(super) struct Entry {
    /// As in [`WideNode::child`](tree::WideNode::child).
    pub(super) child: u32,
    /// Which instance's tree, or that over the instances.
    pub(super) placed: u32,
    /// Bound of 1/t from above.
    pub(super) nearest: f32,
    /// The greater, the sooner it is visited, among its siblings.
    pub(super) order: f32,
    /// First and last column and row of the rays that may pass.
    pub(super) columns: [u16; 2],
    pub(super) rows: [u16; 2],
}

impl Entry {
    #[inline(always)]
    pub(super) fn is_of_one_ray(&self) -> bool {
        self.columns[0] == self.columns[1] && self.rows[0] == self.rows[1]
    }

    /// Whether its rays are better asked one by one.
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

/// Puts an entry among those from `first` on, the first to visit on top; how many wait then.
#[inline(always)]
pub(super) fn insert(stack: &mut [Entry; STACK], first: usize, waiting: usize, entry: Entry) -> usize {
    // There are few.
    let mut at = waiting;
    while at > first && stack[at - 1].order > entry.order {
        stack[at] = stack[at - 1];
        at -= 1;
    }
    stack[at] = entry;
    waiting + 1
}
