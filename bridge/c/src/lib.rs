//! C interface of the bridge: opaque handles, plain structs, status codes with a text.
//!
//! The structs are those of `belvedere_bridge`, which the header declares in C. [`status`] keeps errors and panics on
//! this side; each of the other modules wraps one Rust type. cbindgen generates the functions of `include/belvedere.h`
//! from these files, and `tests/bindings` generates its structs from the schema of the wire format.
// These comments become the C header, where backticks have no meaning and errors are documented once for all functions.
#![allow(clippy::doc_markdown)]
// The C functions are public to the linker, not to Rust.
#![allow(unreachable_pub)]

mod command;
mod control;
mod frame;
mod node;
mod ros1;
#[cfg(test)]
mod round_trip;
mod status;
mod subscriber;
mod synchronizer;
