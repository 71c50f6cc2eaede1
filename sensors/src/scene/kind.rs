//! The kinds of shapes, and the numbers that represent them in a scene's memory.
//!
//! A scene is plain data that may come from a file, so an instance stores a number. The number is checked once, when
//! the data are loaded, and decoded only by [`Kind::from_number`], so all code that depends on the kind is an
//! exhaustive match.

/// The kind of surface of an instance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A shape given by a formula.
    Solid(Solid),
    /// Triangles with a tree.
    Triangles(Triangles),
}

/// Shapes given by a formula. All are convex.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Solid {
    Box,
    Rectangle,
    Sphere,
    Cylinder,
    Capsule,
    Plane,
    Ellipsoid,
    Cone,
}

/// Sources of triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Triangles {
    Mesh,
    HeightField,
}

impl Kind {
    /// The kind that a number represents, or `None` if there is no such kind.
    #[inline(always)]
    pub(crate) const fn from_number(number: u32) -> Option<Self> {
        Some(match number {
            0 => Self::Solid(Solid::Box),
            1 => Self::Solid(Solid::Rectangle),
            2 => Self::Solid(Solid::Sphere),
            3 => Self::Solid(Solid::Cylinder),
            4 => Self::Solid(Solid::Capsule),
            5 => Self::Triangles(Triangles::Mesh),
            6 => Self::Solid(Solid::Plane),
            7 => Self::Solid(Solid::Ellipsoid),
            8 => Self::Solid(Solid::Cone),
            9 => Self::Triangles(Triangles::HeightField),
            _ => return None,
        })
    }

    /// The kind for a number that was checked when it was loaded. An unchecked, invalid number becomes a box, which is
    /// visible and needs no data besides the instance itself.
    #[inline(always)]
    pub(crate) const fn of_checked(number: u32) -> Self {
        match Self::from_number(number) {
            Some(kind) => kind,
            None => Self::Solid(Solid::Box),
        }
    }

    /// The number that represents the kind.
    pub(crate) const fn number(self) -> u32 {
        match self {
            Self::Solid(Solid::Box) => 0,
            Self::Solid(Solid::Rectangle) => 1,
            Self::Solid(Solid::Sphere) => 2,
            Self::Solid(Solid::Cylinder) => 3,
            Self::Solid(Solid::Capsule) => 4,
            Self::Triangles(Triangles::Mesh) => 5,
            Self::Solid(Solid::Plane) => 6,
            Self::Solid(Solid::Ellipsoid) => 7,
            Self::Solid(Solid::Cone) => 8,
            Self::Triangles(Triangles::HeightField) => 9,
        }
    }

    /// Returns true for a mesh.
    #[inline(always)]
    pub(crate) const fn is_mesh(self) -> bool {
        matches!(self, Self::Triangles(Triangles::Mesh))
    }

    /// Returns true for a shape given by a formula. These are convex: they cannot shadow themselves.
    #[inline(always)]
    pub(crate) const fn is_solid(self) -> bool {
        matches!(self, Self::Solid(_))
    }
}

/// Half edge length of the bounding box of an infinite plane: a tenth of a light-year, beyond the range of every
/// sensor, yet small enough that areas in single precision stay finite.
const ENDLESS: f64 = 1e15;

impl Solid {
    /// Half extents of the bounding box of the surface, from the sizes of its instance.
    #[inline(always)]
    pub(crate) const fn half_extents(self, [a, b, c]: [f64; 3]) -> [f64; 3] {
        match self {
            Self::Box | Self::Ellipsoid => [a, b, c],
            Self::Rectangle => [a, b, 0.0],
            Self::Sphere => [a, a, a],
            Self::Cylinder | Self::Cone => [a, a, b],
            Self::Capsule => [a, a, a + b],
            Self::Plane => [ENDLESS, ENDLESS, 0.0],
        }
    }

    /// Returns true if all faces are flat. Such shapes have few faces.
    #[inline(always)]
    pub(crate) const fn has_flat_faces(self) -> bool {
        match self {
            Self::Box | Self::Rectangle | Self::Plane => true,
            Self::Sphere | Self::Cylinder | Self::Capsule | Self::Ellipsoid | Self::Cone => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Kind;

    #[test]
    fn numbers_stand_for_kinds() {
        for number in 0..10 {
            assert_eq!(Kind::from_number(number).map(Kind::number), Some(number));
        }
        assert_eq!(Kind::from_number(10), None);
        assert_eq!(Kind::from_number(u32::MAX), None);
    }
}
