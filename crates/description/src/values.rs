//! Parsing of numbers, vectors and poses in XML text, with one clear error for each invalid value.

use super::diagnostics::{Diagnostics, Source};
use super::xml::Element;
use belvedere_sensors::Pose;
use glam::{DQuat, DVec3};
use std::str::FromStr;

/// A limit of a joint at or beyond this value means no limit (SDF's default is 1e16).
pub const NO_LIMIT: f64 = 1e15;

/// Parses `text` into N finite numbers separated by white space. `what` names the value in the error, for
/// example `<pose>` or `attribute 'xyz' of <origin>`.
pub fn numbers<const N: usize>(
    text: &str,
    what: &str,
    source: &Source,
    diagnostics: &mut Diagnostics,
) -> Option<[f64; N]> {
    let remedy = || {
        if N == 1 {
            "write one finite number".into()
        } else {
            format!("write {N} finite numbers separated by spaces")
        }
    };
    let mut values = [0.0; N];
    let mut words = text.split_whitespace();
    for value in &mut values {
        let Some(word) = words.next() else {
            diagnostics.error(source, format!("{what} is '{}': too few numbers", text.trim()), remedy());
            return None;
        };
        match f64::from_str(word) {
            Ok(number) if number.is_finite() => *value = number,
            _ => {
                diagnostics.error(
                    source,
                    format!("{what} is '{}': '{word}' is not a finite number", text.trim()),
                    remedy(),
                );
                return None;
            }
        }
    }
    if words.next().is_some() {
        diagnostics.error(source, format!("{what} is '{}': too many numbers", text.trim()), remedy());
        return None;
    }
    Some(values)
}

/// Parses one finite number.
pub fn number(text: &str, what: &str, source: &Source, diagnostics: &mut Diagnostics) -> Option<f64> {
    numbers::<1>(text, what, source, diagnostics).map(|[value]| value)
}

/// Returns the number inside the child element `name`, or none if there is no such child. A child that is not a number
/// is an error and counts as absent.
pub fn child_number(parent: &Element, name: &str, diagnostics: &mut Diagnostics) -> Option<f64> {
    let child = parent.child(name)?;
    number(&child.text(), &format!("<{name}>"), &child.source, diagnostics)
}

/// Returns the text inside the child element `name`, if it is there and not empty.
pub fn child_text(parent: &Element, name: &str) -> Option<String> {
    parent.child(name).map(Element::text).filter(|text| !text.is_empty())
}

/// Returns the boolean inside the child element `name`: `true`, `1`, `false`, `0` in any case.
pub fn child_bool(parent: &Element, name: &str, diagnostics: &mut Diagnostics) -> Option<bool> {
    let child = parent.child(name)?;
    let text = child.text();
    match text.to_ascii_lowercase().as_str() {
        "true" | "1" => Some(true),
        "false" | "0" => Some(false),
        _ => {
            diagnostics.error(&child.source, format!("<{name}> is '{text}'"), "write true or false");
            None
        }
    }
}

/// Returns the 32 bits inside the child element `name`, as a number such as 3 or 0x03. As in libsdformat, a negative number
/// wraps round, so that -1 is all bits, `true` and `false` are 1 and 0, and only the low 32 bits of a larger number count.
pub(crate) fn child_bits(parent: &Element, name: &str, diagnostics: &mut Diagnostics) -> Option<u32> {
    const REMEDY: &str = "write a number of 32 bits, such as 1 or 0x01";
    let child = parent.child(name)?;
    let text = child.text();
    let Some(bits) = bits(&text) else {
        diagnostics.error(&child.source, format!("<{name}> is '{text}'"), REMEDY);
        return None;
    };
    let low = bits as u32;
    if i64::from(low) != bits && i64::from(low as i32) != bits {
        let what =
            format!("<{name}> is '{text}', more than 32 bits: the low ones count, {low}, as in Gazebo");
        diagnostics.warning(&child.source, what, REMEDY);
    }
    Some(low)
}

/// Returns the number in a text, or none if it is not a whole number of 64 bits.
fn bits(text: &str) -> Option<i64> {
    let text = text.to_ascii_lowercase();
    match text.as_str() {
        "true" => Some(1),
        "false" => Some(0),
        text => match text.strip_prefix("0x") {
            Some(digits) if digits.starts_with(['+', '-']) => None,
            Some(digits) => i64::from_str_radix(digits, 16).ok(),
            None => text.parse().ok(),
        },
    }
}

/// Reads SDF's `<pose>` inside `parent`; the identity if there is none.
pub fn child_pose(parent: &Element, gazebo_compat: bool, diagnostics: &mut Diagnostics) -> Pose {
    parent
        .child("pose")
        .and_then(|pose| parse_pose(pose, gazebo_compat, diagnostics))
        .unwrap_or(Pose::IDENTITY)
}

/// Reads `x y z roll pitch yaw`, and from SDF 1.9 on `degrees` and `rotation_format="quat_xyzw"`.
pub(crate) fn parse_pose(
    element: &Element,
    gazebo_compat: bool,
    diagnostics: &mut Diagnostics,
) -> Option<Pose> {
    let mut text = element.text();
    let format = element.attribute("rotation_format").filter(|name| !name.is_empty());
    let format = format.unwrap_or("euler_rpy");
    if text.is_empty() && matches!(format, "euler_rpy" | "quat_xyzw") {
        return Some(Pose::IDENTITY);
    }
    let count = text.split_whitespace().count();
    if gazebo_compat && element.attribute("rotation_format").is_none() && count != 6 {
        let what = if count < 6 {
            format!("<pose> is '{text}', which has {count} numbers: those that are missing are taken as 0")
        } else {
            format!("<pose> is '{text}', which has {count} numbers: only the first 6 are read")
        };
        diagnostics.warning(&element.source, what, "write x y z roll pitch yaw");
        text = text.split_whitespace().chain(["0"; 6]).take(6).collect::<Vec<_>>().join(" ");
    }
    match format {
        "euler_rpy" => {
            let [x, y, z, roll, pitch, yaw] = numbers(&text, "<pose>", &element.source, diagnostics)?;
            let unit = match element.attribute("degrees") {
                Some("true" | "1") => std::f64::consts::PI / 180.0,
                _ => 1.0,
            };
            Some(Pose::from_xyz_rpy(DVec3::new(x, y, z), DVec3::new(roll, pitch, yaw) * unit))
        }
        "quat_xyzw" => {
            let [x, y, z, qx, qy, qz, qw] = numbers(&text, "<pose>", &element.source, diagnostics)?;
            let rotation = DQuat::from_xyzw(qx, qy, qz, qw);
            if rotation.length_squared() < 1e-12 {
                diagnostics.error(
                    &element.source,
                    format!("<pose> is '{text}': its quaternion is zero"),
                    "write a unit quaternion x y z w",
                );
                return None;
            }
            Some(Pose::new(DVec3::new(x, y, z), rotation))
        }
        other => {
            diagnostics.error(
                &element.source,
                format!("rotation_format '{other}' is not known"),
                "write euler_rpy or quat_xyzw",
            );
            None
        }
    }
}

/// Reads URDF's `<origin xyz="…" rpy="…"/>` inside `parent`; the identity if there is none.
pub fn child_origin(parent: &Element, diagnostics: &mut Diagnostics) -> Pose {
    let Some(origin) = parent.child("origin") else { return Pose::IDENTITY };
    let mut vector = |name: &str| {
        origin.attribute(name).map_or(Some(DVec3::ZERO), |text| {
            let what = format!("attribute '{name}' of <origin>");
            numbers::<3>(text, &what, &origin.source, diagnostics).map(DVec3::from_array)
        })
    };
    let (xyz, rpy) = (vector("xyz"), vector("rpy"));
    xyz.zip(rpy).map_or(Pose::IDENTITY, |(xyz, rpy)| Pose::from_xyz_rpy(xyz, rpy))
}

/// A coefficient of friction that is stronger than any force in a simulation.
const UNLIMITED_FRICTION: f64 = 1e6;

/// Returns a coefficient of friction. One below 0 means unlimited, as in Gazebo, with a warning.
pub fn friction_coefficient(mu: f64, what: &str, source: &Source, diagnostics: &mut Diagnostics) -> f64 {
    if mu >= 0.0 {
        return mu;
    }
    let what = format!("{what} is {mu}: friction without limit, as in Gazebo");
    diagnostics.warning(source, what, "write 0 or more");
    UNLIMITED_FRICTION
}

/// Returns a number that is not below 0. A negative one counts as 0, with a warning.
pub(crate) fn not_negative(value: f64, what: &str, source: &Source, diagnostics: &mut Diagnostics) -> f64 {
    if value >= 0.0 {
        return value;
    }
    diagnostics.warning(source, format!("{what} is {value}: it counts as 0"), "write 0 or more");
    0.0
}

/// Returns a share in [0, 1]. One outside counts as the nearer bound, with a warning.
pub(crate) fn share(value: f64, what: &str, source: &Source, diagnostics: &mut Diagnostics) -> f64 {
    let within = value.clamp(0.0, 1.0);
    if within != value {
        diagnostics.warning(
            source,
            format!("{what} is {value}: it counts as {within}"),
            "write a share from 0 to 1",
        );
    }
    within
}
