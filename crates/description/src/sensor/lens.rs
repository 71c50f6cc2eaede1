//! `<lens>` and `<distortion>` of a `<camera>`; docs/lenses.md describes the elements.

mod angle_map;
mod intrinsics;

use super::reader::Reader;
use crate::diagnostics::Source;
use crate::model::{Lens, LensModel, LensProjection};
use crate::values::{child_text, numbers};
use crate::xml::Element;
use intrinsics::{intrinsics_of, principal_point};
use std::f64::consts::{FRAC_PI_2, PI};

/// Tolerance by which an angle of view may exceed the lens's limit, for a rounded π: SDF allows 6.283186.
const ROUNDED_ANGLE_RAD: f64 = 1e-5;
/// Relative difference up to which two given focal lengths agree: angles are written with few digits.
const CONTRADICTION: f64 = 0.01;
/// Coefficients of `<distortion>` in OpenCV's order.
const COEFFICIENTS: [&str; 14] =
    ["k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6", "s1", "s2", "s3", "s4", "tau_x", "tau_y"];
const COEFFICIENT_COUNTS: [usize; 4] = [5, 8, 12, 14];
/// The types of `<lens>`: SDF's own, then ours.
const TYPES: [&str; 11] = [
    "gnomonical",
    "stereographic",
    "equidistant",
    "equisolid_angle",
    "orthographic",
    "custom",
    "kannala_brandt",
    "eucm",
    "double_sphere",
    "mei",
    "equirectangular",
];
/// Elements that every `<lens>` may have.
const COMMON: [&str; 4] = ["type", "intrinsics", "projection", "env_texture_size"];
/// Additional elements of SDF's own types.
const OF_ANGLE_MAPS: [&str; 3] = ["scale_to_hfov", "cutoff_angle", "custom_function"];

/// The properties of the camera that a lens depends on.
pub(super) struct Picture {
    pub(super) width: u32,
    pub(super) height: u32,
    /// True for SDF's wide-angle camera, false for all other cameras.
    pub(super) is_wide_angle: bool,
}

impl Reader<'_> {
    /// Reads the lens of a camera, and its horizontal angle of view.
    pub(super) fn lens(&mut self, camera: Option<&Element>, picture: &Picture) -> Option<(Lens, f64)> {
        let element = camera.and_then(|camera| camera.child("lens"));
        let distortion = camera.and_then(|camera| camera.child("distortion"));
        let coefficients = self.coefficients(distortion);
        let center = self.center(distortion);
        let model = self.model(element, picture);
        let intrinsics = element.and_then(|element| element.child("intrinsics"));
        let (mut model, mut coefficients, mut center) = (model?, coefficients?, center?);

        if let (LensModel::WideAngle { .. }, Some(distortion)) = (&model, distortion)
            && coefficients.iter().any(|&value| value != 0.0)
        {
            // Gazebo reads only one of the two, depending on the type of the camera.
            let kind = lens_type(element, &model);
            let what =
                format!("<distortion> of sensor '{}' is left out beside a lens of type {kind}", self.sensor);
            self.diagnostics.warning(&distortion.source, what, "remove one of them");
            (coefficients, center) = (Vec::new(), None);
        }
        let is_distorted = coefficients.iter().any(|&value| value != 0.0);
        if let (true, Some(distortion)) = (is_distorted, distortion) {
            if model != LensModel::Pinhole {
                let what = format!(
                    "sensor '{}' has a <distortion>, which is a pinhole's, and a lens of type {}",
                    self.sensor,
                    lens_type(element, &model)
                );
                self.diagnostics.error(
                    &distortion.source,
                    what,
                    "remove one of them, or write <type>gnomonical</type>",
                );
                return None;
            }
            model = LensModel::BrownConrady { coefficients };
        }

        let fov = self.angle_of_view(camera, element, &model);
        let written = self.intrinsics(intrinsics);
        let projection = self.projection(element);
        let ([fx, fy, cx, cy, skew], fov) = (written?, fov?);

        let mut resolved = intrinsics_of(&mut model, fov, picture);
        if let Some(center) = center {
            let place = Self::place(distortion, "center", distortion?);
            if self.takes_center(place, is_distorted, cx.is_some() || cy.is_some()) {
                [resolved.cx, resolved.cy] = principal_point(center, picture);
            }
        }
        let fov_element = camera.and_then(|camera| camera.child("horizontal_fov"));
        if let (Some(element), Some(focal)) = (fov_element, fx)
            && !matches!(model, LensModel::WideAngle { .. })
            && (focal / resolved.fx - 1.0).abs() > CONTRADICTION
        {
            let what = format!(
                "{} is left out: it would be a focal length of {:.1} pixels, and <fx> is {focal}",
                self.what("horizontal_fov"),
                resolved.fx
            );
            self.diagnostics.warning(&element.source, what, "remove one of them");
        }
        if let (LensModel::WideAngle { .. }, Some(intrinsics)) = (&model, intrinsics) {
            self.diagnostics.warning(
                &intrinsics.source,
                format!(
                    "{} is left out: SDF has it for perspective cameras, and the lens is of type {}",
                    self.what("intrinsics"),
                    lens_type(element, &model)
                ),
                "write <horizontal_fov>, or a <type> that has intrinsics",
            );
        } else {
            resolved.fx = fx.unwrap_or(resolved.fx);
            resolved.fy = fy.or(fx).unwrap_or(resolved.fy);
            resolved.cx = cx.unwrap_or(resolved.cx);
            resolved.cy = cy.unwrap_or(resolved.cy);
            resolved.skew = skew.unwrap_or(0.0);
        }
        let has_own_focal_length = fx.is_some() && !matches!(model, LensModel::WideAngle { .. });
        let fov = match model {
            LensModel::Pinhole | LensModel::BrownConrady { .. } if has_own_focal_length => {
                2.0 * libm::atan(0.5 * f64::from(picture.width) / resolved.fx)
            }
            _ => fov,
        };
        let projection = projection?.map(|[fx, fy, cx, cy, tx, ty]| LensProjection {
            fx: fx.unwrap_or(resolved.fx),
            fy: fy.unwrap_or(resolved.fy),
            cx: cx.unwrap_or(resolved.cx),
            cy: cy.unwrap_or(resolved.cy),
            tx: tx.unwrap_or(0.0),
            ty: ty.unwrap_or(0.0),
        });
        Some((Lens { model, intrinsics: resolved, has_own_focal_length, projection }, fov))
    }

    /// Returns true if the <center> of the <distortion> is the principal point, and warns otherwise.
    fn takes_center(&mut self, place: &Source, is_distorted: bool, has_own: bool) -> bool {
        let (what, remedy) = if !is_distorted {
            (
                format!("{} has no effect: all coefficients are 0", self.what("center")),
                "write <cx> and <cy> in <lens><intrinsics> for a principal point",
            )
        } else if has_own {
            (
                format!("{} is left out: <intrinsics> gives a principal point", self.what("center")),
                "remove it",
            )
        } else {
            return true;
        };
        self.diagnostics.warning(place, what, remedy);
        false
    }

    /// Reads the coefficients: as many as the longest model has that uses one of the given ones.
    fn coefficients(&mut self, distortion: Option<&Element>) -> Option<Vec<f64>> {
        let written = |name: &&str| distortion.is_some_and(|distortion| distortion.child(name).is_some());
        let last = COEFFICIENTS.iter().rposition(written).map_or(0, |index| index + 1);
        let count = COEFFICIENT_COUNTS.into_iter().find(|&count| count >= last)?;
        let values: Vec<_> = COEFFICIENTS[..count]
            .iter()
            .map(|&name| {
                if name.starts_with("tau") {
                    let remedy = "write an angle in radians, above -1.5708 and below 1.5708";
                    self.checked(distortion, name, 0.0, |tilt| tilt.abs() < FRAC_PI_2, remedy)
                } else {
                    self.number(distortion, name, 0.0)
                }
            })
            .collect();
        if let Some(distortion) = distortion {
            self.left_out(distortion, |name| name == "center" || COEFFICIENTS.contains(&name), "remove it");
        }
        values.into_iter().collect()
    }

    /// Reads `<center>` in fractions of the image; the inner none means the middle.
    #[expect(clippy::option_option, reason = "outer: readable; inner: written")]
    fn center(&mut self, distortion: Option<&Element>) -> Option<Option<[f64; 2]>> {
        let Some(child) = distortion.and_then(|distortion| distortion.child("center")) else {
            return Some(None);
        };
        let what = self.what("center");
        let center = numbers::<2>(&child.text(), &what, &child.source, self.diagnostics)?;
        if center.iter().any(|part| !(0.0..=1.0).contains(part)) {
            self.diagnostics.error(
                &child.source,
                format!("{what} is {} {}", center[0], center[1]),
                "write two fractions of the picture's width and height, from 0 to 1",
            );
            return None;
        }
        Some((center != [0.5; 2]).then_some(center))
    }

    fn model(&mut self, lens: Option<&Element>, picture: &Picture) -> Option<LensModel> {
        let kind = lens.and_then(|lens| child_text(lens, "type"));
        let default = if picture.is_wide_angle { "stereographic" } else { "gnomonical" };
        let kind = kind.as_deref().unwrap_or(default);
        if let Some(lens) = lens.filter(|lens| self.is_pinhole_after_all(lens, kind, picture)) {
            let what = format!(
                "the <type> {kind} of sensor '{}' is left out: in Gazebo it is for wide-angle cameras",
                self.sensor
            );
            let remedy = "write <type>gnomonical</type>, or make the sensor a wideanglecamera";
            self.diagnostics.warning(&lens.source, what, remedy);
            return Some(LensModel::Pinhole);
        }
        let own: &[&str] = match kind {
            "kannala_brandt" => &["k1", "k2", "k3", "k4"],
            "eucm" => &["alpha", "beta"],
            "double_sphere" => &["xi", "alpha"],
            "mei" => &["xi", "k1", "k2", "p1", "p2"],
            "equirectangular" => &[],
            "custom" => &OF_ANGLE_MAPS,
            "gnomonical" if !picture.is_wide_angle => &[],
            _ => &OF_ANGLE_MAPS[..2],
        };
        if let Some(lens) = lens {
            if TYPES.contains(&kind) {
                let remedy = format!(
                    "a lens of type {kind} has {}",
                    if own.is_empty() { "no parameters".into() } else { own.join(", ") }
                );
                self.left_out(lens, |name| COMMON.contains(&name) || own.contains(&name), &remedy);
            }
            if let Some(size) = lens.child("env_texture_size") {
                let what = format!("{} is not needed: each pixel is traced", self.what("env_texture_size"));
                self.diagnostics.warning(&size.source, what, "remove it");
            }
        }
        let mut number = |name| self.number(lens, name, 0.0);
        match kind {
            "gnomonical" if !picture.is_wide_angle => Some(LensModel::Pinhole),
            "kannala_brandt" => {
                let [k1, k2, k3, k4] = ["k1", "k2", "k3", "k4"].map(number);
                Some(LensModel::KannalaBrandt { k: [k1?, k2?, k3?, k4?] })
            }
            "eucm" => {
                let alpha = self.alpha(lens?);
                let beta = self.needed(lens?, "beta", |beta| beta > 0.0, "write a number above 0");
                Some(LensModel::Eucm { alpha: alpha?, beta: beta? })
            }
            "double_sphere" => {
                let is_valid = |xi: f64| xi > -1.0 && xi <= 1.0;
                let xi = self.needed(lens?, "xi", is_valid, "write a number above -1, at most 1");
                let alpha = self.alpha(lens?);
                Some(LensModel::DoubleSphere { xi: xi?, alpha: alpha? })
            }
            "mei" => {
                let [k1, k2, p1, p2] = ["k1", "k2", "p1", "p2"].map(&mut number);
                let xi = self.needed(lens?, "xi", |xi| xi >= 0.0, "write 0 or more");
                Some(LensModel::Mei { xi: xi?, k1: k1?, k2: k2?, p1: p1?, p2: p2? })
            }
            "equirectangular" => Some(LensModel::Equirectangular),
            _ => self.angle_map(lens, kind),
        }
    }

    /// Returns true if a pinhole is meant despite the lens type. Gazebo reads SDF's types only in wide-angle cameras, and
    /// many of its files have one wherever there is a `<lens>`. `<intrinsics>` mean a pinhole.
    fn is_pinhole_after_all(&self, lens: &Element, kind: &str, picture: &Picture) -> bool {
        let of_sdf = ["stereographic", "equidistant", "equisolid_angle", "orthographic", "custom"];
        let is_meant = self.rules.gazebo_compat || lens.child("intrinsics").is_some();
        !picture.is_wide_angle && is_meant && of_sdf.contains(&kind)
    }

    fn alpha(&mut self, lens: &Element) -> Option<f64> {
        let is_share = |alpha: f64| (0.0..=1.0).contains(&alpha);
        self.needed(lens, "alpha", is_share, "write a number from 0 to 1")
    }

    /// Reads a parameter that has no default.
    fn needed(
        &mut self,
        lens: &Element,
        name: &str,
        is_valid: impl Fn(f64) -> bool,
        remedy: &str,
    ) -> Option<f64> {
        if lens.child(name).is_none() {
            self.diagnostics.error(&lens.source, format!("{} is missing", self.what(name)), remedy);
            return None;
        }
        self.checked(Some(lens), name, 0.0, is_valid, remedy)
    }

    /// Reads the full horizontal angle of view, up to the limit of the lens.
    fn angle_of_view(
        &mut self,
        camera: Option<&Element>,
        lens: Option<&Element>,
        model: &LensModel,
    ) -> Option<f64> {
        let widest = match model {
            // A lens that is not scaled to the angle may have any.
            LensModel::WideAngle { scale_to_hfov: false, .. } => 2.0 * PI,
            _ => model.widest_view_rad(),
        };
        let is_pinhole = matches!(model, LensModel::Pinhole | LensModel::BrownConrady { .. });
        let is_valid = |angle: f64| {
            angle > 0.0 && if is_pinhole { angle < widest } else { angle <= widest + ROUNDED_ANGLE_RAD }
        };
        let remedy = if is_pinhole {
            "write the full angle in radians, above 0 and below 3.14159".into()
        } else {
            format!(
                "write the full angle in radians, above 0 and at most {widest:.5}: a lens of type {} has no more",
                lens_type(lens, model)
            )
        };
        let default = 1.047;
        if !is_valid(default) && camera.is_none_or(|camera| camera.child("horizontal_fov").is_none()) {
            let what =
                format!("the lens of sensor '{}' does not reach its default angle of view", self.sensor);
            self.diagnostics.error(&lens?.source, what, remedy);
            return None;
        }
        self.checked(camera, "horizontal_fov", default, is_valid, &remedy).map(|angle| angle.min(widest))
    }
}

/// Returns the name of the type as the file writes it.
fn lens_type(lens: Option<&Element>, model: &LensModel) -> String {
    lens.and_then(|lens| child_text(lens, "type")).unwrap_or_else(|| match model {
        LensModel::WideAngle { .. } => "stereographic".into(),
        _ => model.name().into(),
    })
}
