//! Packets of every layout, byte by byte.

mod any_input;
mod columns;
mod layouts;
