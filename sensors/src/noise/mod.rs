//! Counter-based random numbers and the noise models built on them.
//!
//! | item | provides |
//! |---|---|
//! | [`philox4x32`] | the block function: maps a 128-bit counter and a 64-bit key to 128 random bits |
//! | [`Stream`] | the counter and key of a sample: a function of (seed, sensor, frame, channel, index) |
//! | [`fill_standard_normal`] | standard normals from these words, with the same bits on every machine |
//! | [`GaussianNoise`] | the noise that SDF's `<noise type="gaussian">` describes |
//! | [`Instrument`] | errors of gyroscopes, accelerometers and the like: noise density, drift, scale, misalignment |
//!
//! There is no generator state. A sample is computed from its name alone, so a frame does not depend on the order of
//! the pixels, the number of threads or the vector width.

mod gaussian;
mod instrument;
mod normal;
mod philox;
mod stream;

pub use gaussian::{GaussianNoise, GaussianNoiseConfig};
pub use instrument::{Instrument, InstrumentConfig, InstrumentState};
pub use normal::{fill_standard_normal, standard_normal};
pub(crate) use normal::{normal_columns, normal_lines, normals64};
pub use philox::philox4x32;
pub use stream::Stream;
