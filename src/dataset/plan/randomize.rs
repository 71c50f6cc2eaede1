//! The table `[randomize]` of a plan: the limits of random looks.

use super::text::Text;
use crate::description::Diagnostics;
use crate::description::model::{Model, World};
use crate::description::suggestion::did_you_mean;
use crate::randomize::{Colors, LightRanges, Limits, MaterialRanges};
use serde::Deserialize;
use std::collections::BTreeSet;
use std::ops::RangeInclusive;
use toml::Spanned;

/// Tables of a plan: the names that each applies to (`None` for all), and its contents. If several apply, the last one
/// counts.
pub(in crate::dataset) type Ranges<T> = Vec<(Option<Vec<String>>, T)>;

/// The limits of random looks.
#[derive(Debug, Clone)]
pub(in crate::dataset) struct Randomization {
    /// Factor of the ambient light.
    pub(in crate::dataset) ambient: Limits,
    /// Ranges by the names of lights.
    pub(in crate::dataset) lights: Ranges<LightRanges>,
    /// Ranges by the names of models, or of bodies as `model::link`. Tables for all bodies do not include the robot's.
    pub(in crate::dataset) materials: Ranges<MaterialRanges>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RandomizeTable {
    ambient: Option<Spanned<Limits>>,
    #[serde(default)]
    lights: Vec<LightsTable>,
    #[serde(default)]
    materials: Vec<MaterialsTable>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LightsTable {
    names: Option<Vec<Spanned<String>>>,
    intensity: Option<Spanned<Limits>>,
    color: Option<Spanned<Limits>>,
    tilt_deg: Option<Spanned<Limits>>,
    offset_m: Option<Spanned<Limits>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MaterialsTable {
    bodies: Option<Vec<Spanned<String>>>,
    color: Option<Spanned<[[f64; 3]; 2]>>,
    colors: Option<Spanned<Vec<[f64; 3]>>>,
    hue_deg: Option<Spanned<Limits>>,
    saturation: Option<Spanned<Limits>>,
    brightness: Option<Spanned<Limits>>,
    textured: Option<Spanned<f64>>,
}

/// Highest factor of light and colours, beyond which everything is white.
const MOST: f64 = 1000.0;

/// Reads the table and checks its names against those in the worlds and the robot.
pub(super) fn randomization(
    text: &Text<'_>,
    table: &RandomizeTable,
    worlds: &[World],
    robot: Option<&Model>,
    diagnostics: &mut Diagnostics,
) -> Randomization {
    // Names cannot be checked if a file could not be loaded.
    let has_names = !diagnostics.has_errors();
    let mut checked = Checked { text, diagnostics, has_names };
    let lights: BTreeSet<&str> =
        worlds.iter().flat_map(|world| &world.lights).map(|light| light.name.as_str()).collect();
    let models = worlds.iter().flat_map(|world| &world.models).chain(robot);
    let bodies: BTreeSet<String> = models
        .flat_map(|model| {
            let links = model.links.iter().map(|link| format!("{}::{}", model.name, link.name));
            links.chain([model.name.clone()])
        })
        .collect();
    let bodies: BTreeSet<&str> = bodies.iter().map(String::as_str).collect();
    Randomization {
        ambient: checked.limits("ambient", table.ambient.as_ref(), 0.0..=MOST, 1.0),
        lights: table
            .lights
            .iter()
            .map(|table| (checked.names("light", table.names.as_deref(), &lights), checked.lights(table)))
            .collect(),
        materials: table
            .materials
            .iter()
            .map(|table| (checked.names("body", table.bodies.as_deref(), &bodies), checked.materials(table)))
            .collect::<Ranges<MaterialRanges>>(),
    }
}

/// Reads values and reports those that are not allowed.
struct Checked<'a> {
    text: &'a Text<'a>,
    diagnostics: &'a mut Diagnostics,
    /// True if all worlds and the robot are loaded.
    has_names: bool,
}

impl Checked<'_> {
    fn lights(&mut self, table: &LightsTable) -> LightRanges {
        let tilt_deg = self.limits("tilt_deg", table.tilt_deg.as_ref(), 0.0..=180.0, 0.0);
        LightRanges {
            intensity: self.limits("intensity", table.intensity.as_ref(), 0.0..=MOST, 1.0),
            color: self.limits("color", table.color.as_ref(), 0.0..=MOST, 1.0),
            tilt: tilt_deg.map(f64::to_radians),
            offset_m: self.limits("offset_m", table.offset_m.as_ref(), -MOST..=MOST, 0.0),
        }
    }

    fn materials(&mut self, table: &MaterialsTable) -> MaterialRanges {
        MaterialRanges {
            colors: self.colors(table),
            hue_deg: self.limits("hue_deg", table.hue_deg.as_ref(), -360.0..=360.0, 0.0),
            saturation: self.limits("saturation", table.saturation.as_ref(), 0.0..=MOST, 1.0),
            brightness: self.limits("brightness", table.brightness.as_ref(), 0.0..=MOST, 1.0),
            textured: self.share("textured", table.textured.as_ref()),
        }
    }

    fn colors(&mut self, table: &MaterialsTable) -> Colors {
        let is_color = |color: &[f64; 3]| color.iter().all(|part| (0.0..=1.0).contains(part));
        if let Some(colors) = &table.colors {
            let source = self.text.source(&colors.span());
            if table.color.is_some() {
                let what = "a table of materials has both color and colors";
                self.diagnostics.error(&source, what, "write one or the other");
            } else if colors.get_ref().is_empty() || !colors.get_ref().iter().all(is_color) {
                let what = format!("colors = {:?}", colors.get_ref());
                self.diagnostics.error(&source, what, "write one or more [red, green, blue] of 0 to 1");
            }
            return Colors::OneOf(colors.get_ref().clone());
        }
        let Some(color) = &table.color else { return Colors::Own };
        let ends @ [low, high] = *color.get_ref();
        if !ends.iter().all(is_color) || low.iter().zip(high).any(|(low, high)| *low > high) {
            let what = format!("color = {ends:?} is not a range");
            let remedy = "write the lower limits first, [[red, green, blue], [red, green, blue]] of 0 to 1";
            self.diagnostics.error(&self.text.source(&color.span()), what, remedy);
        }
        Colors::Between(ends)
    }

    fn limits(
        &mut self,
        key: &str,
        given: Option<&Spanned<Limits>>,
        within: RangeInclusive<f64>,
        unsaid: f64,
    ) -> Limits {
        let Some(given) = given else { return [unsaid; 2] };
        let limits @ [low, high] = *given.get_ref();
        if !(low <= high && within.contains(&low) && within.contains(&high)) {
            let what = format!("{key} = {limits:?} is not a range");
            let remedy =
                format!("write two numbers from {} to {}, the lower first", within.start(), within.end());
            self.diagnostics.error(&self.text.source(&given.span()), what, remedy);
        }
        limits
    }

    fn share(&mut self, key: &str, given: Option<&Spanned<f64>>) -> f64 {
        let Some(given) = given else { return 1.0 };
        if !(0.0..=1.0).contains(given.get_ref()) {
            let what = format!("{key} = {}", given.get_ref());
            let remedy = "write a probability from 0 to 1";
            self.diagnostics.error(&self.text.source(&given.span()), what, remedy);
        }
        *given.get_ref()
    }

    /// Reads names; `None` means all.
    fn names(
        &mut self,
        what: &str,
        given: Option<&[Spanned<String>]>,
        there: &BTreeSet<&str>,
    ) -> Option<Vec<String>> {
        for name in given.into_iter().flatten() {
            if !self.has_names || there.contains(name.get_ref().as_str()) {
                continue;
            }
            let remedy = did_you_mean(name.get_ref(), there.iter().copied()).unwrap_or_else(|| {
                let there: Vec<&str> = there.iter().take(12).copied().collect();
                if there.is_empty() {
                    "there is none".into()
                } else {
                    format!("there are: {}", there.join(", "))
                }
            });
            let what = format!("no world has a {what} '{}'", name.get_ref());
            self.diagnostics.error(&self.text.source(&name.span()), what, remedy);
        }
        given.map(|names| names.iter().map(|name| name.get_ref().clone()).collect())
    }
}
