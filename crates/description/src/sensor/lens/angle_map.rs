//! SDF's own types of lenses: r = c₁·f·fun(θ/c₂ + c₃).

use super::{ROUNDED_ANGLE_RAD, TYPES};
use crate::model::{AngleFunction, AngleMap, LensModel};
use crate::sensor::reader::Reader;
use crate::suggestion::did_you_mean_or;
use crate::values::{child_bool, child_text};
use crate::xml::Element;
use std::f64::consts::PI;

/// SDF's default of `<cutoff_angle>`.
#[expect(clippy::approx_constant, reason = "SDF's own digits")]
const CUTOFF_ANGLE_RAD: f64 = 1.5707;

impl Reader<'_> {
    /// Reads one of SDF's own types.
    pub(super) fn angle_map(&mut self, lens: Option<&Element>, kind: &str) -> Option<LensModel> {
        let scale_to_hfov = match lens {
            Some(lens) if lens.child("scale_to_hfov").is_some() => {
                child_bool(lens, "scale_to_hfov", self.diagnostics)
            }
            _ => Some(true),
        };
        let remedy = "write an angle in radians, above 0 and at most 3.14159";
        let is_angle = |angle: f64| angle > 0.0 && angle <= PI + ROUNDED_ANGLE_RAD;
        let cutoff = self.checked(lens, "cutoff_angle", CUTOFF_ANGLE_RAD, is_angle, remedy);
        let map = |c1, c2, function| Some(AngleMap { c1, c2, c3: 0.0, focal_px: 1.0, function });
        let map = match kind {
            "gnomonical" => map(1.0, 1.0, AngleFunction::Tangent),
            "stereographic" => map(2.0, 2.0, AngleFunction::Tangent),
            "equidistant" => map(1.0, 1.0, AngleFunction::Identity),
            "equisolid_angle" => map(2.0, 2.0, AngleFunction::Sine),
            "orthographic" => map(1.0, 1.0, AngleFunction::Sine),
            "custom" => self.custom_function(lens?),
            _ => {
                let place = Self::place(lens, "type", lens?);
                self.diagnostics.error(
                    place,
                    format!("the lens of sensor '{}' is of type '{kind}'", self.sensor),
                    did_you_mean_or(kind, TYPES, &format!("choose from {}", TYPES.join(", "))),
                );
                None
            }
        };
        Some(LensModel::WideAngle {
            map: map?,
            scale_to_hfov: scale_to_hfov?,
            cutoff_angle_rad: cutoff?.min(PI),
        })
    }

    fn custom_function(&mut self, lens: &Element) -> Option<AngleMap> {
        let Some(element) = lens.child("custom_function") else {
            self.diagnostics.error(
                &lens.source,
                format!(
                    "the lens of sensor '{}' is of type custom and has no <custom_function>",
                    self.sensor
                ),
                "write <custom_function> with c1, c2, c3, f and fun",
            );
            return None;
        };
        let names = ["c1", "c2", "c3", "f", "fun"];
        self.left_out(element, |name| names.contains(&name), "a custom function has c1, c2, c3, f and fun");
        let element = Some(element);
        let above_zero = |value: f64| value > 0.0;
        let c1 = self.checked(element, "c1", 1.0, above_zero, "write a number above 0");
        let c2 = self.checked(element, "c2", 1.0, above_zero, "write a number above 0");
        let c3 = self.number(element, "c3", 0.0);
        let focal = self.checked(element, "f", 1.0, above_zero, "write a number above 0");
        let text = element.and_then(|element| child_text(element, "fun")).unwrap_or_else(|| "tan".into());
        let function = match text.as_str() {
            "sin" => Some(AngleFunction::Sine),
            "tan" => Some(AngleFunction::Tangent),
            "id" => Some(AngleFunction::Identity),
            _ => {
                let place = Self::place(element, "fun", lens);
                self.diagnostics.error(
                    place,
                    format!("{} is '{text}'", self.what("fun")),
                    "write sin, tan or id",
                );
                None
            }
        };
        Some(AngleMap { c1: c1?, c2: c2?, c3: c3?, focal_px: focal?, function: function? })
    }
}
