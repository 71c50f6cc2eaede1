//! SDF's wide-angle lenses: r = c1·f·fun(θ/c2 + c3).

use super::error::{require, require_finite};
use super::lens::{at_angle, length, unit};
use super::{Intrinsics, LARGEST_TANGENT, Lens};
use crate::ParameterError;
use core::f64::consts::{FRAC_PI_2, PI};
use glam::{DVec2, DVec3};

/// The function of a [`Mapping`], SDF's `<fun>`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AngleFunction {
    /// `id`: the angle itself.
    Identity,
    /// `sin`, up to π/2.
    Sin,
    /// `tan`, up to π/2.
    Tan,
}

/// The mapping from the angle θ from the axis to the image radius: r = c1·f·fun(θ/c2 + c3).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mapping {
    /// `<c1>`; c1·f must be greater than 0.
    pub c1: f64,
    /// `<c2>`, greater than 0.
    pub c2: f64,
    /// `<c3>`, an angle in radians.
    pub c3: f64,
    /// `<f>`, the focal length in units of the plane; SDF's unit is half the width of the image.
    pub f: f64,
    /// `<fun>`, the function.
    pub fun: AngleFunction,
}

impl Mapping {
    /// r = tan θ, a pinhole.
    pub const GNOMONICAL: Self = Self { c1: 1.0, c2: 1.0, c3: 0.0, f: 1.0, fun: AngleFunction::Tan };
    /// r = 2 tan(θ/2), which preserves the shapes of small objects.
    pub const STEREOGRAPHIC: Self = Self { c1: 2.0, c2: 2.0, c3: 0.0, f: 1.0, fun: AngleFunction::Tan };
    /// r = θ.
    pub const EQUIDISTANT: Self = Self { c1: 1.0, c2: 1.0, c3: 0.0, f: 1.0, fun: AngleFunction::Identity };
    /// r = 2 sin(θ/2), which preserves areas.
    pub const EQUISOLID_ANGLE: Self = Self { c1: 2.0, c2: 2.0, c3: 0.0, f: 1.0, fun: AngleFunction::Sin };
    /// r = sin θ, up to 90°.
    pub const ORTHOGRAPHIC: Self = Self { c1: 1.0, c2: 1.0, c3: 0.0, f: 1.0, fun: AngleFunction::Sin };

    /// Returns the mapping with SDF's name of a lens `<type>`, or `None` if there is none: `custom` has no parameters
    /// of its own.
    pub fn named(name: &str) -> Option<Self> {
        Some(match name {
            "gnomonical" => Self::GNOMONICAL,
            "stereographic" => Self::STEREOGRAPHIC,
            "equidistant" => Self::EQUIDISTANT,
            "equisolid_angle" => Self::EQUISOLID_ANGLE,
            "orthographic" => Self::ORTHOGRAPHIC,
            _ => return None,
        })
    }

    fn check(&self) -> Result<(), ParameterError> {
        for (name, value) in [("c1", self.c1), ("f", self.f)] {
            require_finite(name, value)?;
        }
        let scale = self.c1 * self.f;
        require("c1*f", scale, scale > 0.0 && scale.is_finite(), "a finite number greater than 0")?;
        require("c2", self.c2, self.c2 > 0.0 && self.c2.is_finite(), "a finite number greater than 0")?;
        // The axis or a ring around it must be visible; from the end of the function on, nothing would be.
        require(
            "c3",
            self.c3,
            self.c3.is_finite() && self.c3 < self.last_argument(),
            match self.fun {
                AngleFunction::Identity => "a finite number",
                AngleFunction::Sin | AngleFunction::Tan => "a finite number less than π/2",
            },
        )
    }

    /// The greatest argument up to which `fun` increases and is distinguishable from infinity.
    fn last_argument(&self) -> f64 {
        match self.fun {
            AngleFunction::Identity => f64::INFINITY,
            AngleFunction::Sin => FRAC_PI_2,
            AngleFunction::Tan => libm::atan(LARGEST_TANGENT),
        }
    }

    /// The image radius r at an angle.
    fn radius(&self, angle: f64) -> f64 {
        let argument = angle / self.c2 + self.c3;
        self.c1
            * self.f
            * match self.fun {
                AngleFunction::Identity => argument,
                AngleFunction::Sin => libm::sin(argument),
                AngleFunction::Tan => libm::tan(argument),
            }
    }

    /// The angle of an image radius, or NaN if there is none.
    fn angle(&self, radius: f64) -> f64 {
        let value = radius / (self.c1 * self.f);
        let argument = match self.fun {
            AngleFunction::Identity => value,
            AngleFunction::Sin => libm::asin(value),
            AngleFunction::Tan => libm::atan(value),
        };
        (argument - self.c3) * self.c2
    }
}

/// A lens defined by a [`Mapping`], with a cutoff angle beyond which it sees nothing.
///
/// The domain contains the angles up to [`max_angle`](WideAngle::max_angle), the smaller of the cutoff angle and the
/// angle at which the mapping stops increasing. With c3 ≠ 0 it excludes a region around the axis: r begins at
/// c1·f·fun(c3), or at 0 with the angle −c2·c3. Gazebo darkens pixels beyond the cutoff angle to a fifth; here such
/// pixels have no ray.
///
/// (SDFormat, `<camera><lens>`.)
///
/// ```
/// use belvedere_sensors::optics::{Lens, Mapping, WideAngle};
/// use belvedere_sensors::glam::{DVec2, DVec3};
/// use std::f64::consts::{FRAC_PI_2, PI};
/// // 180° across 800 px: the half, 400 px, is 90°.
/// let lens = WideAngle::from_fov(800, 600, PI, Mapping::STEREOGRAPHIC, true, FRAC_PI_2).unwrap();
/// let pixel = lens.project(DVec3::new(1.0, 0.0, 1.0)).unwrap();
/// // tan(45°/2)/tan(90°/2) = 0.414214.
/// assert!(pixel.distance(DVec2::new(399.5 + 400.0 * 0.414_213_562_4, 299.5)) < 1e-6);
/// // The corners are beyond 90°.
/// assert_eq!(lens.unproject(DVec2::ZERO), None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WideAngle {
    intrinsics: Intrinsics,
    mapping: Mapping,
    /// First and last angle of the domain.
    angles: [f64; 2],
}

impl WideAngle {
    /// Creates a lens from its intrinsic parameters, which convert the mapping's r to pixels, and its cutoff angle in
    /// radians, greater than 0 and at most π.
    ///
    /// # Errors
    /// If a parameter is out of range.
    pub fn new(intrinsics: Intrinsics, mapping: Mapping, cutoff_angle: f64) -> Result<Self, ParameterError> {
        intrinsics.check()?;
        mapping.check()?;
        let inside = cutoff_angle > 0.0 && cutoff_angle <= PI;
        require("cutoff_angle", cutoff_angle, inside, "greater than 0 and at most π")?;
        let first = (-mapping.c3 * mapping.c2).max(0.0);
        let last = ((mapping.last_argument() - mapping.c3) * mapping.c2).min(cutoff_angle);
        Ok(Self { intrinsics, mapping, angles: [first, last] })
    }

    /// Creates a lens as SDF describes it: r = 1 is half the width of the image. With `scale_to_hfov`, f is replaced by
    /// the value for which half the width corresponds to half the field of view (in radians).
    ///
    /// # Errors
    /// If a parameter is out of range, or if the mapping does not reach that field of view.
    pub fn from_fov(
        width: u32,
        height: u32,
        horizontal_fov_rad: f64,
        mut mapping: Mapping,
        scale_to_hfov: bool,
        cutoff_angle: f64,
    ) -> Result<Self, ParameterError> {
        if scale_to_hfov {
            // Any positive c1·f will do, since f is replaced.
            mapping.f = mapping.c1.signum();
            mapping.check()?;
            let half = horizontal_fov_rad * 0.5;
            let radius = mapping.radius(half);
            let reached =
                half > 0.0 && half <= PI && half / mapping.c2 + mapping.c3 <= mapping.last_argument();
            require(
                "horizontal_fov_rad",
                horizontal_fov_rad,
                reached && radius > 0.0,
                "greater than 0, at most 2π, and within what the lens' mapping function reaches",
            )?;
            mapping.f /= radius;
        }
        Self::new(Intrinsics::centred(width, height, f64::from(width) * 0.5)?, mapping, cutoff_angle)
    }

    /// The intrinsic parameters.
    pub fn intrinsics(&self) -> Intrinsics {
        self.intrinsics
    }

    /// The mapping, with f as it is after `scale_to_hfov`.
    pub fn mapping(&self) -> Mapping {
        self.mapping
    }

    /// The end of the domain: the greatest angle from the axis in radians.
    pub fn max_angle(&self) -> f64 {
        self.angles[1]
    }

    fn sees(&self, angle: f64) -> bool {
        angle >= self.angles[0] && angle <= self.angles[1]
    }
}

impl Lens for WideAngle {
    fn project(&self, point_in_optical: DVec3) -> Option<DVec2> {
        let direction = unit(point_in_optical)?;
        let from_axis = length(direction.truncate());
        let angle = libm::atan2(from_axis, direction.z);
        if !self.sees(angle) {
            return None;
        }
        let radius = self.mapping.radius(angle);
        if from_axis == 0.0 {
            // On the axis there is a single pixel, or a circle.
            return if radius == 0.0 { self.intrinsics.to_pixel(DVec2::ZERO) } else { None };
        }
        self.intrinsics.to_pixel(direction.truncate() * (radius / from_axis))
    }

    fn unproject(&self, pixel: DVec2) -> Option<DVec3> {
        let plane = self.intrinsics.to_plane(pixel)?;
        let radius = length(plane);
        let angle = self.mapping.angle(radius);
        self.sees(angle).then(|| at_angle(angle, plane, radius))
    }
}
