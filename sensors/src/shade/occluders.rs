//! What may stand between a lamp and the neighbourhood of a tile, remembered from tile to tile.

use crate::scene::tree::{LEAF, NONE, WideNode};
use crate::simd::WIDTH;
use crate::trace::packet::PacketBounds;
use crate::trace::view::{MAX_DEPTH, View};
use fearless_simd::Simd;
use glam::DVec3;

/// The neighbourhood reaches so many times the tile's own extent beyond it: far enough for the next few tiles, and not so
/// far that much lies between it and the lamp.
const REACH: f32 = 4.0;
/// And so much of its greatest extent along every axis, as points of one wall differ in their last bits.
const THICKNESS: f32 = 0.01;

/// The instances between a lamp and a box, if there are no more than sixteen.
pub(super) struct Occluders {
    /// Least and most along each axis, around the sensor. Empty at first.
    bounds: [[f32; 2]; 3],
    /// Their boxes; children are indices of placed instances.
    node: WideNode,
    /// There are more.
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

    /// Sees to it that what is remembered is all that may stand between the lamp and a tile within `bounds`; whether it
    /// is.
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
