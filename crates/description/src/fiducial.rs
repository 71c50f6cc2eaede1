//! `<fiducial>` of a `<visual>`, our extension: a tag on the visual, for which the simulator can publish where its corners
//! are seen.

use super::diagnostics::Diagnostics;
use super::model::Fiducial;
use super::values::{child_number, child_pose, child_text};
use super::xml::Element;

/// The elements of a fiducial.
const CHILDREN: [&str; 4] = ["family", "id", "size", "pose"];
/// Longest name of a family in bytes: a message has room for no more.
const LONGEST_FAMILY: usize = 31;

/// Reads the fiducials of a visual; an invalid one is left out, with an error.
pub(super) fn fiducials(visual: &Element, diagnostics: &mut Diagnostics) -> Vec<Fiducial> {
    visual.elements_named("fiducial").filter_map(|element| fiducial(element, diagnostics)).collect()
}

fn fiducial(element: &Element, diagnostics: &mut Diagnostics) -> Option<Fiducial> {
    for child in element.elements().filter(|child| !CHILDREN.contains(&child.name.as_str())) {
        let what = format!("<{}> of a <fiducial> is left out", child.name);
        let remedy = format!("remove it: a fiducial has {}", CHILDREN.join(", "));
        diagnostics.warning(&child.source, what, remedy);
    }
    let mut missing = |name: &str, remedy: &str| {
        if element.child(name).is_none() {
            diagnostics.error(&element.source, format!("a <fiducial> has no <{name}>"), remedy);
        }
    };
    missing("family", "write <family>tag36h11</family>, or the name of its family");
    missing("id", "write <id>7</id>: its number in the family");
    missing("size", "write <size>0.16</size>: the edge of its square in metres, without the white margin");
    let family = family(element, diagnostics);
    let id = child_number(element, "id", diagnostics).filter(|&id| {
        let is_valid = id.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&id);
        check(is_valid, element, "id", id, "write a whole number from 0 to 4294967295", diagnostics)
    });
    let size_m = child_number(element, "size", diagnostics)
        .filter(|&size| check(size > 0.0, element, "size", size, "write metres above 0", diagnostics));
    if let Some(pose) = element.child("pose")
        && !pose.attributes.is_empty()
    {
        let what = "<pose> of a <fiducial> has attributes";
        diagnostics.error(&pose.source, what, "write x y z roll pitch yaw in the visual's frame, in radians");
    }
    if let (Some(family), Some(id)) = (&family, id) {
        warn_of_unknown(element, family, id, diagnostics);
    }
    let visual_from_fiducial = child_pose(element, false, diagnostics);
    Some(Fiducial { family: family?, id: id? as u32, size_m: size_m?, visual_from_fiducial })
}

fn family(element: &Element, diagnostics: &mut Diagnostics) -> Option<String> {
    let child = element.child("family")?;
    let family = child_text(element, "family").unwrap_or_default();
    if (1..=LONGEST_FAMILY).contains(&family.len()) {
        return Some(family);
    }
    let remedy = format!("write a name of 1 to {LONGEST_FAMILY} bytes, such as tag36h11 or qr");
    diagnostics.error(&child.source, format!("<family> of a <fiducial> is '{family}'"), remedy);
    None
}

/// Families of `AprilTag` and the number of tags in each.
const APRIL_TAGS: [(&str, u32); 9] = [
    ("tag16h5", 30),
    ("tag25h9", 35),
    ("tag36h10", 2320),
    ("tag36h11", 587),
    ("tagCircle21h7", 38),
    ("tagCircle49h12", 65535),
    ("tagCustom48h12", 42211),
    ("tagStandard41h12", 2115),
    ("tagStandard52h13", 48714),
];

/// Adds a warning for a tag that no detector knows. Families other than `AprilTag`'s are accepted as they are.
fn warn_of_unknown(element: &Element, family: &str, id: f64, diagnostics: &mut Diagnostics) {
    let place = |name: &str| element.child(name).map_or(&element.source, |child| &child.source);
    match APRIL_TAGS.iter().find(|(known, _)| *known == family) {
        Some((_, count)) if id >= f64::from(*count) => {
            let what = format!("<id> of a <fiducial> is {id}, and {family} has {count} tags");
            diagnostics.warning(place("id"), what, format!("write a number from 0 to {}", count - 1));
        }
        None if family.starts_with("tag") => {
            let what = format!("<family> of a <fiducial> is '{family}', which is not one of AprilTag's");
            let known = APRIL_TAGS.map(|(name, _)| name).join(", ");
            diagnostics.warning(place("family"), what, format!("these are: {known}"));
        }
        _ => {}
    }
}

/// Returns true if a value is valid, and adds an error otherwise.
fn check(
    is_valid: bool,
    element: &Element,
    name: &str,
    value: f64,
    remedy: &str,
    diagnostics: &mut Diagnostics,
) -> bool {
    if !is_valid {
        let source = element.child(name).map_or(&element.source, |child| &child.source);
        diagnostics.error(source, format!("<{name}> of a <fiducial> is {value}"), remedy);
    }
    is_valid
}
