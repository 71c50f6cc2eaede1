//! Publishers and subscribers, of one process and of several, of one user and of several.

#[path = "../processes_kit/mod.rs"]
mod processes_kit;
#[path = "../world/mod.rs"]
mod world;

mod access;
mod busy_poll;
mod clocks;
mod consumers;
mod deserted;
mod forks;
mod holders;
mod killed;
mod kills;
mod layout;
mod lossless;
mod refusals;
mod remains;
mod shared_memory;
mod soak;
mod streams;
mod unborn;
mod users;
mod versions;
mod waiting;
mod zero_copy;
