//! What may be wrong with the parts of a scene.

use super::limits::Refusal;
use super::{SceneError, TreeFault};

/// Why slices, or the sections of a baked scene, are not a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum SceneFault {
    /// Two slices do not go together.
    Count {
        /// Which has a wrong number of elements.
        slice: &'static str,
        /// Those that it has.
        have: u64,
        /// Those that it should have.
        need: u64,
    },
    /// A value that cannot be.
    Value {
        /// Which slice.
        slice: &'static str,
        /// Which element of it.
        element: usize,
        /// Which part of the element.
        field: &'static str,
        /// The value; the first bad one of several.
        value: f64,
    },
    /// The tree of a mesh.
    Tree {
        /// Which mesh.
        mesh: usize,
        /// What is wrong with its tree.
        fault: TreeFault,
    },
    /// A height field.
    HeightField {
        /// Which.
        element: usize,
        /// What is wrong with it.
        error: SceneError,
    },
    /// More triangles in all instances together than 31 bits count.
    TooManyTriangles,
}

impl core::fmt::Display for SceneFault {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Count { slice, have, need } => {
                write!(f, "`{slice}` of the scene has {have} elements, and the others call for {need}")
            }
            Self::Value { slice, element, field, value } => {
                write!(f, "element {element} of `{slice}` of the scene: {field} cannot be {value}")
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

/// Names an element of a slice in its errors.
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

    /// The checks that a builder makes too.
    pub(super) fn accept(self, checked: Result<(), Refusal>) -> Result<(), SceneFault> {
        checked.or_else(|Refusal { field, value, .. }| self.require(false, field, value))
    }

    /// An index below a number of elements.
    pub(super) fn index(self, field: &'static str, index: u32, count: usize) -> Result<(), SceneFault> {
        self.require((index as usize) < count, field, f64::from(index))
    }

    /// The range of a slice that follows the last one's.
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
