//! Tests packets of all layouts byte by byte.

mod any_input;
mod columns;
mod layouts;
