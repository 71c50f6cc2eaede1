//! Visibility of hit points from another position.

use crate::simd::{LANES, WIDTH};
use crate::trace::packet::hits::{Search, activate, hit_lanes, intersect_instance};
use crate::trace::packet::walk::{stack_len, walk};
use crate::trace::packet::{Faces, Packet, PacketBounds};
use crate::trace::placed::view::{MAX_DEPTH, View};
use crate::trace::shapes::LocalRays;
use fearless_simd::{Simd, f32x16};
use glam::DVec3;

/// A surface that is nearer than a point by at most this fraction of its distance does not hide it: points are computed
/// from depths in single precision, and a triangulating sensor does not resolve surfaces that are so close to each
/// other.
const TOUCHING: f64 = 1e-3;

/// Rays from one position to up to sixty-four points.
pub(crate) struct VisibilityTest {
    from: DVec3,
    packet: Packet,
    local: LocalRays,
}

impl VisibilityTest {
    /// Tests visibility from the sensor itself.
    pub(crate) const NEW: Self = Self { from: DVec3::ZERO, packet: Packet::new(), local: LocalRays::new() };

    /// Sets the position, relative to the sensor in the axes of the world.
    pub(crate) fn set(&mut self, from: DVec3) {
        self.from = from;
        for axis in 0..3 {
            self.packet.origin[axis] = [from[axis]; LANES];
        }
    }

    /// Aims the sixteen lanes from 16·`part` on at points in the same axes.
    #[inline(always)]
    pub(crate) fn aim<S: Simd>(&mut self, part: usize, points: [f32x16<S>; 3]) {
        for axis in 0..3 {
            let points: [f32; WIDTH] = points[axis].into();
            let direction = &mut self.packet.direction[axis].as_chunks_mut::<WIDTH>().0[part];
            for lane in 0..WIDTH {
                direction[lane] = f64::from(points[lane]) - self.from[axis];
            }
        }
    }

    /// Returns the lanes whose points are hidden. All lanes must have been aimed. Compiled once per level.
    #[inline(never)]
    pub(crate) fn hidden<S: Simd>(&mut self, simd: S, view: &View<'_>, faces: Faces, lanes: u64) -> u64 {
        let Self { packet, local, .. } = self;
        simd.vectorize(
            #[inline(always)]
            || {
                activate(packet, lanes, 1.0 - TOUCHING);
                let bounds = PacketBounds::new(&packet.origin, &packet.direction, packet);
                let mut hidden = 0;
                walk::<S, _, { stack_len(MAX_DEPTH) }>(
                    simd,
                    #[inline(always)]
                    |node| &view.nodes[node as usize],
                    &bounds,
                    1.0,
                    #[inline(always)]
                    |index| {
                        activate(packet, lanes & !hidden, 1.0 - TOUCHING);
                        intersect_instance(simd, view, index, (packet, local), (faces, Search::Any(1.0)));
                        hidden |= hit_lanes(packet);
                        hidden != lanes
                    },
                );
                hidden
            },
        )
    }
}
