//! The instances that may be between a lamp and a box around some tiles.
//!
//! Neighbouring tiles are shadowed by the same few instances. For each lamp, the instances are therefore collected for
//! a box that is larger than the current tile, and cached. Tiles inside this box need no traversal of the tree.

use crate::scene::tree::{LEAF, NONE, WideNode};
use crate::simd::WIDTH;
use crate::trace::packet::PacketBounds;
use crate::trace::placed::view::{MAX_DEPTH, View};
use fearless_simd::Simd;
use glam::DVec3;

/// Enlargement of the box on each side, as a multiple of the tile's extent along that axis. A larger box serves more
/// tiles, but has more instances between it and the lamp.
const REACH: f32 = 4.0;
/// Additional enlargement along every axis, as a multiple of the tile's greatest extent. The points of a wall are
/// nearly in one plane, and perpendicular to it the box would otherwise be no thicker than their rounding errors.
const THICKNESS: f32 = 0.01;

/// The instances between a lamp and a box, if there are at most sixteen.
pub(super) struct Occluders {
    /// Bounds along each axis, relative to the sensor. Initially empty.
    bounds: [[f32; 2]; 3],
    /// The boxes of the instances; children are indices of placed instances.
    node: WideNode,
    /// True if there are more than sixteen instances, which are then not cached.
    is_crowded: bool,
}

impl Occluders {
    pub(super) const fn new() -> Self {
        let node = WideNode { min: [[0.0; WIDTH]; 3], max: [[0.0; WIDTH]; 3], child: [NONE; WIDTH] };
        Self { bounds: [[f32::INFINITY, f32::NEG_INFINITY]; 3], node, is_crowded: false }
    }

    /// All instances that may cast a shadow.
    pub(super) fn node(&self) -> &WideNode {
        &self.node
    }

    /// Collects the instances for a new box if `bounds`, those of a tile, are not inside the current one. Returns true
    /// if the instances of [`Occluders::node`] are all that may be between the lamp and the tile.
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
