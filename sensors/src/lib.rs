//! Robot sensors by exact ray casting: cameras, depth cameras and lidars.
//!
//! `no_std`, no allocation while sensing, no unsafe code, and the same bits from the same input on every machine,
//! thread count and SIMD level. The layers, bottom up; each uses only those above it in this list:
//!
//! 1. [`simd`]: the level token and the packet width; [`pose`]: rigid poses in f64; [`srgb`]: the curve of pictures.
//! 2. [`noise`]: counter-based random numbers, Gazebo's Gaussian noise, the errors of instruments.
//! 3. [`moment`]: where everything is, and when; [`scene`]: what is looked at, as plain borrowed data.
//! 4. [`optics`]: which way rays go: the rules of pinhole and lidar, and tables of any lens model.
//! 5. [`trace`]: where rays meet the scene.
//! 6. `shade`: what colour that is.
//! 7. [`device`]: what a camera's sensor and electronics make of light.
//! 8. [`camera`], [`depth`], [`lidar`], [`scanner`]: the sensors. A configuration is checked once and makes a [`Sensor`],
//!    which fills the caller's slices, and does not allocate. [`imu`]: what gyros and accelerometers make of a motion.
//!
//! Lengths are metres, angles radians, frames right-handed. A sensor looks along +x, z is up; optical frames
//! (clouds, [`optics`]) have z forward, x right, y down. Pixel centres are integers.
//!
//! What a sensor sees is decided by [`scene::visibility`]: cameras see visuals, lidars hit collision shapes
//! unless they are told otherwise.
//!
//! Stack: every function that senses, casts rays or builds a scene needs less than 60 KiB of stack, measured on x86-64 at
//! SSE2 and AVX2 in the dev and release profiles, and so runs on a thread with 64 KiB. With `rayon`, a thread that waits
//! for others may begin other work on the same stack, and needs more.
//!
//! Features: `std` (default) finds the SIMD level at run time; `alloc` gives the owned
//! [`SceneBuilder`](scene::SceneBuilder) and [`WorkspaceBuf`](trace::WorkspaceBuf), without which scenes are made of the
//! caller's arrays ([`SceneSlices`](scene::SceneSlices)); `rayon` spreads a frame over
//! threads; `nalgebra` converts poses; `parry` takes in shapes of parry3d, and `rapier` mirrors the colliders of rapier3d.
#![cfg_attr(not(feature = "std"), no_std)]
#![forbid(unsafe_code)]
#![warn(missing_docs)]
// Kernels must be inlined into the `vectorize` closure that compiles them for an instruction set, and their plain
// indexed loops over lanes are what the compiler vectorises.
#![allow(clippy::inline_always, clippy::needless_range_loop)]

#[cfg(feature = "alloc")]
extern crate alloc;

/// Named setters of a configuration's fields.
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

/// Named setters of the parts of an output, none of which is wanted at first.
macro_rules! outputs {
    ($($(#[$doc:meta])* $field:ident: $kind:ty,)*) => {
        /// Of nothing.
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

pub mod device;
mod execution;
mod memory;
pub mod moment;
pub mod noise;
pub mod optics;
#[cfg(feature = "parry")]
pub mod parry;
pub mod pose;
mod pose_convert;
#[cfg(feature = "rapier")]
pub mod rapier;
pub mod scene;
pub mod sensor;
mod shade;
pub mod simd;
pub mod srgb;
pub mod trace;

pub use execution::Execution;
pub use moment::{Capture, Keyframe, Moment, Shutter, Slice};
pub use pose::Pose;
pub use sensor::{Sensor, camera, depth, imu, lidar, scanner};
pub use trace::SenseError;
