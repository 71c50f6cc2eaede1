//! Lenses: from which direction a pixel receives light.

use std::f64::consts::PI;

/// The lens of a camera. Parameters that the file omits are derived from the angle of view and the size of the image.
#[derive(Debug, Clone, PartialEq)]
pub struct Lens {
    /// Maps directions to positions in the image.
    pub model: LensModel,
    /// Maps positions to pixels.
    pub intrinsics: LensIntrinsics,
    /// True if `<lens><intrinsics>` gives a focal length; false if it is derived from the angle of view.
    pub has_own_focal_length: bool,
    /// `<lens><projection>`: P of `CameraInfo`, if it differs from the intrinsics.
    pub projection: Option<LensProjection>,
}

/// Maps a direction (x, y, z) of the optical frame (x right, y down, z forward) to a position (u, v), which
/// [`LensIntrinsics`] maps to a pixel.
#[derive(Debug, Clone, PartialEq)]
pub enum LensModel {
    /// Pinhole: u = x/z, v = y/z.
    Pinhole,
    /// Brown–Conrady: the pinhole's u and v, distorted.
    BrownConrady {
        /// Coefficients in OpenCV's order: k1 k2 p1 p2 k3, k4 k5 k6, s1 s2 s3 s4, τx τy; 5, 8, 12 or 14 of them.
        coefficients: Vec<f64>,
    },
    /// Kannala–Brandt, OpenCV's fisheye: the radius is θ + k1 θ³ + k2 θ⁵ + k3 θ⁷ + k4 θ⁹.
    KannalaBrandt {
        /// Coefficients k1, k2, k3, k4.
        k: [f64; 4],
    },
    /// Extended unified camera model: x and y over α·√(β·(x² + y²) + z²) + (1 − α)·z.
    Eucm {
        /// α, from 0 to 1.
        alpha: f64,
        /// β, above 0.
        beta: f64,
    },
    /// Double sphere: with w = ξ·√(x² + y² + z²) + z, x and y over α·√(x² + y² + w²) + (1 − α)·w.
    DoubleSphere {
        /// ξ, above −1, at most 1.
        xi: f64,
        /// α, from 0 to 1.
        alpha: f64,
    },
    /// Mei's unified model: x and y over z + ξ·√(x² + y² + z²), distorted as by Brown–Conrady.
    Mei {
        /// ξ, 0 or more.
        xi: f64,
        /// Radial coefficient.
        k1: f64,
        /// Radial coefficient.
        k2: f64,
        /// Tangential coefficient.
        p1: f64,
        /// Tangential coefficient.
        p2: f64,
    },
    /// Equirectangular: u = atan2(x, z), v = atan2(y, √(x² + z²)).
    Equirectangular,
    /// SDF's `<lens>`: the radius in pixels is a function of the angle θ from the axis.
    WideAngle {
        /// The function.
        map: AngleMap,
        /// True if its focal length is adjusted to the angle of view.
        scale_to_hfov: bool,
        /// Angle from the axis beyond which nothing is seen.
        cutoff_angle_rad: f64,
    },
}

/// The radius as a function of the angle: r = c1·f·fun(θ/c2 + c3).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AngleMap {
    /// Factor c1.
    pub c1: f64,
    /// Divisor c2 of the angle.
    pub c2: f64,
    /// Offset c3 of the angle, in radians.
    pub c3: f64,
    /// f in pixels. SDF's `<f>` is in halves of the image width; with `<scale_to_hfov>` it is ignored.
    pub focal_px: f64,
    /// The function fun.
    pub function: AngleFunction,
}

/// SDF's `<fun>`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AngleFunction {
    /// `sin`.
    Sine,
    /// `tan`.
    Tangent,
    /// `id`: the angle itself.
    Identity,
}

impl AngleFunction {
    /// Returns the function's value at an angle.
    pub fn at(self, angle_rad: f64) -> f64 {
        match self {
            Self::Sine => libm::sin(angle_rad),
            Self::Tangent => libm::tan(angle_rad),
            Self::Identity => angle_rad,
        }
    }

    /// Returns the function's derivative at an angle.
    pub fn slope_at(self, angle_rad: f64) -> f64 {
        match self {
            Self::Sine => libm::cos(angle_rad),
            Self::Tangent => 1.0 / (libm::cos(angle_rad) * libm::cos(angle_rad)),
            Self::Identity => 1.0,
        }
    }
}

/// Maps (u, v) to the pixel (fx·u + skew·v + cx, fy·v + cy); pixel centres are integers. For [`LensModel::WideAngle`],
/// which has its own focal length, fx and fy are the pixels per radian in the middle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LensIntrinsics {
    /// Focal length along a row.
    pub fx: f64,
    /// Focal length down a column.
    pub fy: f64,
    /// Column of the principal point.
    pub cx: f64,
    /// Row of the principal point.
    pub cy: f64,
    /// Pixels along a row per unit of v.
    pub skew: f64,
}

/// P of `CameraInfo`, in pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LensProjection {
    /// P\[0\], focal length along a row.
    pub fx: f64,
    /// P\[5\], focal length down a column.
    pub fy: f64,
    /// P\[2\], column of the principal point.
    pub cx: f64,
    /// P\[6\], row of the principal point.
    pub cy: f64,
    /// P\[3\], offset along a row.
    pub tx: f64,
    /// P\[7\], offset down a column.
    pub ty: f64,
}

impl LensModel {
    /// Returns the name in `<lens><type>` and in messages.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Pinhole => "pinhole",
            Self::BrownConrady { .. } => "Brown-Conrady",
            Self::KannalaBrandt { .. } => "kannala_brandt",
            Self::Eucm { .. } => "eucm",
            Self::DoubleSphere { .. } => "double_sphere",
            Self::Mei { .. } => "mei",
            Self::Equirectangular => "equirectangular",
            Self::WideAngle { .. } => "wide angle",
        }
    }

    /// Returns the distance from the middle, along a row, at which a direction at this angle from the axis is seen, for a focal
    /// length of 1. For [`LensModel::BrownConrady`] it is before distortion: its angle of view is that of the undistorted image.
    pub fn radius(&self, angle_rad: f64) -> f64 {
        let (x, z) = (libm::sin(angle_rad), libm::cos(angle_rad));
        match self {
            Self::Pinhole | Self::BrownConrady { .. } => libm::tan(angle_rad),
            Self::KannalaBrandt { k: [k1, k2, k3, k4] } => {
                let square = angle_rad * angle_rad;
                angle_rad * (1.0 + square * (k1 + square * (k2 + square * (k3 + square * k4))))
            }
            Self::Eucm { alpha, beta } => x / (alpha * libm::sqrt(beta * x * x + z * z) + (1.0 - alpha) * z),
            Self::DoubleSphere { xi, alpha } => {
                let w = xi + z;
                x / (alpha * libm::sqrt(x * x + w * w) + (1.0 - alpha) * w)
            }
            Self::Mei { xi, k1, k2, p2, .. } => {
                let u = x / (z + xi);
                let square = u * u;
                u * (1.0 + square * (k1 + square * k2)) + 3.0 * p2 * square
            }
            Self::Equirectangular => angle_rad,
            Self::WideAngle { map, .. } => map.c1 * map.function.at(angle_rad / map.c2 + map.c3),
        }
    }

    /// Returns the largest angle from the axis, at most π, up to which the radius increases with the angle.
    pub fn widest_rad(&self) -> f64 {
        const STEPS: u32 = 1 << 14;
        let angle = |step: u32| PI * f64::from(step) / f64::from(STEPS);
        let mut radius = self.radius(0.0);
        if radius.is_nan() || radius < 0.0 {
            return 0.0;
        }
        for step in 1..=STEPS {
            let next = self.radius(angle(step));
            // Not `<=`: NaN ends it too.
            if !(next > radius && next.is_finite()) {
                return angle(step - 1);
            }
            radius = next;
        }
        PI
    }

    /// Returns the largest full angle of view: below π for pinholes.
    pub fn widest_view_rad(&self) -> f64 {
        2.0 * self.widest_rad()
    }
}
