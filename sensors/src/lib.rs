#![doc = include_str!("../README.md")]
//!
//! # How the crate is built
//!
//! A configuration is checked once and makes a [`Sensor`], which fills slices that the caller provides. A [`scene`]
//! holds shapes and materials; a [`Moment`] holds the poses of the sensor and of every instance, so one scene can be
//! seen at many moments. By default, cameras see instances that are [`VISUAL`](scene::visibility::VISUAL), and lidars
//! hit instances that are [`COLLISION`](scene::visibility::COLLISION).
//!
//! # Stack
//!
//! Every function that senses, casts rays or builds a scene needs less than 60 KiB of stack, and so runs on a thread
//! with 64 KiB. (Measured on x86-64 at SSE2 and AVX2, in the dev and release profiles.) With `rayon`, a thread that
//! waits for others may begin other work on the same stack, and needs more.
//!
//! # Layers
//!
//! Modules use only those above them in this list:
//!
//! 1. [`simd`]: SIMD levels; [`pose`]: rigid poses in f64; [`srgb`]: the transfer curve of pictures.
//! 2. [`noise`]: counter-based random numbers, Gaussian noise, the errors of instruments.
//! 3. [`moment`]: poses over time; [`scene`]: shapes, materials, lights, as borrowed plain data.
//! 4. [`optics`]: lens models, and the directions of rays.
//! 4. [`optics`]: lens models, and the directions of rays.
//! 5. [`trace`]: the points where rays hit the scene.
//! 6. `shade` (private): the colours of these points.
//! 7. [`device`]: image sensors and depth devices, which turn light into measured values.
#![cfg_attr(not(feature = "std"), no_std)]
#![forbid(unsafe_code)]
#![warn(missing_docs)]
// Some items have no user in the crate without `raw`. With it, the compiler finds those that have none at all.
#![cfg_attr(not(feature = "raw"), allow(dead_code, unreachable_pub, unused_imports))]
// Kernels must be inlined into the `vectorize` closure that compiles them for an instruction set, and their plain
// indexed loops over lanes are what the compiler vectorises.
#![allow(clippy::inline_always, clippy::needless_range_loop)]

#[cfg(feature = "alloc")]
extern crate alloc;

/// Builder methods that set the fields of a configuration.
macro_rules! setters {
    ($($(#[$doc:meta])* $field:ident: $kind:ty,)*) => {$(
        $(#[$doc])*
        #[must_use]
        pub const fn $field(mut self, $field: $kind) -> Self {
            self.$field = $field;
            self
        }
    )*};
}

/// Builder methods that set the buffers of an output. A new output has no buffers.
macro_rules! outputs {
    ($($(#[$doc:meta])* $field:ident: $kind:ty,)*) => {
        /// Creates an output with no buffers; a part is computed only when its buffer is set.
        pub const fn new() -> Self {
            Self { $($field: None,)* }
        }

        $($(#[$doc])*
        #[must_use]
        pub fn $field(mut self, $field: $kind) -> Self {
            self.$field = Some($field);
            self
        })*
    };
}

/// The names of a module's presets, and the look-up by name. All modules of presets have the same three items: `ALL`,
/// `NAMES` and `named`.
macro_rules! preset_names {
    ($all:ident: $preset:ty) => {
        /// The names of all presets, by which configuration files refer to them.
        pub const NAMES: [&str; $all.len()] = {
            let mut names = [""; $all.len()];
            let mut index = 0;
            while index < names.len() {
                names[index] = $all[index].name;
                index += 1;
            }
            names
        };

        /// Returns the preset with the given name, or `None` if there is none.
        #[must_use]
        pub fn named(name: &str) -> Option<$preset> {
            $all.iter().find(|preset| preset.name == name).copied()
        }
    };
}

pub mod device;
mod execution;
mod memory;
pub mod moment;
pub mod noise;
pub mod optics;
mod parameter;
#[cfg(feature = "parry")]
pub mod parry;
pub mod pose;
mod pose_convert;
#[cfg(feature = "rapier")]
pub mod rapier;
pub mod scene;
mod sensor;
mod shade;
pub mod simd;
pub mod srgb;
pub mod trace;

pub use glam;

pub use execution::Execution;
#[doc(no_inline)]
pub use moment::{Capture, Keyframe, Moment, Shutter, Slice};
pub use parameter::{ParameterError, Rule};
#[doc(no_inline)]
pub use pose::Pose;
pub use sensor::Sensor;
#[cfg(feature = "alloc")]
pub use sensor::any::{AnyOutput, AnySensor};
#[doc(inline)]
pub use sensor::{camera, depth, imu, lidar, scanner};
#[doc(no_inline)]
pub use trace::SenseError;
