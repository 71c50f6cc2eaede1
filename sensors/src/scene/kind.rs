//! What kinds of shapes there are, and the numbers that stand for them in a scene's memory.
//!
//! A scene is plain data that may come from a file, so an instance holds a number. It is checked once, where the data come
//! in, and read through [`Kind::from_number`] alone: all that depends on the kind is a match of enums without a gap.

/// What the surface of an instance is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A shape with a formula.
    Solid(Solid),
    /// Triangles under a tree.
    Triangles(Triangles),
}

/// Shapes with a formula. All are convex.
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

/// Where triangles come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Triangles {
    Mesh,
    HeightField,
}

impl Kind {
    /// The kind that a number stands for, if it is one.
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

    /// The same of a number that was checked when it came in. One that was not is a box: something to see, and nothing
    /// that needs more than the instance itself.
    #[inline(always)]
    pub(crate) const fn of_checked(number: u32) -> Self {
        match Self::from_number(number) {
            Some(kind) => kind,
            None => Self::Solid(Solid::Box),
        }
    }

    /// The number that stands for it.
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

    /// Whether it is a mesh.
    #[inline(always)]
    pub(crate) const fn is_mesh(self) -> bool {
        matches!(self, Self::Triangles(Triangles::Mesh))
    }

    /// Whether it is a shape with a formula. These are convex: they cannot stand in their own light.
    #[inline(always)]
    pub(crate) const fn is_solid(self) -> bool {
        matches!(self, Self::Solid(_))
    }
}

/// Half the edges of the box of an endless plane: a tenth of a light-year, beyond the range of every sensor, and
/// yet small enough that areas in single precision stay finite.
const ENDLESS: f64 = 1e15;

impl Solid {
    /// Half extents of the box that holds the surface, by the sizes of its instance.
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

    /// Whether it has nothing but flat faces, and few of them.
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
