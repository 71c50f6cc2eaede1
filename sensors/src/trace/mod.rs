//! Ray casting: where packets of 64 rays first meet a scene.
//!
//! Each frame begins by placing the scene's instances around the sensor ([`Workspace`] is the memory for it)
//! and building a tree over them; each mesh has its own tree. Packets go through both with interval bounds: a
//! subtree that no ray of the packet can meet is left out for all 64 at once.

pub(crate) mod frame;
pub(crate) mod packet;
pub mod rays;
mod shapes;
pub(crate) mod surface;
pub(crate) mod traverse;

#[cfg(feature = "alloc")]
pub use frame::WorkspaceBuf;
pub use frame::{Capture, Placed, Workspace};
pub use packet::Faces;
