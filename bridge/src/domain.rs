//! A domain: its name, and its files on disk.
//!
//! All access goes through [`Keeper`]. The modules below it:
//!
//! - [`places`]: paths and ownership of the files;
//! - [`living`]: which nodes and processes are alive;
//! - [`remnants`] and [`remains`]: removal of what dead processes left;
//! - [`sharing`]: group permissions;
//! - [`unborn`]: removal of files that will never be complete, so that no process waits for them;
//! - [`room`]: free space.

mod group;
mod keeper;
mod living;
mod name;
mod places;
mod remains;
mod remnants;
pub(crate) mod room;
mod sharing;
mod topic;
mod unborn;

pub use group::Group;
pub use name::Domain;

pub(crate) use keeper::Keeper;
pub(crate) use name::Ipc;
pub(crate) use topic::{service_name, topic_of_service};
