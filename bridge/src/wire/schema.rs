//! The whole wire format as data: the schema that the bindings of C, C++ and Python are made from
//! (`bridge/c/tests/bindings`).

pub use super::layout::{Enum, Field, Struct, Value};

use super::{DistortionModel, Encoding, Kind, Operation, header, payload};

/// Every list of numbers.
pub const ENUMS: &[Enum] = &[Kind::LAYOUT, Encoding::LAYOUT, DistortionModel::LAYOUT, Operation::LAYOUT];

/// Every struct; what is part of another comes before it, but for the header's blocks.
pub fn structs() -> impl Iterator<Item = &'static Struct> {
    [header::STRUCTS].into_iter().chain(payload::ALL.iter().copied()).flatten()
}
