//! The whole wire format as data: the schema from which the bindings for C, C++ and Python are generated
//! (`bridge/c/tests/bindings`).

pub use super::layout::{Enum, Field, Struct, Value};
pub use super::point::{PointField, PointLayout};

use super::{DistortionModel, Encoding, Kind, Operation, header, payload};

/// Every enumeration.
pub const ENUMS: &[Enum] = &[Kind::LAYOUT, Encoding::LAYOUT, DistortionModel::LAYOUT, Operation::LAYOUT];

/// Returns every struct. Parts of another struct come before it, except for the blocks of the header.
pub fn structs() -> impl Iterator<Item = &'static Struct> {
    [header::STRUCTS].into_iter().chain(payload::ALL.iter().copied()).flatten()
}
