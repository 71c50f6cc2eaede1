//! The scene as one sensor sees it at one moment: instances placed around the sensor, under a tree, in the memory of a
//! [`Workspace`](crate::trace::Workspace).

pub(crate) mod memory;
pub(in crate::trace) mod near;
pub(in crate::trace) mod top;
pub(crate) mod view;
