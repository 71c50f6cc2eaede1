//! Lens models, which map points to pixels and pixels to rays.
//!
//! | model | parameters | beyond 90° from the axis | as in |
//! |---|---|---|---|
//! | [`Pinhole`] | – | no | everywhere |
//! | [`BrownConrady`] | k1 k2 p1 p2 k3 … τy | no | OpenCV, ROS `plumb_bob` and `rational_polynomial` |
//! | [`KannalaBrandt`] | k1 k2 k3 k4 | yes | OpenCV `fisheye`, ROS `equidistant` |
//! | [`Eucm`] | α β | yes | Kalibr |
//! | [`DoubleSphere`] | ξ α | yes | Kalibr, Basalt |
//! | [`Mei`] | ξ k1 k2 p1 p2 | yes | OpenCV `omnidir`, Kalibr `omni` |
//! | [`Equirectangular`] | – | all round | panoramas |
//! | [`WideAngle`] | c1 c2 c3 f fun | yes | SDF's `<lens>` |
//!
//! All of them implement [`Lens`]. Their constructors check every parameter; after that nothing fails, and the result
//! is `None` for anything that the lens does not see. Each model has a *domain*: the directions around the axis that it
//! maps to different pixels. The domain ends where the image radius stops growing with the angle, since beyond it a
//! pixel would see in two directions at once. `project` and `unproject` use the same domain, on which they are inverses
//! of each other.
//!
//! In the optical frame (REP 103), x is right, y is down and z is forward. Pixels are (column, row), with pixel centres
//! at integers. Angles are in radians. All computations use f64 with +, −, ×, ÷, √ and `libm`, so the bits are the same
//! on every machine.
//!
//! ```
//! use belvedere_sensors::optics::{Intrinsics, KannalaBrandt, Lens};
//! use belvedere_sensors::glam::{DVec2, DVec3};
//!
//! let intrinsics = Intrinsics { fx: 200.0, fy: 200.0, cx: 399.5, cy: 399.5, skew: 0.0 };
//! let fisheye = KannalaBrandt::new(intrinsics, [0.0; 4]).unwrap();
//! // At 90° from the axis, on the right: 200 px/rad · π/2 from the centre.
//! let pixel = fisheye.project(DVec3::X).unwrap();
//! assert!(pixel.distance(DVec2::new(713.659_265_4, 399.5)) < 1e-6);
//! assert!(fisheye.unproject(pixel).unwrap().distance(DVec3::X) < 1e-12);
//! ```
#![allow(clippy::doc_markdown, reason = "OpenCV is a name, not an item")]
#![allow(clippy::neg_cmp_op_on_partial_ord, reason = "NaN is to be refused along with what is out of range")]

mod any;
mod brown_conrady;
mod distortion;
mod double_sphere;
mod equirectangular;
mod error;
mod eucm;
mod increasing;
mod intrinsics;
mod kannala_brandt;
mod lens;
mod mei;
mod pinhole;
mod polynomial;
pub(crate) mod rays;
mod tilt;
mod wide_angle;

pub use any::Optics;
pub use brown_conrady::BrownConrady;
pub use double_sphere::DoubleSphere;
pub use equirectangular::Equirectangular;
pub use error::MAX_GRID_SIZE;
pub use eucm::Eucm;
pub use intrinsics::Intrinsics;
pub use kannala_brandt::KannalaBrandt;
pub use lens::Lens;
pub use mei::Mei;
pub use pinhole::Pinhole;
#[cfg(feature = "alloc")]
pub use rays::RayTableBuf;
pub use rays::{PinholeGrid, RayTable, SphericalGrid, TableError};
pub use wide_angle::{AngleFunction, Mapping, WideAngle};

/// The greatest radius in a plane at distance 1, the tangent of the angle: 0.2″ less than 90°. Planes end there, since
/// f64 cannot resolve much more.
const LARGEST_TANGENT: f64 = 1e6;
