//! A ray made ready for boxes and triangles.

/// The smallest direction component that is divided by, where the largest lies in [1, 2); smaller ones, and 0
/// above all, count as this one, so that no reciprocal overflows and no 0·∞ comes up in a slab test.
pub(super) const TINY: f32 = f32::from_bits((127 - 100) << 23); // 2⁻¹⁰⁰

/// How much of its own size an origin is moved outwards for the slab tests: two units in the last place.
pub(super) const ORIGIN_PAD: f32 = f32::from_bits((127 - 22) << 23); // 2⁻²²

/// The same for an origin at 0: with a reciprocal of 2¹⁰⁰ it still opens a slab for 2⁴⁰ m.
pub(super) const ORIGIN_PAD_AT_ZERO: f32 = f32::from_bits((127 - 60) << 23); // 2⁻⁶⁰

/// A ray in the frame of a [`View`](crate::trace::placed::view::View).
#[derive(Debug, Clone, Copy)]
pub(crate) struct FrameRay {
    pub(crate) origin: [f32; 3],
    pub(crate) direction: [f32; 3],
    /// Least and greatest t that count.
    pub(crate) range: [f32; 2],
}

/// A ray p(t) = origin + t·direction of one mesh, with what the tests of boxes and triangles need.
///
/// The direction is scaled by a power of two such that its largest component lies in [1, 2); t here is in units
/// of the scaled direction's length.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ray {
    /// Where the ray starts, metres, rounded …
    pub(crate) origin: [f32; 3],
    /// … and what rounding left: of use far from the origin of the mesh.
    pub(super) origin_low: [f32; 3],
    /// Where it starts, and its scaled direction, as they are.
    pub(super) exact: [[f64; 3]; 2],
    /// Reciprocals of the direction's components, those of 0 replaced by ±2¹⁰⁰.
    pub(super) inverse: [f32; 3],
    /// Origin for the near planes of boxes, moved so that rounding never lets a box be missed.
    pub(super) near_origin: [f32; 3],
    /// Origin for the far planes.
    pub(super) far_origin: [f32; 3],
    /// Rows of a node (min x, y, z, max x, y, z) that hold the planes which the ray meets first.
    pub(super) near_rows: [u8; 3],
    /// The axes x, y, z of the space in which the ray runs along +z or −z, as those of the mesh.
    pub(super) axes: [u8; 3],
    /// x and y of the direction per z, and 1/z.
    pub(super) shear: [f32; 3],
    /// In single precision, hits from here on are worth a second look.
    pub(super) least: f32,
    /// How wrong t may be in single precision, besides a share of it.
    pub(super) doubt: f32,
    /// Least and greatest t that count.
    pub(crate) range: [f32; 2],
    /// Multiply t by this for units of the direction that was given.
    pub(crate) unit: f32,
}

impl Ray {
    /// A ray from `origin` along `direction` (finite, not 0), for t within `range` in units of the direction's
    /// length. `doubt` is how wrong t may be in single precision, near 0: a share of the size of the mesh.
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
        // The power of two by exponent bits; what is out of its range (subnormal or huge) comes close enough.
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
        // x, y, z stay right-handed when the ray runs along +z; along −z, x and y change places.
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

/// What is left of a number when it has been rounded to single precision.
#[inline(always)]
pub(super) fn low_part(x: f64) -> f32 {
    (x - f64::from(x as f32)) as f32
}

/// The nearest hit so far.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Nearest {
    /// In units of the ray's scaled direction; +∞ without a hit.
    pub(crate) t: f64,
    /// Block × 16 + lane; [`NONE`](crate::scene::tree::NONE) without a hit.
    pub(crate) slot: u32,
    /// Boxes and triangles that begin beyond this cannot matter.
    pub(super) limit: f32,
}

impl Nearest {
    /// No hit yet.
    #[inline(always)]
    pub(crate) fn none(ray: &Ray) -> Self {
        Self { t: f64::INFINITY, slot: crate::scene::tree::NONE, limit: ray.range[1] }
    }

    /// Takes a hit if it is nearer. Of two at the same place the lower slot counts, so that the order in which
    /// they are found does not.
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
