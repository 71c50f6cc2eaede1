//! `<link>`: mass, visuals, collisions, sensors and lights.

use super::frames::Frames;
use super::model::Parts;
use super::{Loader, Scope, name_of};
use crate::fiducial::fiducials;
use crate::inertia;
use crate::label::label;
use crate::model::{Collision, Contact, Inertial, Link, SensorKind, Visual};
use crate::optics::optics;
use crate::sensor::{Known, parse_sensor};
use crate::solid::Solid;
use crate::values::{
    child_bits, child_bool, child_number, child_text, friction_coefficient, not_negative, share,
};
use crate::xml::Element;
use belvedere_sensors::Pose;
use glam::DVec3;

/// Mass properties of a link without `<inertial>` (sdf/1.6): 1 kg, and 1 kg·m² about each axis.
const DEFAULT_INERTIAL: Inertial =
    Inertial { link_from_inertial: Pose::IDENTITY, mass_kg: 1.0, inertia: [1.0, 1.0, 1.0, 0.0, 0.0, 0.0] };

/// Returns true if mass and inertia are to be computed from the collisions.
fn is_automatic(inertial: &Element) -> bool {
    matches!(inertial.attribute("auto"), Some("true" | "1"))
}

impl Loader<'_> {
    pub(super) fn link(
        &mut self,
        element: &Element,
        scope: Scope<'_>,
        frames: &mut Frames,
        is_static: bool,
        parts: &mut Parts,
    ) {
        let Parts { links, link_names, .. } = parts;
        let first = |index: usize| &links[index].source;
        let Some(name) = self.own_name(element, link_names, links.len(), first) else { return };
        if !frames.has(&name) {
            let pose = self.pose(element, scope.version);
            frames.add_link(&name, &pose);
        }
        let model_from_link =
            frames.resolve(&name, &element.source, self.diagnostics).unwrap_or(Pose::IDENTITY);
        let index = parts.links.len();
        let mut link = Link {
            name: name.clone(),
            model_from_link,
            inertial: self.inertial(element, scope, &name).or((!is_static).then_some(DEFAULT_INERTIAL)),
            visuals: Vec::new(),
            collisions: Vec::new(),
            gravity: child_bool(element, "gravity", self.diagnostics).unwrap_or(true),
            self_collide: child_bool(element, "self_collide", self.diagnostics).unwrap_or(false),
            is_kinematic: child_bool(element, "kinematic", self.diagnostics).unwrap_or(false),
            velocity_decay: self.velocity_decay(element),
            is_static: false,
            source: element.source.clone(),
        };
        let (mut densities, first_sensor) = (Vec::new(), parts.sensors.len());
        for child in element.elements() {
            match child.name.as_str() {
                "visual" => self.visual(child, scope, frames, &mut link),
                "collision" => {
                    self.collision(child, scope, frames, &mut link);
                    let density = child_number(child, "density", self.diagnostics);
                    densities.resize(link.collisions.len(), density);
                }
                "sensor" => {
                    let pose = self.pose_in_link(child, scope.version, &name, frames);
                    parts.sensors.extend(parse_sensor(child, index, pose, self.rules, self.diagnostics));
                }
                "light" => {
                    let model_from_light =
                        model_from_link * self.pose_in_link(child, scope.version, &name, frames);
                    if !is_static && self.is_world {
                        self.diagnostics.warning(
                            &child.source,
                            "this light does not move with its link",
                            "put the light into the world, or make the model <static>",
                        );
                    }
                    parts.lights.extend(self.light(child, model_from_light));
                }
                "particle_emitter" | "projector" | "battery" => self.ignored(child, "it is not simulated"),
                _ => {}
            }
        }
        if let Some(inertial) = element.child("inertial").filter(|inertial| is_automatic(inertial)) {
            self.weigh(inertial, &densities, &mut link);
        }
        for sensor in &mut parts.sensors[first_sensor..] {
            if let SensorKind::Contact(contact) = &mut sensor.kind {
                let known = link.collisions.iter().enumerate();
                let known: Vec<Known> = known
                    .map(|(number, collision)| Known { name: collision.name.clone(), place: (index, number) })
                    .collect();
                contact.look_up((&sensor.name, &sensor.source), &known, self.diagnostics);
            }
        }
        parts.links.push(link);
    }

    fn inertial(&mut self, link: &Element, scope: Scope<'_>, link_name: &str) -> Option<Inertial> {
        let element = link.child("inertial").filter(|inertial| !is_automatic(inertial))?;
        let written = self.pose(element, scope.version);
        if let Some(frame) = &written.relative_to {
            self.diagnostics.warning(
                &written.source,
                format!("the frame '{frame}' of the <pose> of an <inertial> is ignored, as in Gazebo"),
                "write the pose in the frame of the link",
            );
        }
        let link_from_inertial = written.pose;
        let mass_kg = child_number(element, "mass", self.diagnostics).unwrap_or(DEFAULT_INERTIAL.mass_kg);
        let source = element.child("mass").map_or(&element.source, |mass| &mass.source);
        if mass_kg == 0.0 {
            self.diagnostics.warning(
                source,
                format!(
                    "<mass> of the link '{link_name}' is 0 kg: it counts as {} kg",
                    DEFAULT_INERTIAL.mass_kg
                ),
                "write a mass above 0",
            );
            return Some(Inertial { link_from_inertial, ..DEFAULT_INERTIAL });
        }
        if mass_kg < 0.0 {
            self.diagnostics.error(
                source,
                format!("<mass> of the link '{link_name}' is {mass_kg} kg"),
                "write a mass above 0, or make the model <static>",
            );
            return None;
        }
        let mut inertia = DEFAULT_INERTIAL.inertia;
        if let Some(tensor) = element.child("inertia") {
            for (value, name) in inertia.iter_mut().zip(["ixx", "iyy", "izz", "ixy", "ixz", "iyz"]) {
                if let Some(given) = child_number(tensor, name, self.diagnostics) {
                    *value = given;
                }
            }
            if !inertia::check(inertia, link_name, &tensor.source, self.diagnostics) {
                return None;
            }
        }
        Some(Inertial { link_from_inertial, mass_kg, inertia })
    }

    /// Gives a link the mass and inertia of its collisions, filled with their densities. A mass in the file takes
    /// precedence.
    fn weigh(&mut self, inertial: &Element, densities: &[Option<f64>], link: &mut Link) {
        /// The density of water, SDF's default.
        const DENSITY: f64 = 1000.0;
        let usual = child_number(inertial, "density", self.diagnostics).unwrap_or(DENSITY);
        let mut solids = Vec::new();
        for (collision, density) in link.collisions.iter().zip(densities) {
            let density = density.unwrap_or(usual);
            match Solid::of(&collision.geometry, density) {
                Some(solid) => solids.push(solid.placed(&collision.link_from_collision)),
                None => self.diagnostics.warning(
                    &collision.source,
                    format!(
                        "the collision '{}' of the link '{}' adds no mass: its shape encloses nothing, or its density \
                         is {density} kg/m³",
                        collision.name, link.name
                    ),
                    "give it a closed shape and a density above 0",
                ),
            }
        }
        let mass_kg = child_number(inertial, "mass", self.diagnostics).filter(|mass_kg| *mass_kg > 0.0);
        match Solid::together(&solids) {
            Some(solid) => link.inertial = Some(solid.inertial(mass_kg)),
            None => self.diagnostics.warning(
                &inertial.source,
                format!(
                    "the link '{}' has no collision from which its mass could be computed: it counts as {} kg",
                    link.name, DEFAULT_INERTIAL.mass_kg
                ),
                "give it a <collision>, or write <mass> and <inertia>",
            ),
        }
    }

    fn visual(&mut self, element: &Element, scope: Scope<'_>, frames: &Frames, link: &mut Link) {
        let link_from_visual = self.pose_in_link(element, scope.version, &link.name, frames);
        let opacity = 1.0 - self.within(element, "transparency", 1.0).unwrap_or(0.0);
        let material = self.material(element, scope);
        let label = label(element, self.diagnostics);
        let laser_retro = child_number(element, "laser_retro", self.diagnostics).unwrap_or(0.0) as f32;
        let visibility_flags = child_bits(element, "visibility_flags", self.diagnostics).unwrap_or(u32::MAX);
        let optics = optics(element, self.diagnostics).unwrap_or_default();
        let mut fiducials = fiducials(element, self.diagnostics);
        // A mesh of several materials becomes one visual for each; the first visual has the tags.
        for geometry in self.visual_geometry(element, scope) {
            let own = geometry.own_material();
            let mut material = material.clone().or(own).unwrap_or_default();
            material.alpha *= opacity;
            link.visuals.push(Visual {
                name: name_of(element),
                link_from_visual,
                material,
                label,
                visibility_flags,
                laser_retro,
                optics,
                fiducials: std::mem::take(&mut fiducials),
                geometry,
                source: element.source.clone(),
            });
        }
    }

    fn collision(&mut self, element: &Element, scope: Scope<'_>, frames: &Frames, link: &mut Link) {
        let link_from_collision = self.pose_in_link(element, scope.version, &link.name, frames);
        let friction = element
            .child("surface")
            .and_then(|surface| surface.child("friction"))
            .and_then(|friction| friction.child("ode"));
        let mut mu = friction.and_then(|ode| child_number(ode, "mu", self.diagnostics));
        if let (Some(value), Some(child)) = (mu, friction.and_then(|ode| ode.child("mu"))) {
            mu = Some(friction_coefficient(value, "<mu>", &child.source, self.diagnostics));
        }
        let laser_retro = child_number(element, "laser_retro", self.diagnostics).unwrap_or(0.0) as f32;
        let optics = optics(element, self.diagnostics).unwrap_or_default();
        if let Some(geometry) = self.collision_geometry(element, scope) {
            link.collisions.push(Collision {
                name: name_of(element),
                scoped_name: None,
                link_from_collision,
                geometry,
                friction: mu,
                contact: self.contact(element),
                laser_retro,
                optics,
                source: element.source.clone(),
            });
        }
    }

    /// Reads `<velocity_decay>`: linear, angular.
    fn velocity_decay(&mut self, link: &Element) -> [f64; 2] {
        let Some(decay) = link.child("velocity_decay") else { return [0.0; 2] };
        ["linear", "angular"].map(|name| {
            let value = child_number(decay, name, self.diagnostics).unwrap_or(0.0);
            share(value, &format!("<{name}> of <velocity_decay>"), &decay.source, self.diagnostics)
        })
    }

    /// Reads `<surface>`: restitution, and which shapes collide.
    fn contact(&mut self, collision: &Element) -> Contact {
        let mut read = Contact::default();
        let Some(surface) = collision.child("surface") else { return read };
        if let Some(bounce) = surface.child("bounce") {
            let restitution =
                child_number(bounce, "restitution_coefficient", self.diagnostics).unwrap_or(0.0);
            let what = "<restitution_coefficient>";
            read.restitution = share(restitution, what, &bounce.source, self.diagnostics);
            if let Some(threshold) = child_number(bounce, "threshold", self.diagnostics) {
                read.bounce_threshold_m_s =
                    not_negative(threshold, "<threshold>", &bounce.source, self.diagnostics);
            }
        }
        if let Some(contact) = surface.child("contact") {
            read.is_solid =
                !child_bool(contact, "collide_without_contact", self.diagnostics).unwrap_or(false);
            if let Some(mask) = child_bits(contact, "collide_bitmask", self.diagnostics) {
                read.collide_bitmask = mask;
            }
        }
        read
    }

    /// Reads the vector of three numbers in the child element `name`.
    pub(super) fn vector(&mut self, parent: &Element, name: &str) -> Option<DVec3> {
        let child = parent.child(name)?;
        let text = child_text(parent, name).unwrap_or_default();
        crate::values::numbers(&text, &format!("<{name}>"), &child.source, self.diagnostics)
            .map(DVec3::from_array)
    }
}
