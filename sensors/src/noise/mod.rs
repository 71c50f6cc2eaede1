//! Counter-based random numbers and the noise models built on them.
//!
//! | layer | gives |
//! |---|---|
//! | [`philox`] | the block function: 128 bits of counter and 64 bits of key to 128 random bits |
//! | [`stream`] | which counter and key belong to a sample: a function of (seed, sensor, frame, channel, index) |
//! | [`gaussian`] | standard normals from these words, the same bits on every machine |
//! | [`gazebo`] | the noise that SDF's `<noise type="gaussian">` describes |
//! | [`instrument`] | errors of gyros, accelerometers and the like: density, drifting bias, scale, misalignment |
//!
//! There is no generator state. A sample is computed from where and when it is, so neither the order of the
//! pixels, nor the number of threads, nor the width of the vectors can change a frame.

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
