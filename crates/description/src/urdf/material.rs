//! `<material>`, by name or defined in place.

use super::{Loader, TEXTURE};
use crate::gazebo_materials::gazebo_material;
use crate::model::Material;
use crate::values::numbers;
use crate::xml::Element;

impl Loader<'_> {
    /// Collects the materials that have a name: those of the robot, then those defined inside a visual, which others may
    /// refer to as well. If a name is defined twice, the first definition is used.
    pub(super) fn define_materials(&mut self, robot: &Element) {
        let visuals = robot.elements_named("link").flat_map(|link| link.elements_named("visual"));
        let materials = robot
            .elements_named("material")
            .chain(visuals.flat_map(|visual| visual.elements_named("material")));
        for element in materials {
            let name = element.attribute("name").unwrap_or_default();
            if !name.is_empty()
                && !self.materials.contains_key(name)
                && let Some(material) = self.defined(element)
            {
                self.materials.insert(name.to_owned(), material);
            }
        }
    }

    /// Reads the material of a visual; none if the file gives none, so that a mesh keeps its own.
    pub(super) fn material(&mut self, visual: &Element) -> Option<Material> {
        let element = visual.child("material")?;
        let name = element.attribute("name").unwrap_or_default();
        if is_definition(element) {
            return self.defined(element);
        }
        let found = self.materials.get(name).cloned().or_else(|| gazebo_material(name));
        if found.is_none() {
            let known = self.materials.keys().map(String::as_str);
            self.diagnostics.warning(
                &element.source,
                format!("the material '{name}' is not defined: the shape is grey"),
                self.diagnostics.did_you_mean_or(name, known, "write <color rgba=\"…\"/> in it"),
            );
        }
        found
    }

    /// Reads the definition inside a `<material>`.
    fn defined(&mut self, element: &Element) -> Option<Material> {
        if !is_definition(element) {
            return None;
        }
        // urdfdom writes an empty <texture/> beside a colour.
        let texture = element.child("texture").and_then(|texture| {
            let name = texture.attribute("filename").filter(|name| !name.is_empty())?;
            self.file(texture, name, TEXTURE)
        });
        // A texture without a colour is not tinted.
        let plain = if texture.is_some() { [1.0; 3] } else { Material::default().diffuse };
        let rgba = element.child("color").and_then(|color| self.color(color));
        let [red, green, blue, alpha] = rgba.unwrap_or([plain[0], plain[1], plain[2], 1.0]);
        let color = [red, green, blue];
        Some(Material { diffuse: color, ambient: color, alpha, texture, ..Material::default() })
    }

    fn color(&mut self, element: &Element) -> Option<[f32; 4]> {
        let text = self.required(element, "rgba")?;
        let what = "attribute 'rgba' of <color>";
        let rgba = numbers::<4>(text, what, &element.source, self.diagnostics)?;
        if !rgba.iter().all(|value| (0.0..=1.0).contains(value)) {
            self.diagnostics.error(
                &element.source,
                format!("{what} is '{text}'"),
                "write red, green, blue and alpha, each from 0 to 1",
            );
            return None;
        }
        Some(rgba.map(|value| value as f32))
    }
}

/// Returns true if the element has more than a name.
pub(super) fn is_definition(material: &Element) -> bool {
    material.child("color").is_some()
        || material
            .child("texture")
            .is_some_and(|texture| texture.attribute("filename").is_some_and(|name| !name.is_empty()))
}
