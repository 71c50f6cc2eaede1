//! Belvedere: a robot sensor simulator.
#![forbid(unsafe_code)]

pub mod description;
