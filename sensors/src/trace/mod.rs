//! Ray casting: finding where rays first hit a scene.
//!
//! Each frame begins by placing the instances of the scene around the sensor, in the memory of a [`Workspace`], and
//! building a tree over them; each mesh has its own tree. The tree is then walked once for all rays of the frame, which
//! share an origin. Shadow rays traverse the same trees in packets of 64, with interval bounds: a subtree that no ray
//! of the packet can hit is skipped for all of them.

mod bands;
pub(crate) mod behind;
pub(crate) mod beyond;
mod boxes;
mod cast;
pub(crate) mod curved;
pub(crate) mod error;
mod flow;
pub(crate) mod grid;
pub(crate) mod hit_point;
pub(crate) mod image;
mod landmarks;
pub(crate) mod measure;
pub(crate) mod memory;
mod near;
pub(crate) mod normals;
pub(crate) mod packet;
pub(crate) mod packet_hits;
pub(crate) mod place;
pub(crate) mod prefetch;
pub mod rays;
pub(crate) mod recent;
pub(crate) mod resolve;
pub(crate) mod room;
pub(crate) mod second_look;
pub(crate) mod shapes;
pub(crate) mod tiling;
mod too_near;
mod top;
pub(crate) mod truth;
pub(crate) mod view;
pub(crate) mod volley;

pub use crate::memory::CacheLine;
pub use boxes::{SeenBox, seen_boxes};
pub use cast::{Hits, cast_grid, grid_workspace_len};
pub use error::SenseError;
pub use landmarks::{Landmark, Sighting, landmarks_workspace_len, see_landmarks};
pub use memory::Workspace;
#[cfg(feature = "alloc")]
pub use memory::WorkspaceBuf;
pub use packet::Faces;
pub use too_near::TooNear;
pub use truth::Truth;
