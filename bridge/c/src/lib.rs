//! C interface of the bridge: opaque handles, plain structs, status codes with a text.
//!
//! The structs are those of `belvedere_bridge`, which the header has in C. [`status`] keeps errors and panics on this side, the others wrap one
//! Rust type each. `include/belvedere.h` is made from these files by cbindgen, and from the schema of the
//! wire format by `tests/bindings`.
// These comments become the C header, which has no use for backticks; errors are explained there once for all.
#![allow(clippy::doc_markdown)]
// What C sees is public to the linker, not to Rust.
#![allow(unreachable_pub)]

mod command;
mod control;
mod frame;
mod node;
#[cfg(test)]
mod round_trip;
mod status;
mod subscriber;
mod synchronizer;
