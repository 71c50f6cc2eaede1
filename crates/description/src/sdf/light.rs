//! `<light>`.

use super::{Loader, name_of};
use crate::model::{Light, LightKind};
use crate::values::{child_bool, child_number, numbers};
use crate::xml::Element;
use belvedere_sensors::Pose;
use belvedere_sensors::scene::MAX_FALLOFF;
use glam::DVec3;
use std::f64::consts::PI;

/// Default of `<attenuation><range>` in metres (sdf/1.6).
const DEFAULT_RANGE_M: f64 = 10.0;

/// Default of `<specular>` (sdf/1.6).
const DEFAULT_SPECULAR: [f32; 3] = [0.1; 3];

impl Loader<'_> {
    /// Reads a light with the pose `outer_from_light`; none if it is switched off.
    pub(super) fn light(&mut self, element: &Element, outer_from_light: Pose) -> Option<Light> {
        if child_bool(element, "light_on", self.diagnostics) == Some(false) {
            return None;
        }
        let kind = match element.attribute("type") {
            Some("point") => LightKind::Point,
            Some("directional") => LightKind::Directional,
            Some("spot") => self.spot(element)?,
            None => {
                let what = format!(
                    "the light '{}' has no type: it is a point light, as in Gazebo",
                    name_of(element)
                );
                let remedy = "write type=\"point\", \"directional\" or \"spot\"";
                self.diagnostics.warning(&element.source, what, remedy);
                LightKind::Point
            }
            Some(other) => {
                self.diagnostics.error(
                    &element.source,
                    format!("the type of <light> is '{other}'"),
                    "write type=\"point\", \"directional\" or \"spot\"",
                );
                return None;
            }
        };
        let attenuation = element.child("attenuation");
        let mut number = |name: &str, default: f64| {
            let given = attenuation.and_then(|parent| child_number(parent, name, self.diagnostics));
            if let (Some(value), Some(child)) = (given, attenuation.and_then(|parent| parent.child(name)))
                && value < 0.0
            {
                self.diagnostics.error(
                    &child.source,
                    format!("<{name}> of a light is {value}"),
                    "it cannot be negative",
                );
            }
            given.unwrap_or(default)
        };
        let range_m = number("range", DEFAULT_RANGE_M);
        let attenuation = [number("constant", 1.0), number("linear", 1.0), number("quadratic", 0.0)];
        let is_sun = kind == LightKind::Directional;
        let intensity = child_number(element, "intensity", self.diagnostics).unwrap_or(1.0);
        let diffuse = self.color(element, "diffuse").unwrap_or([1.0; 3]);
        let specular = self.color(element, "specular").unwrap_or(DEFAULT_SPECULAR);
        Some(Light {
            name: name_of(element),
            world_from_light: outer_from_light,
            kind,
            diffuse: diffuse.map(|value| value * intensity as f32),
            specular: specular.map(|value| value * intensity as f32),
            direction: if kind == LightKind::Point { DVec3::NEG_Z } else { self.direction(element)? },
            range_m: if is_sun { f64::INFINITY } else { range_m },
            attenuation: if is_sun { [1.0, 0.0, 0.0] } else { attenuation },
            cast_shadows: child_bool(element, "cast_shadows", self.diagnostics).unwrap_or(false),
            source: element.source.clone(),
        })
    }

    fn direction(&mut self, element: &Element) -> Option<DVec3> {
        let Some(child) = element.child("direction") else { return Some(DVec3::NEG_Z) };
        let text = child.text();
        let vector = numbers(&text, "<direction>", &child.source, self.diagnostics).map(DVec3::from_array)?;
        let unit = vector.try_normalize();
        if unit.is_none() {
            self.missing(
                &child.source,
                format!("<direction> is '{text}': it has no length"),
                "write the direction in which the light travels, such as 0 0 -1, which is the default",
            );
        }
        unit.or(self.rules.gazebo_compat.then_some(DVec3::NEG_Z))
    }

    fn spot(&mut self, element: &Element) -> Option<LightKind> {
        // As in libsdformat, all three are 0 if they are not written.
        let spot = element.child("spot");
        let source = &spot.unwrap_or(element).source;
        let mut number =
            |name: &str| spot.and_then(|spot| child_number(spot, name, self.diagnostics)).unwrap_or(0.0);
        let (mut inner_angle, mut outer_angle, falloff) =
            (number("inner_angle"), number("outer_angle"), number("falloff"));
        if outer_angle > PI {
            self.diagnostics.warning(
                source,
                format!("<outer_angle> is {outer_angle}: the cone is a half space"),
                "write the full angle in radians, up to 3.1416",
            );
            (inner_angle, outer_angle) = (inner_angle.min(PI), PI);
        }
        if inner_angle > outer_angle && outer_angle > 0.0 {
            self.diagnostics.warning(
                source,
                format!("<inner_angle> is {inner_angle}, above <outer_angle>: it is {outer_angle}, too"),
                "write an <inner_angle> up to the <outer_angle>",
            );
            inner_angle = outer_angle;
        }
        if !(0.0..=PI).contains(&outer_angle)
            || !(0.0..=outer_angle).contains(&inner_angle)
            || !(0.0..=f64::from(MAX_FALLOFF)).contains(&falloff)
        {
            self.diagnostics.error(
                source,
                format!("<spot> has inner_angle {inner_angle}, outer_angle {outer_angle}, falloff {falloff}"),
                "write full angles with 0 ≤ inner ≤ outer ≤ 3.1416, and a falloff from 0 to 10000",
            );
            return None;
        }
        if outer_angle == 0.0 {
            let why = if spot.is_some() { "its <outer_angle> is 0" } else { "it has no <spot>" };
            self.diagnostics.warning(
                source,
                format!("the light '{}' of type spot lights nothing, because {why}", name_of(element)),
                "write <spot> with <inner_angle>, <outer_angle> and <falloff>",
            );
        }
        Some(LightKind::Spot { inner_angle, outer_angle, falloff })
    }
}
