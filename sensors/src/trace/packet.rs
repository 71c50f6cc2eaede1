//! 64 rays that are traced together, and the bounds that let whole subtrees be skipped for all of them.

use crate::scene::Aabb;
use crate::simd::{LANES, Lanes};

/// Lanes over which minima and maxima are taken side by side.
const WIDTH: usize = 16;

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
        let mut widest = [f64::NEG_INFINITY; WIDTH];
        for first in (0..LANES).step_by(WIDTH) {
            for lane in 0..WIDTH {
                let t = self.t[first + lane];
                widest[lane] = if t > widest[lane] { t } else { widest[lane] };
            }
        }
        let mut half = WIDTH / 2;
        while half > 0 {
            for lane in 0..half {
                widest[lane] =
                    if widest[lane + half] > widest[lane] { widest[lane + half] } else { widest[lane] };
            }
            half /= 2;
        }
        widest[0]
    }
}

/// Intervals that hold the origin and direction of every lane that takes part.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PacketBounds {
    origin: [[f64; 2]; 3],
    /// [1/max, 1/min] of the direction where it does not change its sign, else none.
    inverse: [Option<[f64; 2]>; 3],
    t_min: f64,
}

impl PacketBounds {
    /// Bounds over the lanes of the packet that take part, given their rays in the frame of the tree.
    #[inline(always)]
    pub(crate) fn new(origin: &[Lanes<f64>; 3], direction: &[Lanes<f64>; 3], packet: &Packet) -> Self {
        let mut bounds = Self { origin: [[0.0; 2]; 3], inverse: [None; 3], t_min: packet.t_min };
        for axis in 0..3 {
            bounds.origin[axis] =
                if packet.shared_origin { [origin[axis][0]; 2] } else { interval(&origin[axis], &packet.t) };
            let [low, high] = interval(&direction[axis], &packet.t);
            if low > 0.0 || high < 0.0 {
                bounds.inverse[axis] = Some([1.0 / high, 1.0 / low]);
            }
        }
        bounds
    }

    /// A lower bound of t where any ray enters the box, or none if no ray can meet it before `t_max`.
    #[inline(always)]
    pub(crate) fn enter(&self, aabb: &Aabb, t_max: f64) -> Option<f64> {
        let (mut enter, mut exit) = (self.t_min, t_max);
        for axis in 0..3 {
            let [origin_low, origin_high] = self.origin[axis];
            let (low, high) = (f64::from(aabb.min[axis]), f64::from(aabb.max[axis]));
            if let Some([least, most]) = self.inverse[axis] {
                // least > 0: rays go up the axis; else they go down and the box's faces change places.
                let (to_near, to_far) = if least > 0.0 {
                    (low - origin_high, high - origin_low)
                } else {
                    (high - origin_low, low - origin_high)
                };
                let first = |distance: f64| {
                    let (a, b) = (distance * least, distance * most);
                    if a < b { (a, b) } else { (b, a) }
                };
                let near = first(to_near).0;
                let far = first(to_far).1;
                enter = if near > enter { near } else { enter };
                exit = if far < exit { far } else { exit };
            }
        }
        (enter <= exit).then_some(enter)
    }

    /// For each axis, whether the rays go up it (or mostly do).
    pub(crate) fn ascending(&self, axis: usize) -> bool {
        self.inverse[axis].is_none_or(|[least, _]| least > 0.0)
    }
}

#[inline(always)]
fn interval(values: &Lanes<f64>, t: &Lanes<f64>) -> [f64; 2] {
    // Independent lanes first: a chain of dependent compares would take longer than all of them.
    let mut low = [f64::INFINITY; WIDTH];
    let mut high = [f64::NEG_INFINITY; WIDTH];
    for first in (0..LANES).step_by(WIDTH) {
        for lane in 0..WIDTH {
            let value = values[first + lane];
            let active = t[first + lane] > f64::NEG_INFINITY;
            low[lane] = if active & (value < low[lane]) { value } else { low[lane] };
            high[lane] = if active & (value > high[lane]) { value } else { high[lane] };
        }
    }
    let mut half = WIDTH / 2;
    while half > 0 {
        for lane in 0..half {
            low[lane] = if low[lane + half] < low[lane] { low[lane + half] } else { low[lane] };
            high[lane] = if high[lane + half] > high[lane] { high[lane + half] } else { high[lane] };
        }
        half /= 2;
    }
    [low[0], high[0]]
}
