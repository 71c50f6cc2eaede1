//! A ray that is prepared for the tests of boxes and triangles.

/// The smallest direction component that is used as a divisor, if the largest is in [1, 2). Smaller components, 0 in
/// particular, are replaced by it, so that no reciprocal overflows and 0·∞ does not occur in a slab test.
pub(super) const TINY: f32 = f32::from_bits((127 - 100) << 23); // 2⁻¹⁰⁰

/// The fraction of its own size by which an origin is moved outwards for the slab tests: two units in the last place.
pub(super) const ORIGIN_PAD: f32 = f32::from_bits((127 - 22) << 23); // 2⁻²²

/// The same for an origin at 0: with a reciprocal of 2¹⁰⁰, it still widens a slab by 2⁴⁰ m.
pub(super) const ORIGIN_PAD_AT_ZERO: f32 = f32::from_bits((127 - 60) << 23); // 2⁻⁶⁰

/// A ray in the frame of a [`View`](crate::trace::placed::view::View).
#[derive(Debug, Clone, Copy)]
pub(crate) struct FrameRay {
    pub(crate) origin: [f32; 3],
    pub(crate) direction: [f32; 3],
    /// The least and greatest t that count.
    pub(crate) range: [f32; 2],
}

/// A ray p(t) = origin + t·direction in the frame of a mesh, with the data that the tests of boxes and triangles need.
///
/// The direction is scaled by a power of two so that its largest component is in [1, 2); t is in units of the length of
/// the scaled direction.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ray {
    /// The origin in metres, rounded …
    pub(crate) origin: [f32; 3],
    /// … and the remainder after rounding, which matters far from the origin of the mesh.
    pub(super) origin_low: [f32; 3],
    /// The origin and the scaled direction, in double precision.
    pub(super) exact: [[f64; 3]; 2],
    /// The reciprocals of the direction's components; those of 0 are replaced by ±2¹⁰⁰.
    pub(super) inverse: [f32; 3],
    /// The origin for the near planes of boxes, moved so that rounding never makes the ray miss a box.
    pub(super) near_origin: [f32; 3],
    /// The origin for the far planes.
    pub(super) far_origin: [f32; 3],
    /// The rows of a node (min x, y, z, max x, y, z) that hold the planes which the ray hits first.
    pub(super) near_rows: [u8; 3],
    /// The mesh's axes that are the axes x, y, z of the space in which the ray runs along +z or −z.
    pub(super) axes: [u8; 3],
    /// x and y of the direction per z, and 1/z.
    pub(super) shear: [f32; 3],
    /// In single precision, hits from this t on need a second test.
    pub(super) least: f32,
    /// The absolute part of the error of t in single precision.
    pub(super) doubt: f32,
    /// The least and greatest t that count.
    pub(crate) range: [f32; 2],
    /// The factor from t to units of the direction that was given.
    pub(crate) unit: f32,
}

impl Ray {
    /// Creates a ray from `origin` along `direction` (finite, not 0), with t within `range` in units of the direction's
    /// length. `doubt` is the absolute part of the error of t in single precision, a fraction of the size of the mesh.
    #[inline(always)]
    pub(crate) fn new(origin: [f64; 3], direction: [f64; 3], range: [f32; 2], doubt: f32) -> Self {
        let exact = [origin, direction];
        let (origin, direction) = (origin.map(|x| x as f32), direction.map(|x| x as f32));
        let origin_low = [0, 1, 2].map(|axis| low_part(exact[0][axis]));
        let size = [direction[0].abs(), direction[1].abs(), direction[2].abs()];
        let (mut z, mut largest) = if size[0] > size[1] { (0, size[0]) } else { (1, size[1]) };
        if size[2] >= largest {
            (z, largest) = (2, size[2]);
        }
        // The power of two from the exponent bits. For numbers outside its range (subnormal or huge), the nearest power
        // is close enough.
        let exponent = (largest.to_bits() >> 23).clamp(1, 253);
        let scale = f32::from_bits((254 - exponent) << 23);
        let direction = [direction[0] * scale, direction[1] * scale, direction[2] * scale];
        let mut inverse = [0.0; 3];
        let mut near_origin = [0.0; 3];
        let mut far_origin = [0.0; 3];
        let mut near_rows = [0; 3];
        for axis in 0..3 {
            let d = direction[axis];
            let safe = if d.abs() < TINY { TINY.copysign(d) } else { d };
            inverse[axis] = 1.0 / safe;
            let pad = (origin[axis].abs() * ORIGIN_PAD + ORIGIN_PAD_AT_ZERO).copysign(d);
            near_origin[axis] = origin[axis] + pad;
            far_origin[axis] = origin[axis] - pad;
            near_rows[axis] = axis as u8 + if d.is_sign_negative() { 3 } else { 0 };
        }
        // The axes x, y, z stay right-handed if the ray runs along +z; along −z, x and y are swapped.
        let (x, y) = ([1, 2, 0][z], [2, 0, 1][z]);
        let (x, y) = if direction[z] < 0.0 { (y, x) } else { (x, y) };
        let shear = [direction[x] / direction[z], direction[y] / direction[z], inverse[z]];
        Self {
            origin,
            origin_low,
            exact: [exact[0], exact[1].map(|x| x * f64::from(scale))],
            inverse,
            near_origin,
            far_origin,
            near_rows,
            axes: [x as u8, y as u8, z as u8],
            shear,
            least: range[0] / scale - doubt,
            doubt,
            range: [range[0] / scale, range[1] / scale],
            unit: scale,
        }
    }
}

/// The remainder of a number after rounding to single precision.
#[inline(always)]
pub(super) fn low_part(x: f64) -> f32 {
    (x - f64::from(x as f32)) as f32
}

/// The nearest hit so far.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Nearest {
    /// t of the hit, in units of the ray's scaled direction; +∞ without a hit.
    pub(crate) t: f64,
    /// Block × 16 + lane; [`NONE`](crate::scene::tree::NONE) without a hit.
    pub(crate) slot: u32,
    /// Boxes and triangles that begin beyond this t cannot be nearer.
    pub(super) limit: f32,
}

impl Nearest {
    /// No hit yet.
    #[inline(always)]
    pub(crate) fn none(ray: &Ray) -> Self {
        Self { t: f64::INFINITY, slot: crate::scene::tree::NONE, limit: ray.range[1] }
    }

    /// Stores a hit if it is nearer. Of two at the same distance, the lower slot counts, so that the order in which
    /// they are found does not matter.
    #[inline(always)]
    pub(super) fn offer(&mut self, ray: &Ray, t: f64, slot: u32) {
        let inside = t >= f64::from(ray.range[0]) && t <= f64::from(ray.range[1]);
        if inside && (t < self.t || (t == self.t && slot < self.slot)) {
            self.t = t;
            self.slot = slot;
            self.limit = t as f32;
        }
    }
}
