//! Lens models: from a point to its pixel, and from a pixel to its ray.
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
//! All of them are a [`Lens`]. Their constructors check every parameter, once; after that nothing fails, and what
//! a lens cannot see is `None`. Each model has a *domain*: the directions around the axis that it sends to
//! different pixels. It ends where the image radius stops growing with the angle, since from there on a pixel
//! would see in two directions at once. `project` and `unproject` keep to the same domain, on which they are
//! inverse to each other.
//!
//! Optical frame (REP-103): x right, y down, z forward. Pixels are (column, row), and pixel centres are
//! integers. Angles are radians. Everything is f64 by + − × ÷ √ and `libm`, so that the bits are the same on
//! every machine.
//!
//! ```
//! use belvedere_sensors::optics::{Intrinsics, KannalaBrandt, Lens};
//! use glam::{DVec2, DVec3};
//!
//! let intrinsics = Intrinsics { fx: 200.0, fy: 200.0, cx: 399.5, cy: 399.5, skew: 0.0 };
//! let fisheye = KannalaBrandt::new(intrinsics, [0.0; 4]).unwrap();
//! // Square to the axis, on the right: 200 px/rad · π/2 from the centre.
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

/// The largest radius on a plane at distance 1, the tangent of the angle: 0.2″ short of 90°. Planes end there,
/// as f64 cannot tell much more.
const LARGEST_TANGENT: f64 = 1e6;
