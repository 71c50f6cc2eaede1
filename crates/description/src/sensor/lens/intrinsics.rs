//! `<intrinsics>` and `<projection>` of a lens, in pixels, and the intrinsics that follow from an angle of view.

use super::Picture;
use crate::model::{LensIntrinsics, LensModel};
use crate::sensor::reader::Reader;
use crate::xml::Element;

impl Reader<'_> {
    /// Reads fx, fy, cx, cy and s; each is none if it is not written.
    pub(super) fn intrinsics(&mut self, intrinsics: Option<&Element>) -> Option<[Option<f64>; 5]> {
        let names = ["fx", "fy", "cx", "cy", "s"];
        let written = names.map(|name| self.intrinsic(intrinsics, name));
        if let Some(intrinsics) = intrinsics {
            self.left_out(intrinsics, |name| names.contains(&name), "intrinsics are fx, fy, cx, cy and s");
        }
        let [fx, fy, cx, cy, skew] = written;
        Some([fx?, fy?, cx?, cy?, skew?])
    }

    #[expect(clippy::option_option, reason = "outer: readable; inner: written")]
    fn intrinsic(&mut self, intrinsics: Option<&Element>, name: &str) -> Option<Option<f64>> {
        let Some(element) = intrinsics.filter(|element| element.child(name).is_some()) else {
            return Some(None);
        };
        if name.starts_with('f') {
            self.checked(
                Some(element),
                name,
                0.0,
                |focal| focal > 0.0,
                "write a focal length in pixels above 0",
            )
        } else {
            self.number(Some(element), name, 0.0)
        }
        .map(Some)
    }

    #[expect(clippy::option_option, reason = "outer: readable; inner: written")]
    pub(super) fn projection(&mut self, lens: Option<&Element>) -> Option<Option<[Option<f64>; 6]>> {
        let Some(element) = lens.and_then(|lens| lens.child("projection")) else { return Some(None) };
        let names = ["p_fx", "p_fy", "p_cx", "p_cy", "tx", "ty"];
        let remedy = "a projection is p_fx, p_fy, p_cx, p_cy, tx and ty";
        self.left_out(element, |name| names.contains(&name), remedy);
        let values = names.map(|name| match element.child(name) {
            None => Some(None),
            Some(_) if name.starts_with("p_f") => {
                let remedy = "write a focal length in pixels above 0";
                self.checked(Some(element), name, 0.0, |focal| focal > 0.0, remedy).map(Some)
            }
            Some(_) => self.number(Some(element), name, 0.0).map(Some),
        });
        let [fx, fy, cx, cy, tx, ty] = values;
        Some(Some([fx?, fy?, cx?, cy?, tx?, ty?]))
    }
}

/// Returns the intrinsics that follow from the angle of view. Sets the focal length of a wide-angle lens.
pub(super) fn intrinsics_of(model: &mut LensModel, fov: f64, picture: &Picture) -> LensIntrinsics {
    let middle = |size: u32| 0.5 * (f64::from(size) - 1.0);
    // The same formula as for a pinhole without distortion, for identical bits.
    let mut focal_px = f64::from(picture.width) / (2.0 * model.radius(0.5 * fov));
    if let LensModel::WideAngle { map, scale_to_hfov, .. } = model {
        map.focal_px = if *scale_to_hfov { focal_px } else { map.focal_px * 0.5 * f64::from(picture.width) };
        focal_px = map.c1 * map.focal_px * map.function.slope_at(map.c3) / map.c2;
    }
    LensIntrinsics {
        fx: focal_px,
        fy: focal_px,
        cx: middle(picture.width),
        cy: middle(picture.height),
        skew: 0.0,
    }
}

/// Converts a <center>, in shares of the image, to pixels.
pub(super) fn principal_point([x, y]: [f64; 2], picture: &Picture) -> [f64; 2] {
    [x * f64::from(picture.width) - 0.5, y * f64::from(picture.height) - 0.5]
}
