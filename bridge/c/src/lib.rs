//! C interface of the bridge: opaque handles, plain structs, status codes with a text.
//!
//! [`layout`] mirrors the wire format for C, [`status`] keeps errors and panics on this side, the others wrap one
//! Rust type each. `include/belvedere.h` is made from these files by cbindgen.
#![allow(non_camel_case_types)]
// The documentation is the C header's: errors are stated once for all functions, there.
#![allow(clippy::missing_errors_doc)]

mod frame;
mod layout;
mod node;
mod status;
mod subscriber;
mod velocity;
