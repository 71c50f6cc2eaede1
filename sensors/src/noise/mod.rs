//! Counter-based random numbers and the noise models built on them.
//!
//! | layer | provides |
//! |---|---|
//! | [`philox`] | the block function: maps a 128-bit counter and a 64-bit key to 128 random bits |
//! | [`stream`] | the counter and key of a sample: a function of (seed, sensor, frame, channel, index) |
//! | [`gaussian`] | standard normals from these words, with the same bits on every machine |
//! | [`gazebo`] | the noise that SDF's `<noise type="gaussian">` describes |
//! | [`instrument`] | errors of gyroscopes, accelerometers and the like: noise density, drift, scale, misalignment |
//!
//! There is no generator state. A sample is computed from its name alone, so a frame does not depend on the order of
//! the pixels, the number of threads or the vector width.

pub mod gaussian;
pub mod gazebo;
pub mod instrument;
pub mod philox;
pub mod stream;

pub use gaussian::{fill_standard_normal, standard_normal};
pub(crate) use gaussian::{normal_columns, normal_lines, normals64};
pub use gazebo::{GaussianNoise, GaussianNoiseConfig};
pub use instrument::{Instrument, InstrumentConfig, InstrumentState};
pub use philox::philox4x32;
pub use stream::Stream;
