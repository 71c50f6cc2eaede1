//! The subcommands of `belvedere`.

pub mod echo;
pub mod error;
pub mod follow;
pub mod hz;
pub mod list;
pub mod message;
pub mod snapshot;
pub mod statistics;
