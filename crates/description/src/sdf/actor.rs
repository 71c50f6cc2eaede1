//! `<actor>`: a model that follows its script instead of physics.

use super::frames::Frames;
use super::model::ParsedModel;
use super::{Loader, Scope, name_of};
use crate::model::{Geometry, Leg, Link, Model, Optics, Trajectory, Visual, Waypoint};
use crate::values::{child_bool, child_number, child_text};
use crate::xml::Element;
use belvedere_sensors::Pose;
use glam::DVec3;

/// The name of the link that carries an actor's skin.
const SKIN: &str = "skin";

impl Loader<'_> {
    /// Reads an actor: a model whose links follow its trajectory together. Without a trajectory it stands still.
    pub(super) fn actor(&mut self, element: &Element, scope: Scope<'_>) -> Option<ParsedModel> {
        let has_links =
            element.elements().any(|child| matches!(child.name.as_str(), "link" | "include" | "model"));
        let mut parsed = if has_links { self.model(element, scope)? } else { self.bare(element, scope)? };
        if let Some(skin) = element.child("skin") {
            parsed.model.links.extend(self.skin(skin, scope));
        }
        if parsed.model.links.is_empty() {
            self.diagnostics.warning(
                &element.source,
                format!("the actor '{}' has nothing to show and is left out", parsed.model.name),
                "give it a <skin> or a <link> with a <visual>",
            );
            return None;
        }
        if let Some(animation) = element.child("animation") {
            self.diagnostics.note(
                &animation.source,
                format!("the actor '{}' moves as one piece, in the pose of its skin", parsed.model.name),
                "skeleton animations are not played",
            );
        }
        let script = element.child("script");
        parsed.model.trajectory = script.and_then(|script| self.trajectory(script, scope));
        // Physics does not move it.
        parsed.model.is_static = parsed.model.trajectory.is_none();
        Some(parsed)
    }

    /// Reads an actor that has only a skin.
    fn bare(&mut self, element: &Element, scope: Scope<'_>) -> Option<ParsedModel> {
        let name = name_of(element);
        if name.is_empty() {
            self.diagnostics.error(&element.source, "<actor> has no name", "write <actor name=\"…\">");
            return None;
        }
        let model = Model::empty(name, element.source.clone());
        Some(ParsedModel {
            model,
            pose: self.pose(element, scope.version),
            lights: Vec::new(),
            is_merged: false,
            place: 0,
            first_link: None,
            frames: Frames::new("__model__"),
        })
    }

    fn skin(&mut self, skin: &Element, scope: Scope<'_>) -> Option<Link> {
        let Some(file) = child_text(skin, "filename") else {
            self.diagnostics.error(
                &skin.source,
                "<skin> has no <filename>",
                "write <filename>walk.dae</filename>",
            );
            return None;
        };
        let scale = child_number(skin, "scale", self.diagnostics).unwrap_or(1.0);
        let parts = self.mesh_file(skin, &file, None, DVec3::splat(scale), scope)?;
        let visuals = parts.into_iter().map(|mesh| Visual {
            name: SKIN.into(),
            link_from_visual: Pose::IDENTITY,
            material: mesh.material.clone().unwrap_or_default(),
            label: None,
            visibility_flags: u32::MAX,
            laser_retro: 0.0,
            optics: Optics::default(),
            fiducials: Vec::new(),
            geometry: Geometry::Mesh(mesh),
            source: skin.source.clone(),
        });
        let visuals = visuals.collect();
        Some(Link { visuals, ..Link::empty(SKIN.into(), skin.source.clone()) })
    }

    fn trajectory(&mut self, script: &Element, scope: Scope<'_>) -> Option<Trajectory> {
        if child_bool(script, "auto_start", self.diagnostics) == Some(false) {
            self.ignored(script, "the actor stands still: nothing starts it");
            return None;
        }
        let delay_s = child_number(script, "delay_start", self.diagnostics).unwrap_or(0.0);
        let repeats = child_bool(script, "loop", self.diagnostics).unwrap_or(true);
        // Sorted by their ids, whatever their order in the file.
        let mut legs: Vec<(i64, Leg)> = Vec::new();
        for (place, element) in (0..).zip(script.elements_named("trajectory")) {
            let id = element.attribute("id").and_then(|id| id.trim().parse().ok()).unwrap_or(place);
            let tension = element.attribute("tension").and_then(|tension| tension.trim().parse().ok());
            let tension: f64 = tension.unwrap_or(0.0);
            if !(0.0..=1.0).contains(&tension) {
                self.diagnostics.warning(
                    &element.source,
                    format!("the tension of a trajectory is {tension}"),
                    "write a number from 0 to 1",
                );
            }
            let waypoints = self.waypoints(element, scope);
            legs.extend(Leg::new(tension.clamp(0.0, 1.0), waypoints).map(|leg| (id, leg)));
        }
        legs.sort_by_key(|(id, _)| *id);
        if !(0.0..1e9).contains(&delay_s) {
            self.diagnostics.error(
                &script.source,
                format!("<delay_start> is {delay_s} s"),
                "write a number that is not negative",
            );
            return None;
        }
        Trajectory::new(delay_s, repeats, legs.into_iter().map(|(_, leg)| leg).collect())
    }

    fn waypoints(&mut self, trajectory: &Element, scope: Scope<'_>) -> Vec<Waypoint> {
        let mut waypoints = Vec::new();
        for element in trajectory.elements_named("waypoint") {
            let time_s = child_number(element, "time", self.diagnostics).unwrap_or(0.0);
            if !(0.0..1e9).contains(&time_s) {
                self.diagnostics.error(
                    &element.source,
                    format!("the <time> of a waypoint is {time_s} s"),
                    "write a number that is not negative",
                );
                continue;
            }
            let world_from_actor = self.pose(element, scope.version).pose;
            waypoints.push(Waypoint { time_s, world_from_actor });
        }
        waypoints
    }
}
