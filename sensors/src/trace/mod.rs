//! Ray casting: finding where rays first hit a scene.
//!
//! Each frame begins by placing the instances of the scene around the sensor, in the memory of a [`Workspace`], and
//! building a tree over them; each mesh has its own tree. The tree is then walked once for all rays of the frame, which
//! share an origin. Shadow rays traverse the same trees in packets of 64, with interval bounds: a subtree that no ray
//! of the packet can hit is skipped for all of them.
//!
//! | module | holds |
//! |---|---|
//! | `placed` | the instances of a scene around the sensor, under a tree |
//!  `grid`, `image` | frames of rays that share an origin, and the drawing of shapes into them |
//!  `packet` | 64 rays at a time: shadows, mirrors and panes, moving rays |
//! | [`rays`] | independent rays |
//! | `shapes` | intersections of a ray with each kind of shape |
//! | `hit` | the instance, point, distance and normal of a hit |
//! | `truth` | ground truth, optical flow, landmarks |

mod cast;
pub(crate) mod error;
pub(crate) mod grid;
pub(crate) mod hit;
pub(crate) mod image;
pub(crate) mod packet;
pub(crate) mod placed;
pub(crate) mod prefetch;
pub mod rays;
pub(crate) mod shapes;
mod too_near;
pub(crate) mod truth;

pub use crate::memory::CacheLine;
pub use cast::{Hits, cast_grid, grid_workspace_len};
pub use error::SenseError;
pub use packet::Faces;
pub use placed::memory::Workspace;
#[cfg(feature = "alloc")]
pub use placed::memory::WorkspaceBuf;
pub use too_near::TooNear;
pub use truth::Truth;
pub use truth::boxes::{SeenBox, seen_boxes};
pub use truth::landmarks::{Landmark, Sight, Sighting, landmarks_workspace_len, see_landmarks};
