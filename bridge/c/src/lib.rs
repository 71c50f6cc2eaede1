//! C interface of the bridge: opaque handles, plain structs, status codes with a text.
//!
//! [`layout`] mirrors the wire format for C, [`status`] keeps errors and panics on this side, the others wrap one
//! Rust type each. `include/belvedere.h` is made from these files by cbindgen.
// What C sees is public to the linker, not to Rust.
#![allow(unreachable_pub)]

mod frame;
mod layout;
mod node;
mod status;
mod subscriber;
mod velocity;
