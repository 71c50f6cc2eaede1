//! `<world>`: scene, physics, models, and `<state>`.

use super::frames::Frames;
use super::model::ParsedModel;
use super::pose::WrittenPose;
use super::{Loader, Scope, name_of};
use crate::model::{Earth, Light, Model, World};
use crate::plugin;
use crate::values::{child_number, numbers};
use crate::xml::Element;
use glam::DVec3;
use std::collections::HashMap;

/// The longest accepted physics step: beyond it, the contacts of a robot at walking speed are missed.
const MAX_STEP_S: f64 = 0.1;

impl Loader<'_> {
    pub(super) fn world(&mut self, element: &Element, scope: Scope<'_>) -> World {
        let mut world = World { name: name_of(element), source: element.source.clone(), ..World::empty() };
        self.scene(element, &mut world);
        self.physics(element, &mut world);
        self.earth(element, &mut world.earth);

        let mut models: Vec<ParsedModel> = Vec::new();
        let mut lacks = false;
        let mut lights: Vec<(Light, WrittenPose)> = Vec::new();
        for child in element.elements() {
            match child.name.as_str() {
                "model" => match self.model(child, scope) {
                    Some(model) => models.push(model),
                    None => lacks = true,
                },
                "include" => match self.include(child, scope) {
                    Some(included) => {
                        models.extend(included.models);
                        lights.extend(included.lights);
                    }
                    None => lacks = true,
                },
                "light" => {
                    let pose = self.pose(child, scope.version);
                    lights.extend(self.light(child, pose.pose).map(|light| (light, pose)));
                }
                "plugin" if plugin::is_provided(child) => {}
                "plugin" => self.ignored(child, "plugins of a world are not run"),
                "actor" => models.extend(self.actor(child, scope)),
                "road" | "population" | "joint" => self.ignored(child, "it is not simulated"),
                _ => {}
            }
        }

        self.make_names_unique(&mut models);
        // Models may be posed relative to one another.
        let mut frames = Frames::new("world");
        self.check_names(element, &models, scope.version);
        for parsed in &mut models {
            self.add_frames(parsed, &mut frames);
        }
        for child in element.elements_named("frame") {
            self.add_frame(child, scope.version, &mut frames);
        }
        if !lacks {
            frames.check(self.diagnostics);
        }
        let mut placed: Vec<(Model, Vec<_>)> = Vec::new();
        for ParsedModel { mut model, pose, lights, .. } in models {
            model.world_from_model =
                frames.resolve(&model.name, &pose.source, self.diagnostics).unwrap_or(pose.pose);
            placed.push((model, lights));
        }
        world.lights.extend(lights.into_iter().map(|(mut light, pose)| {
            light.world_from_light = frames.place(&pose, self.diagnostics);
            light
        }));
        if let Some(state) = element.child("state") {
            self.state(state, &frames, &mut placed, &mut world, scope);
        }
        for (model, lights) in placed {
            world.lights.extend(lights.into_iter().map(|mut light| {
                light.world_from_light = model.world_from_model * light.world_from_light;
                light
            }));
            world.models.push(model);
        }
        if !world.shadows {
            for light in &mut world.lights {
                light.cast_shadows = false;
            }
        }
        world
    }

    /// Reads `<spherical_coordinates>` and `<magnetic_field>`.
    fn earth(&mut self, element: &Element, earth: &mut Earth) {
        if let Some(field) = element.child("magnetic_field")
            && let Some(tesla) = numbers(&field.text(), "<magnetic_field>", &field.source, self.diagnostics)
        {
            earth.magnetic_field_t = DVec3::from_array(tesla);
        }
        let Some(place) = element.child("spherical_coordinates") else { return };
        earth.is_given = true;
        for (name, most, to) in [
            ("latitude_deg", 90.0, &mut earth.latitude_deg),
            ("longitude_deg", 360.0, &mut earth.longitude_deg),
            ("elevation", 1e5, &mut earth.elevation_m),
            ("heading_deg", 1e5, &mut earth.heading_rad),
        ] {
            let Some(value) = child_number(place, name, self.diagnostics) else { continue };
            *to = value;
            if let Some(child) = place.child(name).filter(|_| value.abs() > most) {
                let what = format!("<{name}> is {value}");
                self.diagnostics.error(&child.source, what, format!("write a number from -{most} to {most}"));
            }
        }
        earth.heading_rad = earth.heading_rad.to_radians();
        let orientation = place.child("world_frame_orientation");
        for child in [orientation, place.child("surface_model")].into_iter().flatten() {
            if !matches!(child.text().as_str(), "ENU" | "EARTH_WGS84" | "") {
                self.ignored(
                    child,
                    "EARTH_WGS84 is used instead, with ENU axes that are turned by <heading_deg>",
                );
            }
        }
    }

    fn physics(&mut self, element: &Element, world: &mut World) {
        let is_default = |physics: &&Element| matches!(physics.attribute("default"), Some("true" | "1"));
        let physics = element.elements_named("physics").find(is_default).or_else(|| element.child("physics"));
        if let Some(physics) = physics
            && let Some(step) = child_number(physics, "max_step_size", self.diagnostics)
        {
            if step > 0.0 && step <= MAX_STEP_S {
                world.max_step_size_s = step;
            } else if let Some(child) = physics.child("max_step_size") {
                self.diagnostics.error(
                    &child.source,
                    format!("<max_step_size> is {step} s"),
                    format!("write a step above 0 and up to {MAX_STEP_S} s; 0.001 is usual"),
                );
            }
        }
        // <gravity> moved from <physics> to <world> with SDF 1.6.
        let gravity = element.child("gravity").or_else(|| physics?.child("gravity"));
        if let Some(gravity) = gravity
            && let Some(vector) = numbers(&gravity.text(), "<gravity>", &gravity.source, self.diagnostics)
        {
            world.gravity = DVec3::from_array(vector);
        }
    }

    /// Moves models to the poses of a saved `<state>`. Gazebo applies the poses of models; those of their links follow
    /// from them.
    fn state<T>(
        &mut self,
        state: &Element,
        frames: &Frames,
        models: &mut [(Model, T)],
        world: &mut World,
        scope: Scope<'_>,
    ) {
        let mut named: HashMap<String, usize> = HashMap::new();
        for (index, (model, _)) in models.iter().enumerate() {
            named.entry(model.name.clone()).or_insert(index);
        }
        let mut named_lights: HashMap<String, usize> = HashMap::new();
        for (index, light) in world.lights.iter().enumerate() {
            named_lights.entry(light.name.clone()).or_insert(index);
        }
        for child in state.elements() {
            let name = name_of(child);
            match child.name.as_str() {
                "model" => {
                    let written = self.pose(child, scope.version);
                    let pose = frames.place(&written, self.diagnostics);
                    if let Some(&index) = named.get(&*name) {
                        models[index].0.world_from_model = pose;
                    } else {
                        self.unknown_in_state(child, models.iter().map(|(model, _)| model.name.as_str()));
                    }
                    let scaled = child.child("scale").map(Element::text).filter(|text| {
                        text.split_whitespace().any(|word| word.parse::<f64>().is_ok_and(|s| s != 1.0))
                    });
                    if let (Some(_), Some(scale)) = (scaled, child.child("scale")) {
                        self.ignored(scale, "models keep the size that their files give");
                    }
                }
                "light" => {
                    let written = self.pose(child, scope.version);
                    let pose = frames.place(&written, self.diagnostics);
                    match named_lights.get(&*name) {
                        Some(&index) => world.lights[index].world_from_light = pose,
                        None => self.unknown_in_state(child, world.lights.iter().map(|l| l.name.as_str())),
                    }
                }
                "insertions" | "deletions" => {
                    self.ignored(child, "only the poses of a saved state are applied");
                }
                _ => {}
            }
        }
    }

    fn unknown_in_state<'n>(&mut self, child: &Element, known: impl Iterator<Item = &'n str>) {
        let name = name_of(child);
        let meant = self.diagnostics.did_you_mean(&name, known).unwrap_or_default();
        self.diagnostics.warning(
            &child.source,
            format!("<state> moves the {} '{name}', which is not in this world", child.name),
            meant,
        );
    }
}
