//! Errors found in the parts of a scene.

use super::limits::Refusal;
use super::{SceneError, TreeFault};

/// The reason why slices, or the sections of a baked scene, do not form a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum SceneFault {
    /// Two slices have lengths that do not match.
    Count {
        /// The slice with the wrong number of elements.
        slice: &'static str,
        /// Number of elements that the slice has.
        have: u64,
        /// Number of elements that the slice should have.
        need: u64,
    },
    /// A value is not allowed.
    Value {
        /// Name of the slice.
        slice: &'static str,
        /// Index of the element in the slice.
        element: usize,
        /// Name of the field of the element.
        field: &'static str,
        /// The value; the first invalid one if there are several.
        value: f64,
    },
    /// The tree of a mesh is invalid.
    Tree {
        /// Index of the mesh.
        mesh: usize,
        /// The fault of the tree.
        fault: TreeFault,
    },
    /// A height field is invalid.
    HeightField {
        /// Index of the height field.
        element: usize,
        /// The error of the height field.
        error: SceneError,
    },
    /// All instances together have more triangles than 31 bits can count.
    TooManyTriangles,
}

impl core::fmt::Display for SceneFault {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Count { slice, have, need } => {
                write!(f, "`{slice}` of the scene has {have} elements, and the others call for {need}")
            }
            Self::Value { slice, element, field, value } => {
                write!(f, "element {element} of `{slice}` of the scene: {field} cannot be ")?;
                // Most fields are single-precision numbers, which need fewer digits.
                let single = *value as f32;
                if f64::from(single) == *value { write!(f, "{single}") } else { write!(f, "{value}") }
            }
            Self::Tree { mesh, fault } => {
                write!(f, "the tree of element {mesh} of `meshes` of the scene: {fault}")
            }
            Self::HeightField { element, error } => {
                write!(f, "element {element} of `height_fields` of the scene: {error}")
            }
            Self::TooManyTriangles => {
                f.write_str("the instances of the scene have more triangles than 31 bits count")
            }
        }
    }
}

impl core::error::Error for SceneFault {}

pub(super) fn count(slice: &'static str, have: usize, need: usize) -> Result<(), SceneFault> {
    if have == need { Ok(()) } else { Err(SceneFault::Count { slice, have: have as u64, need: need as u64 }) }
}

/// An element of a slice, as named in errors.
#[derive(Clone, Copy)]
pub(super) struct Element {
    slice: &'static str,
    element: usize,
}

impl Element {
    pub(super) fn of(slice: &'static str, element: usize) -> Self {
        Self { slice, element }
    }

    pub(super) fn require(self, holds: bool, field: &'static str, value: f64) -> Result<(), SceneFault> {
        let Self { slice, element } = self;
        if holds { Ok(()) } else { Err(SceneFault::Value { slice, element, field, value }) }
    }

    /// Converts the result of a check that the builder makes too.
    pub(super) fn accept(self, checked: Result<(), Refusal>) -> Result<(), SceneFault> {
        checked.or_else(|Refusal { field, value, .. }| self.require(false, field, value))
    }

    /// Checks that an index is less than the number of elements.
    pub(super) fn index(self, field: &'static str, index: u32, count: usize) -> Result<(), SceneFault> {
        self.require((index as usize) < count, field, f64::from(index))
    }

    /// Checks that a range of a slice starts where the previous one ends.
    pub(super) fn follows(
        self,
        field: &'static str,
        first: u32,
        count: u32,
        end: &mut usize,
        length: usize,
    ) -> Result<(), SceneFault> {
        self.require(first as usize == *end && count as usize <= length - *end, field, f64::from(first))?;
        *end += count as usize;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use std::string::ToString as _;

    #[test]
    fn values_are_shown_with_the_digits_that_they_were_written_with() {
        let said = |value| Element::of("lights", 3).require(false, "falloff", value).unwrap_err().to_string();
        assert_eq!(said(f64::from(-0.1_f32)), "element 3 of `lights` of the scene: falloff cannot be -0.1");
        assert_eq!(said(-0.1), "element 3 of `lights` of the scene: falloff cannot be -0.1");
        assert_eq!(
            said(1e300),
            "element 3 of `lights` of the scene: falloff cannot be ".to_owned() + &1e300.to_string()
        );
        assert!(said(f64::NAN).ends_with("cannot be NaN"));
    }
}
