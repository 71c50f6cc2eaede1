//! Ray casting: where packets of 64 rays first meet a scene.
//!
//! Each frame begins by placing the scene's instances around the sensor ([`Workspace`] is the memory for it)
//! and building a tree over them; each mesh has its own tree. Packets go through both with interval bounds: a
//! subtree that no ray of the packet can meet is left out for all 64 at once.

mod cast;
pub(crate) mod frame;
pub(crate) mod grid;
pub(crate) mod image;
pub(crate) mod memory;
pub(crate) mod packet;
pub mod rays;
pub(crate) mod resolve;
mod shapes;
pub(crate) mod surface;
pub(crate) mod traverse;
pub(crate) mod view;

pub use cast::{Hits, cast_grid};
pub use grid::{RayGrid, SphericalGrid};
pub use memory::{CacheLine, Workspace as NewWorkspace, workspace_len};

#[cfg(feature = "alloc")]
pub use frame::WorkspaceBuf;
pub use frame::{Capture, Placed, Workspace};
pub use packet::Faces;
