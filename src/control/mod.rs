//! How other processes control a running simulation.
//!
//! | file | is |
//! |---|---|
//! | `inbox` | the streams of commands and results |
//! | `roster` | who is in the world, where each was at the start, and what names mean |
//! | `states` | the streams of the poses and velocities of all models and links |
//! | `values` | poses and velocities of commands, checked |
//! | `spawn` | a model out of a command's text |
//!
//! What a command does is [`crate::simulation`]'s: it is applied between two frames, at the next boundary, so that the
//! same commands at the same simulated times give the same bytes.

pub mod inbox;
pub mod roster;
pub mod spawn;
pub mod states;
pub mod values;

pub use inbox::{Inbox, Request};
pub use roster::{Resident, Role, Roster};
pub use spawn::SpawnOptions;
pub use states::StateStreams;
