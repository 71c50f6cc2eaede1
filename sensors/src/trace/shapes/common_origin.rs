//! Parts of the kernels of [`Outside`](super::outside::Outside): rays that share an origin outside a solid.

/// If the distance of the sensor from a surface is less than this fraction of the solid's size, it has too few accurate
/// digits.
const BESIDE: f64 = 1e-6;

/// The power of a point with respect to a circle or a ball: distance² − radius². `None` if the point is so close to the
/// surface that the difference has too few accurate digits.
pub(super) fn power_of_point(distance: f64, radius: f64) -> Option<f64> {
    let power = (distance - radius) * (distance + radius);
    (power.abs() > BESIDE * radius * radius).then_some(power)
}

/// The slab |x| ≤ `half` of one axis, which gives 1/t at which rays enter and leave it.
#[derive(Clone, Copy)]
pub(super) struct Slab {
    /// A factor for the direction, and a summand, which is ∞ for rays that start inside.
    enter: [f64; 2],
    /// The same factor for leaving, for the two signs of the direction.
    leave: [f64; 2],
}

impl Slab {
    /// `None` for an origin that is almost on one of the two faces.
    pub(super) fn new(origin: f64, half: f64) -> Option<Self> {
        let [low, high] = [-half - origin, half - origin];
        if low.abs().min(high.abs()) <= BESIDE * half {
            return None;
        }
        let (per_low, per_high) = (1.0 / low, 1.0 / high);
        Some(if low > 0.0 {
            Self { enter: [per_low, 0.0], leave: [per_high; 2] }
        } else if high < 0.0 {
            Self { enter: [per_high, 0.0], leave: [per_low; 2] }
        } else {
            Self { enter: [0.0, f64::INFINITY], leave: [per_low, per_high] }
        })
    }

    /// Returns true if the common origin is between the faces.
    pub(super) fn is_around(&self) -> bool {
        self.enter[1] > 0.0
    }

    #[inline(always)]
    pub(super) fn enter(&self, direction: f64) -> f64 {
        direction * self.enter[0] + self.enter[1]
    }

    #[inline(always)]
    pub(super) fn leave(&self, direction: f64) -> f64 {
        greater(direction * self.leave[0], direction * self.leave[1])
    }
}

/// 1/t at which a ray enters, or 0 if it leaves before and so misses.
#[inline(always)]
pub(super) fn first(enter: f64, leave: f64) -> f64 {
    if enter >= leave { enter } else { 0.0 }
}

#[inline(always)]
pub(super) fn lesser(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

#[inline(always)]
pub(super) fn greater(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// Replaces `rows` by the product `by` · `rows` of two matrices that are given by their rows.
pub(super) fn turn(rows: &mut [[f64; 3]; 3], by: [[f64; 3]; 3]) {
    let [x, y, z] = *rows;
    for (row, [a, b, c]) in rows.iter_mut().zip(by) {
        for axis in 0..3 {
            row[axis] = (a * x[axis] + b * y[axis]) + c * z[axis];
        }
    }
}
