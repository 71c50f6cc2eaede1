//! Packets of 64 rays that are traced together, and bounds that allow whole subtrees to be skipped for all of them.

pub(crate) mod hits;
pub(crate) mod moving;
pub(crate) mod paths;
pub(crate) mod scratch;
pub(crate) mod specular;
pub(crate) mod visibility;
pub(crate) mod walk;

use crate::scene::tree::{NONE, WideNode};
use crate::simd::{LANES, Lanes, WIDTH, least};
use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x16, u32x16};
use glam::DVec3;

/// No instance was hit.
pub(crate) const MISS: u32 = u32::MAX;

/// The sides of surfaces that count as hits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Faces {
    /// Front faces only, as in a renderer with back-face culling. A camera inside its own housing sees out of it.
    Front,
    /// Front and back faces.
    Both,
}

/// 64 rays p(t) = origin + t·direction with t ≥ `t_min`, and the nearest hit found so far.
///
/// Coordinates are metres along the world's axes, relative to the origin of the frame (the sensor). A lane with `t` =
/// −∞ is inactive.
#[derive(Clone)]
pub(crate) struct Packet {
    pub(crate) origin: [Lanes<f64>; 3],
    pub(crate) direction: [Lanes<f64>; 3],
    /// True if all lanes have the origin of lane 0.
    pub(crate) shared_origin: bool,
    pub(crate) t_min: f64,
    /// Before the search, the farthest t that counts; afterwards, t of the hit, if there is one.
    pub(crate) t: Lanes<f64>,
    /// [`MISS`], or the hit: the first slot of its instance, or for triangles their own slot.
    pub(crate) hit: Lanes<u32>,
}

impl Packet {
    /// All lanes start at the frame's origin and are inactive.
    pub(crate) const fn new() -> Self {
        Self {
            origin: [[0.0; LANES]; 3],
            direction: [[0.0; LANES]; 3],
            shared_origin: true,
            t_min: 0.0,
            t: [f64::NEG_INFINITY; LANES],
            hit: [MISS; LANES],
        }
    }

    /// Returns true if any lane is active.
    #[inline(always)]
    pub(crate) fn is_active(&self) -> bool {
        let mut active = false;
        for lane in 0..LANES {
            active |= self.t[lane] > f64::NEG_INFINITY;
        }
        active
    }

    /// The greatest t that counts for any lane, rounded up.
    #[inline(always)]
    pub(crate) fn farthest(&self) -> f32 {
        let mut nearer = [0.0; LANES];
        for lane in 0..LANES {
            nearer[lane] = -(self.t[lane] as f32);
        }
        -least(nearer) * (1.0 + MARGIN as f32)
    }
}

/// Intervals that contain the origins and directions of all active lanes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PacketBounds {
    /// Least and greatest value per axis.
    origin: [[f32; 2]; 3],
    /// Least and greatest value of 1/direction; −∞ and ∞ where the direction changes its sign.
    inverse: [[f32; 2]; 3],
    /// For each axis, true if any ray has a positive direction.
    ascending: [bool; 3],
    t_min: f32,
}

/// The relative enlargement of the intervals: more than all rounding errors of a test together.
const MARGIN: f64 = 4e-7;

impl PacketBounds {
    /// Creates bounds over the active lanes of the packet, given their rays in the frame of the tree.
    #[inline(always)]
    pub(crate) fn new(origin: &[Lanes<f64>; 3], direction: &[Lanes<f64>; 3], packet: &Packet) -> Self {
        let (mut origins, mut directions) = ([[0.0; 2]; 3], [[0.0; 2]; 3]);
        for axis in 0..3 {
            origins[axis] =
                if packet.shared_origin { [origin[axis][0]; 2] } else { interval(&origin[axis], &packet.t) };
            directions[axis] = interval(&direction[axis], &packet.t);
        }
        Self::of_intervals(origins, directions, packet.t_min)
    }

    /// Creates bounds of all rays whose origin and direction are in the intervals.
    #[inline(always)]
    pub(crate) fn of_intervals(origin: [[f64; 2]; 3], direction: [[f64; 2]; 3], t_min: f64) -> Self {
        let mut bounds = Self {
            origin: [[0.0; 2]; 3],
            inverse: [[f32::NEG_INFINITY, f32::INFINITY]; 3],
            ascending: [true; 3],
            t_min: t_min as f32,
        };
        for axis in 0..3 {
            let [low, high] = origin[axis];
            bounds.origin[axis] = [(low - low.abs() * MARGIN) as f32, (high + high.abs() * MARGIN) as f32];
            let [low, high] = direction[axis];
            if low > 0.0 || high < 0.0 {
                let (least, most) = (1.0 / high, 1.0 / low);
                bounds.inverse[axis] =
                    [(least - least.abs() * MARGIN) as f32, (most + most.abs() * MARGIN) as f32];
            }
            bounds.ascending[axis] = high >= 0.0;
        }
        bounds
    }

    /// Creates bounds of rays from one point that end in a box at t = 1.
    #[inline(always)]
    pub(crate) fn from_point(from: DVec3, ends: &[[f32; 2]; 3]) -> Self {
        let (mut origin, mut direction) = ([[0.0; 2]; 3], [[0.0; 2]; 3]);
        for axis in 0..3 {
            let [low, high] = ends[axis];
            origin[axis] = [from[axis]; 2];
            direction[axis] = [f64::from(low) - from[axis], f64::from(high) - from[axis]];
        }
        Self::of_intervals(origin, direction, 0.0)
    }

    /// The children of a node that any ray may hit before `t_max`, as one bit each.
    #[inline(always)]
    pub(crate) fn enter<S: Simd>(&self, simd: S, node: &WideNode, t_max: f32) -> u64 {
        self.slabs(simd, node, t_max).1
    }

    /// The same, with the least t at which any ray may hit each child.
    #[inline(always)]
    pub(crate) fn enter_at<S: Simd>(
        &self,
        simd: S,
        node: &WideNode,
        t_max: f32,
        near: &mut [f32; WIDTH],
    ) -> u64 {
        let (enter, lanes) = self.slabs(simd, node, t_max);
        enter.store_array(near);
        lanes
    }

    #[inline(always)]
    fn slabs<S: Simd>(&self, simd: S, node: &WideNode, t_max: f32) -> (f32x16<S>, u64) {
        let mut enter = f32x16::splat(simd, self.t_min);
        let mut exit = f32x16::splat(simd, t_max);
        for axis in 0..3 {
            let [origin_low, origin_high] = self.origin[axis];
            let [least, most] = self.inverse[axis];
            let to_low = f32x16::load_array_ref(simd, &node.min[axis]) - origin_high;
            let to_high = f32x16::load_array_ref(simd, &node.max[axis]) - origin_low;
            // Rays with a negative direction hit the box's upper face first.
            let (to_near, to_far) = if self.ascending[axis] { (to_low, to_high) } else { (to_high, to_low) };
            let (a, b) = (to_near * least, to_near * most);
            let near = a.simd_lt(b).select(a, b);
            let (a, b) = (to_far * least, to_far * most);
            let far = a.simd_gt(b).select(a, b);
            // Slightly earlier and later, because of rounding. 0·∞, on a face with rays to both sides, is NaN and
            // bounds nothing.
            let (near, far) = (near - near.abs() * 1e-6, far + far.abs() * 1e-6);
            enter = near.simd_gt(enter).select(near, enter);
            exit = far.simd_lt(exit).select(far, exit);
        }
        let there = u32x16::load_array_ref(simd, &node.child).simd_ne(u32x16::splat(simd, NONE));
        (enter, (enter.simd_le(exit) & there).to_bitmask())
    }
}

/// The least and greatest value of the active lanes, rounded to single precision.
#[inline(always)]
fn interval(values: &Lanes<f64>, t: &Lanes<f64>) -> [f64; 2] {
    let mut up = [0.0; LANES];
    let mut down = [0.0; LANES];
    for lane in 0..LANES {
        let active = t[lane] > f64::NEG_INFINITY;
        let value = values[lane] as f32;
        up[lane] = if active { value } else { f32::INFINITY };
        down[lane] = if active { -value } else { f32::INFINITY };
    }
    [least(up), -least(down)].map(f64::from)
}
