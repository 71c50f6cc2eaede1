//! Projection: which way the ray of each pixel goes.

mod pinhole;

pub use pinhole::Pinhole;
