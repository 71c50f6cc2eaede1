//! The instances that may stand between a lamp and a box around some tiles.
//!
//! Neighbouring tiles are shadowed by the same few instances. So for each lamp the instances are looked for once for a box
//! that is larger than the tile at hand, and remembered; tiles that lie in this box need no walk through the tree.

use crate::scene::tree::{LEAF, NONE, WideNode};
use crate::simd::WIDTH;
use crate::trace::packet::PacketBounds;
use crate::trace::view::{MAX_DEPTH, View};
use fearless_simd::Simd;
use glam::DVec3;

/// How much larger the box is than the tile that it is made for: to each side, so many times the tile's extent along that
/// axis. A larger box serves more tiles, and has more instances between it and the lamp.
const REACH: f32 = 4.0;
/// Besides, so many times the tile's greatest extent along every axis. The points of a wall are all but in one plane, and
/// across it the box would otherwise be no thicker than their rounding errors.
const THICKNESS: f32 = 0.01;

/// The instances between a lamp and a box, where there are sixteen at the most.
pub(super) struct Occluders {
    /// Least and most along each axis, around the sensor. Empty at first.
    bounds: [[f32; 2]; 3],
    /// Their boxes; children are indices of placed instances.
    node: WideNode,
    /// There are more than sixteen: nothing is remembered.
    is_crowded: bool,
}

impl Occluders {
    pub(super) const fn new() -> Self {
        let node = WideNode { min: [[0.0; WIDTH]; 3], max: [[0.0; WIDTH]; 3], child: [NONE; WIDTH] };
        Self { bounds: [[f32::INFINITY, f32::NEG_INFINITY]; 3], node, is_crowded: false }
    }

    /// All that may stand in the way.
    pub(super) fn node(&self) -> &WideNode {
        &self.node
    }

    /// Makes a new box if a tile within `bounds` lies outside of the old one. True if the instances of
    /// [`Occluders::node`] are then all that may stand between the lamp and the tile.
    #[inline(always)]
    pub(super) fn cover<S: Simd>(
        &mut self,
        simd: S,
        view: &View<'_>,
        lamp: DVec3,
        bounds: &[[f32; 2]; 3],
    ) -> bool {
        let mut inside = true;
        for axis in 0..3 {
            let ([low, high], [own_low, own_high]) = (bounds[axis], self.bounds[axis]);
            inside &= own_low <= low && high <= own_high;
        }
        if !inside {
            self.gather(simd, view, lamp, bounds);
        }
        !self.is_crowded
    }

    #[inline(never)]
    fn gather<S: Simd>(&mut self, simd: S, view: &View<'_>, lamp: DVec3, bounds: &[[f32; 2]; 3]) {
        let mut extent = 0.0_f32;
        for [low, high] in bounds {
            extent = extent.max(high - low);
        }
        for (own, [low, high]) in self.bounds.iter_mut().zip(bounds) {
            let reach = (high - low) * REACH + extent * THICKNESS;
            *own = [low - reach, high + reach];
        }
        simd.vectorize(
            #[inline(always)]
            || {
                let rays = PacketBounds::from_point(lamp, &self.bounds);
                self.collect(simd, view, &rays);
            },
        );
    }

    #[inline(always)]
    fn collect<S: Simd>(&mut self, simd: S, view: &View<'_>, rays: &PacketBounds) {
        self.node.child = [NONE; WIDTH];
        self.is_crowded = false;
        let mut count = 0;
        let mut stack = [0_u32; (WIDTH - 1) * MAX_DEPTH + 2];
        let mut waiting = 1;
        while waiting > 0 {
            waiting -= 1;
            let node = &view.nodes[stack[waiting] as usize];
            let mut lanes = rays.enter(simd, node, 1.0);
            while lanes != 0 {
                let lane = lanes.trailing_zeros() as usize & (WIDTH - 1);
                lanes &= lanes - 1;
                let child = node.child[lane];
                if child & LEAF == 0 {
                    stack[waiting] = child;
                    waiting += 1;
                    continue;
                }
                if !view.placed[(child & !LEAF) as usize].casts_shadows() {
                    continue;
                }
                if count == WIDTH {
                    self.is_crowded = true;
                    return;
                }
                for axis in 0..3 {
                    self.node.min[axis][count] = node.min[axis][lane];
                    self.node.max[axis][count] = node.max[axis][lane];
                }
                self.node.child[count] = child & !LEAF;
                count += 1;
            }
        }
    }
}
