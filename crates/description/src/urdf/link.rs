//! `<link>`.

use super::Loader;
use crate::inertia;
use crate::model::{Collision, Contact, Inertial, Link, Model, Optics, Visual};
use crate::values::{child_origin, number};
use crate::xml::Element;
use belvedere_sensors::Pose;

impl Loader<'_> {
    pub(super) fn links(&mut self, robot: &Element, model: &mut Model) {
        for element in robot.elements_named("link") {
            let taken = |loader: &Self, name: &str| {
                loader.link_names.get(name).map(|first| &model.links[*first].source)
            };
            let Some(name) = self.unique_name(element, taken) else { continue };
            self.link_names.insert(name.clone(), model.links.len());
            let inertial = self.inertial(element, &name);
            let visuals = element.elements_named("visual").flat_map(|visual| self.visual(visual)).collect();
            let collisions = element
                .elements_named("collision")
                .filter_map(|collision| self.collision(collision))
                .collect();
            model.links.push(Link {
                name,
                // Set later, from the joints.
                model_from_link: Pose::IDENTITY,
                inertial,
                visuals,
                collisions,
                gravity: true,
                self_collide: false,
                is_kinematic: false,
                velocity_decay: [0.0; 2],
                is_static: false,
                source: element.source.clone(),
            });
        }
        if robot.child("link").is_none() {
            self.diagnostics.error(
                &robot.source,
                "the robot has no links",
                "write at least one <link name=\"…\">, or call the macro that makes them",
            );
        }
    }

    fn inertial(&mut self, link: &Element, name: &str) -> Option<Inertial> {
        let element = link.child("inertial")?;
        let Some(mass) = element.child("mass") else {
            self.diagnostics.error(
                &element.source,
                format!("the <inertial> of link '{name}' has no <mass>"),
                "write <mass value=\"…\"/> in kilograms",
            );
            return None;
        };
        let mass_kg = self.attribute_number(mass, "value")?;
        if mass_kg < 0.0 {
            self.diagnostics.error(
                &mass.source,
                format!("the mass of link '{name}' is {mass_kg} kg"),
                "write a mass above 0",
            );
            return None;
        }
        if mass_kg == 0.0 {
            self.diagnostics.warning(
                &mass.source,
                format!("the mass of link '{name}' is 0 kg: its <inertial> is left out, as in Gazebo"),
                "write a mass above 0, or leave <inertial> out",
            );
            return None;
        }
        let mut inertia = [0.0; 6];
        if let Some(tensor) = element.child("inertia") {
            for (value, name) in inertia.iter_mut().zip(["ixx", "iyy", "izz", "ixy", "ixz", "iyz"]) {
                if tensor.attribute(name).is_some() {
                    *value = self.attribute_number(tensor, name)?;
                }
            }
            if !inertia::check(inertia, name, &tensor.source, self.diagnostics) {
                return None;
            }
        }
        let link_from_inertial = child_origin(element, self.diagnostics);
        Some(Inertial { link_from_inertial, mass_kg, inertia })
    }

    /// A mesh of several materials becomes one visual for each.
    fn visual(&mut self, element: &Element) -> Vec<Visual> {
        let link_from_visual = child_origin(element, self.diagnostics);
        let material = self.material(element);
        let visual = |(geometry, own_material): (_, Option<_>)| Visual {
            name: element.attribute("name").unwrap_or_default().to_owned(),
            link_from_visual,
            geometry,
            material: material.clone().or(own_material).unwrap_or_default(),
            label: None,
            visibility_flags: u32::MAX,
            laser_retro: 0.0,
            optics: Optics::default(),
            fiducials: Vec::new(),
            source: element.source.clone(),
        };
        self.visual_geometry(element).into_iter().map(visual).collect()
    }

    fn collision(&mut self, element: &Element) -> Option<Collision> {
        let link_from_collision = child_origin(element, self.diagnostics);
        Some(Collision {
            name: element.attribute("name").unwrap_or_default().to_owned(),
            scoped_name: None,
            link_from_collision,
            geometry: self.collision_geometry(element)?,
            friction: None,
            contact: Contact::default(),
            laser_retro: 0.0,
            optics: Optics::default(),
            source: element.source.clone(),
        })
    }

    /// Reads the number in a required attribute.
    pub(super) fn attribute_number(&mut self, element: &Element, name: &str) -> Option<f64> {
        let text = self.required(element, name)?;
        let what = format!("attribute '{name}' of <{}>", element.name);
        number(text, &what, &element.source, self.diagnostics)
    }

    /// Returns the text of a required attribute.
    pub(super) fn required<'e>(&mut self, element: &'e Element, name: &str) -> Option<&'e str> {
        let text = element.attribute(name);
        if text.is_none() {
            self.diagnostics.error(
                &element.source,
                format!("<{}> has no attribute '{name}'", element.name),
                format!("write <{} {name}=\"…\">", element.name),
            );
        }
        text
    }
}
