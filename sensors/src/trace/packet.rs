//! 64 rays that are traced together, and the bounds that let whole subtrees be skipped for all of them.

use crate::scene::Aabb;
use crate::simd::{LANES, Lanes};

/// No instance was hit.
pub(crate) const MISS: u32 = u32::MAX;

/// Which side of a surface counts as a hit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Faces {
    /// The outside only: what a renderer with back-face culling shows. A camera inside its own housing sees out.
    Front,
    /// Both sides.
    Both,
}

/// 64 rays p(t) = origin + t·direction with t ≥ `t_min`, and the nearest hit found so far.
///
/// Coordinates are metres along the world's axes, relative to the origin of the frame (the sensor). A lane with
/// `t` = −∞ takes no part.
#[derive(Clone)]
pub(crate) struct Packet {
    pub(crate) origin: [Lanes<f64>; 3],
    pub(crate) direction: [Lanes<f64>; 3],
    /// True when all lanes have the origin of lane 0.
    pub(crate) shared_origin: bool,
    pub(crate) t_min: f64,
    /// Before: the farthest t that counts. After: that of the hit, if there is one.
    pub(crate) t: Lanes<f64>,
    /// Index into the frame's placed instances, or [`MISS`].
    pub(crate) placed: Lanes<u32>,
    /// Triangle of the scene for a mesh.
    pub(crate) triangle: Lanes<u32>,
}

impl Packet {
    /// All lanes start at the frame's origin and take no part yet.
    pub(crate) const fn new() -> Self {
        Self {
            origin: [[0.0; LANES]; 3],
            direction: [[0.0; LANES]; 3],
            shared_origin: true,
            t_min: 0.0,
            t: [f64::NEG_INFINITY; LANES],
            placed: [MISS; LANES],
            triangle: [0; LANES],
        }
    }

    #[inline(always)]
    pub(crate) fn direction_of(&self, lane: usize) -> glam::DVec3 {
        glam::DVec3::new(self.direction[0][lane], self.direction[1][lane], self.direction[2][lane])
    }

    /// The largest t of any lane: nothing beyond it matters to the packet.
    #[inline(always)]
    pub(crate) fn farthest(&self) -> f64 {
        let mut nearness = [0.0; LANES];
        for lane in 0..LANES {
            nearness[lane] = -self.t[lane];
        }
        -least(nearness)
    }
}

/// Intervals that hold the origin and direction of every lane that takes part.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PacketBounds {
    /// Least and most.
    origin: [[f64; 2]; 3],
    /// Least and most of 1/direction; −∞ and ∞ where the direction changes its sign.
    inverse: [[f64; 2]; 3],
    /// For each axis, whether some ray goes up it.
    ascending: [bool; 3],
    t_min: f64,
}

impl PacketBounds {
    /// Bounds over the lanes of the packet that take part, given their rays in the frame of the tree.
    #[inline(always)]
    pub(crate) fn new(origin: &[Lanes<f64>; 3], direction: &[Lanes<f64>; 3], packet: &Packet) -> Self {
        let mut bounds = Self {
            origin: [[0.0; 2]; 3],
            inverse: [[f64::NEG_INFINITY, f64::INFINITY]; 3],
            ascending: [true; 3],
            t_min: packet.t_min,
        };
        for axis in 0..3 {
            bounds.origin[axis] =
                if packet.shared_origin { [origin[axis][0]; 2] } else { interval(&origin[axis], &packet.t) };
            let [low, high] = interval(&direction[axis], &packet.t);
            if low > 0.0 || high < 0.0 {
                bounds.inverse[axis] = [1.0 / high, 1.0 / low];
            }
            bounds.ascending[axis] = high >= 0.0;
        }
        bounds
    }

    /// A lower bound of t where any ray enters the box, or none if no ray can meet it before `t_max`.
    #[inline(always)]
    pub(crate) fn enter(&self, aabb: &Aabb, t_max: f64) -> Option<f64> {
        let (mut enter, mut exit) = (self.t_min, t_max);
        for axis in 0..3 {
            let [origin_low, origin_high] = self.origin[axis];
            let [least, most] = self.inverse[axis];
            let to_low = f64::from(aabb.min[axis]) - origin_high;
            let to_high = f64::from(aabb.max[axis]) - origin_low;
            // Rays that go down the axis meet the box's upper face first.
            let (to_near, to_far) = if self.ascending[axis] { (to_low, to_high) } else { (to_high, to_low) };
            let (a, b) = (to_near * least, to_near * most);
            let near = if a < b { a } else { b };
            let (a, b) = (to_far * least, to_far * most);
            let far = if a > b { a } else { b };
            // 0·∞, on a face with rays to both sides, is NaN and bounds nothing.
            enter = if near > enter { near } else { enter };
            exit = if far < exit { far } else { exit };
        }
        (enter <= exit).then_some(enter)
    }

    /// Whether some ray goes up the axis.
    #[inline(always)]
    pub(crate) fn ascending(&self, axis: usize) -> bool {
        self.ascending[axis]
    }
}

#[inline(always)]
fn interval(values: &Lanes<f64>, t: &Lanes<f64>) -> [f64; 2] {
    let mut up = [0.0; LANES];
    let mut down = [0.0; LANES];
    for lane in 0..LANES {
        let active = t[lane] > f64::NEG_INFINITY;
        up[lane] = if active { values[lane] } else { f64::INFINITY };
        down[lane] = if active { -values[lane] } else { f64::INFINITY };
    }
    [least(up), -least(down)]
}

/// The least of all lanes, by halves: a chain of dependent compares would take longer.
#[inline(always)]
fn least(mut values: Lanes<f64>) -> f64 {
    let mut half = LANES / 2;
    while half > 0 {
        for lane in 0..half {
            let other = values[lane + half];
            values[lane] = if other < values[lane] { other } else { values[lane] };
        }
        half /= 2;
    }
    values[0]
}
