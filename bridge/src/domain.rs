//! A domain: its name, and what of it lies on disk.
//!
//! [`Keeper`] is the one way in. Below it: [`places`] knows what is there and whose it is, [`living`] who lives,
//! [`remnants`] and [`remains`] what is dead and how it goes, [`sharing`] opens files to a group, [`unborn`] ends waits
//! for what will never be complete, [`room`] asks for space.

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
