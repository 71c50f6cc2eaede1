//! The wire format: headers, payloads, and the numbers of kinds and encodings.

mod error;
mod fields;
mod header;
mod kind;
mod layout;
pub mod payload;
pub mod point;
mod ros;
pub mod schema;
mod text;
mod view;

pub use error::FrameError;
pub use fields::{Describe, Fields, RosType, Value};
pub use header::{FrameHeader, Intrinsics, ScanGeometry};
pub use kind::{DistortionModel, Encoding, Kind, MAX_DISTORTION, Operation};
pub use ros::{Ros, RosBytes, RosMessage, RosPrimitive};
pub use text::{Text, TextError};
pub use view::FrameView;

/// The version of the layout of header and payloads.
const SCHEMA: u16 = 2;
