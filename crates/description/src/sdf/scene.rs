//! `<scene>`: ambient light, background, fog and sky.

use super::Loader;
use crate::model::World;
use crate::values::{child_bool, child_number, child_text};
use crate::xml::Element;
use belvedere_sensors::scene::{Fog, FogLaw, Sky};

/// The hours between which SDF's sun is up, if `<sky>` does not say otherwise.
const DAY: [f64; 2] = [6.0, 20.0];

impl Loader<'_> {
    pub(super) fn scene(&mut self, element: &Element, world: &mut World) {
        let Some(scene) = element.child("scene") else { return };
        if let Some(ambient) = self.color(scene, "ambient") {
            world.ambient = ambient;
        }
        if let Some(background) = self.color(scene, "background") {
            world.background = background;
        }
        if let Some(shadows) = child_bool(scene, "shadows", self.diagnostics) {
            world.shadows = shadows;
        }
        if let Some(linear) = child_bool(scene, "linear_light", self.diagnostics) {
            world.linear_light = linear;
        }
        world.air.fog = scene.child("fog").and_then(|fog| self.fog(fog));
        world.air.sky = scene.child("sky").map(|sky| self.sky(sky));
    }

    /// Reads `<fog>` with the defaults of SDF. As in Gazebo classic, there is none without a known type.
    fn fog(&mut self, fog: &Element) -> Option<Fog> {
        // None after an error.
        let mut number = |name, otherwise| match fog.child(name) {
            Some(_) => self.within(fog, name, MOST),
            None => Some(otherwise),
        };
        let [start_m, end_m, density_per_m] = [("start", 1.0), ("end", 100.0), ("density", 1.0)]
            .map(|(name, otherwise)| number(name, otherwise));
        let (start_m, end_m, density_per_m) = (start_m?, end_m?, density_per_m?);
        let colour = self.color(fog, "color").unwrap_or([1.0; 3]);
        let kind = child_text(fog, "type").unwrap_or_default();
        let law = match kind.as_str() {
            "linear" if start_m < end_m => FogLaw::Linear { start_m, end_m },
            "linear" => {
                let what = format!("there is no fog: it starts at {start_m} m and ends at {end_m} m");
                self.diagnostics.warning(&fog.source, what, "write an <end> beyond the <start>");
                return None;
            }
            "exp" => FogLaw::Exponential { density_per_m },
            "exp2" => FogLaw::ExponentialSquared { density_per_m },
            "" | "none" => return None,
            _ => {
                let what = format!("there is no fog: the <type> '{kind}' is unknown, as it is to Gazebo");
                self.diagnostics.warning(&fog.source, what, "write linear, exp or exp2");
                return None;
            }
        };
        Some(Fog { colour, law })
    }

    /// Reads `<sky>`, of which there is one: that of a clear day.
    fn sky(&mut self, sky: &Element) -> Sky {
        let [sunrise, sunset] = [("sunrise", DAY[0]), ("sunset", DAY[1])]
            .map(|(name, otherwise)| child_number(sky, name, self.diagnostics).unwrap_or(otherwise));
        if let Some(time) = child_number(sky, "time", self.diagnostics)
            && !(sunrise..=sunset).contains(&time)
            && let Some(child) = sky.child("time")
        {
            self.ignored(child, "the sky is that of a clear day");
        }
        Sky::DAY
    }
}

/// The greatest distance and density of fog.
const MOST: f32 = 1e9;
