//! `<optics>` of a `<visual>` or `<collision>`, our extension: the shares of the light of lidars and depth cameras that a mirror
//! reflects and a pane transmits.

use super::diagnostics::Diagnostics;
use super::model::Optics;
use super::values::child_number;
use super::xml::Element;

/// The elements of `<optics>`.
const CHILDREN: [&str; 2] = ["specular_reflectance", "transmittance"];

/// Reads the optics of an element; none if it has none, or if they are invalid, which is an error.
pub(super) fn optics(element: &Element, diagnostics: &mut Diagnostics) -> Option<Optics> {
    let optics = element.child("optics")?;
    for child in optics.elements().filter(|child| !CHILDREN.contains(&child.name.as_str())) {
        let what = format!("<{}> of an <optics> is left out", child.name);
        let remedy = format!("remove it: an optics has {}", CHILDREN.join(", "));
        diagnostics.warning(&child.source, what, remedy);
    }
    let shares = CHILDREN.map(|name| child_number(optics, name, diagnostics).unwrap_or(0.0));
    for (share, name) in shares.into_iter().zip(CHILDREN) {
        if !(0.0..=1.0).contains(&share) {
            let source = optics.child(name).map_or(&optics.source, |child| &child.source);
            let what = format!("<{name}> of an <optics> is {share}");
            diagnostics.error(source, what, "write a share of the light, 0 to 1");
            return None;
        }
    }
    let sum = shares[0] + shares[1];
    if sum > 1.0 + 1e-6 {
        diagnostics.error(
            &optics.source,
            format!(
                "an <optics> reflects {} of the light and transmits {}, more than 1 in total",
                shares[0], shares[1]
            ),
            "write shares with a sum of at most 1",
        );
        return None;
    }
    let [specular_reflectance, transmittance] = shares.map(|share| share as f32);
    Some(Optics { specular_reflectance, transmittance })
}
