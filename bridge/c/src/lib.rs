//! C interface of the bridge: opaque handles, plain structs, status codes with a text.
//!
//! [`layout`] mirrors the wire format for C, [`status`] keeps errors and panics on this side, the others wrap one
//! Rust type each. `include/belvedere.h` is made from these files by cbindgen.
// These comments become the C header, which has no use for backticks; errors are explained there once for all.
#![allow(clippy::doc_markdown)]
// What C sees is public to the linker, not to Rust.
#![allow(unreachable_pub)]

mod command;
mod control;
mod frame;
mod layout;
mod node;
#[cfg(test)]
mod round_trip;
mod status;
mod subscriber;
mod synchronizer;
