//! The visual scene of a Collada file: nodes with their transforms, instances, and the materials that these bind.
//!
//! All instances of a node, controller or material refer to the same element, so each element is read only once.

use super::numbers::transform;
use super::{Document, Outcome, Wrong, wrong};
use crate::mesh::part::Part;
use crate::model::Material;
use crate::xml::Element;
use glam::DAffine3;
use std::collections::HashMap;
use std::ptr;
use std::rc::Rc;
use std::sync::Arc;

/// What the budget counts for each child of a node, in bytes: children take time, even those without triangles.
const CHILD: usize = 64;

/// The greatest number of transforms of a node that each instance applies one by one.
const TRANSFORMS: usize = 32;

/// The materials that an instance assigns to the symbols of its primitives.
type Bound<'a> = Rc<HashMap<&'a str, Rc<Material>>>;

/// What has been read, by its elements.
#[derive(Default)]
pub(super) struct Known<'a> {
    nodes: HashMap<*const Element, Rc<Node<'a>>>,
    skins: HashMap<*const Element, Option<Skin<'a>>>,
    bound: HashMap<*const Element, Bound<'a>>,
    /// The looks of materials; `None` for those without a look, and for damaged ones.
    materials: HashMap<*const Element, Option<Rc<Material>>>,
    /// Those of effects.
    effects: HashMap<*const Element, Option<Rc<Material>>>,
}

/// The content of a node.
struct Node<'a> {
    /// At most [`TRANSFORMS`]; the last is the product of all further ones.
    transforms: Vec<DAffine3>,
    /// Its name and its id.
    names: Vec<Arc<str>>,
    /// The nodes and the instances in it.
    children: Vec<&'a Element>,
}

/// A skin in the pose in which its mesh was bound; skeletons are not applied.
#[derive(Clone, Copy)]
struct Skin<'a> {
    geometry: &'a Element,
    world_from_geometry: DAffine3,
}

impl<'a> Document<'a> {
    /// Places the content of a node. `above` has the names of the nearest ancestor that has any.
    pub(super) fn node(
        &mut self,
        element: &'a Element,
        world_from_parent: DAffine3,
        above: &[Arc<str>],
        parts: &mut Vec<Part>,
    ) -> Outcome<()> {
        let node = self.content(element)?;
        if node.children.is_empty() {
            return Ok(());
        }
        let spent = self.budget.take(1, CHILD * node.children.len()).and_then(|()| self.budget.enter(1));
        if let Err(spent) = spent {
            return wrong(element, spent.to_string());
        }
        let world_from_node = node.transforms.iter().fold(world_from_parent, |world, next| world * *next);
        // In Gazebo, the name of a part is that of its node, or of the nearest ancestor with a name.
        let names = if node.names.is_empty() { above } else { &node.names[..] };
        for &child in &node.children {
            let first = parts.len();
            match child.name.as_str() {
                "node" => self.node(child, world_from_node, names, parts)?,
                "instance_node" => {
                    self.node(self.referenced(child, "url")?, world_from_node, names, parts)?;
                }
                "instance_geometry" => {
                    let materials = self.bound_materials(child);
                    self.geometry(self.referenced(child, "url")?, world_from_node, &materials, parts)?;
                }
                _ => self.skin(child, parts)?,
            }
            if matches!(child.name.as_str(), "instance_geometry" | "instance_controller") {
                for part in &mut parts[first..] {
                    part.aliases.extend(names.iter().cloned());
                }
            }
        }
        self.budget.leave(1);
        Ok(())
    }

    fn content(&mut self, element: &'a Element) -> Outcome<Rc<Node<'a>>> {
        if let Some(known) = self.known.nodes.get(&ptr::from_ref(element)) {
            return Ok(known.clone());
        }
        // The content of camera and light nodes has no triangles.
        let holds = |child: &&Element| {
            let name = child.name.as_str();
            matches!(name, "node" | "instance_node" | "instance_geometry" | "instance_controller")
        };
        let children: Vec<&Element> = element.elements().filter(holds).collect();
        let mut transforms: Vec<DAffine3> = Vec::new();
        for child in element.elements().filter(|_| !children.is_empty()) {
            if child.name == "skew" {
                self.left_out.push(Wrong(child.source.clone(), "<skew> is not read".into()));
            } else if let Some(transform) = transform(child)? {
                match transforms.get_mut(TRANSFORMS - 1) {
                    Some(last) => *last *= transform,
                    None => transforms.push(transform),
                }
            }
        }
        let names = ["name", "id"].iter().filter_map(|name| element.attribute(name)).map(Arc::from).collect();
        let node = Rc::new(Node { transforms, names, children });
        self.known.nodes.insert(element, node.clone());
        Ok(node)
    }

    /// Places a skin.
    fn skin(&mut self, instance: &'a Element, parts: &mut Vec<Part>) -> Outcome<()> {
        let controller = self.referenced(instance, "url")?;
        let skin = if let Some(known) = self.known.skins.get(&ptr::from_ref(controller)) {
            *known
        } else {
            let read = self.read_skin(controller)?;
            self.known.skins.insert(controller, read);
            read
        };
        let Some(skin) = skin else { return Ok(()) };
        let materials = self.bound_materials(instance);
        self.geometry(skin.geometry, skin.world_from_geometry, &materials, parts)
    }

    fn read_skin(&mut self, controller: &'a Element) -> Outcome<Option<Skin<'a>>> {
        let Some(skin) = controller.child("skin") else {
            self.left_out
                .push(Wrong(controller.source.clone(), "a controller that is not a skin is not read".into()));
            return Ok(None);
        };
        let bind_shape = skin.child("bind_shape_matrix").map(transform).transpose()?.flatten();
        let geometry = self.referenced(skin, "source")?;
        // The pose of a skin follows from its joints, not from its node.
        let world_from_geometry = self.world_from_file * bind_shape.unwrap_or(DAffine3::IDENTITY);
        Ok(Some(Skin { geometry, world_from_geometry }))
    }

    /// Returns the materials that an instance assigns to the symbols of its primitives.
    fn bound_materials(&mut self, instance: &'a Element) -> Bound<'a> {
        if let Some(known) = self.known.bound.get(&ptr::from_ref(instance)) {
            return known.clone();
        }
        let mut materials = HashMap::new();
        let technique = instance.child("bind_material").and_then(|binding| binding.child("technique_common"));
        for bound in technique.iter().flat_map(|technique| technique.elements_named("instance_material")) {
            match self.referenced(bound, "target").and_then(|material| self.look(material)) {
                Ok(look) => materials.extend(bound.attribute("symbol").zip(look)),
                Err(wrong) => self.left_out.push(wrong),
            }
        }
        let materials = Rc::new(materials);
        self.known.bound.insert(instance, materials.clone());
        materials
    }

    /// Returns the look of a material; `None` if it has none.
    ///
    /// # Errors
    /// What is wrong with it, the first time that it is read; afterwards it has no look.
    fn look(&mut self, material: &'a Element) -> Outcome<Option<Rc<Material>>> {
        if let Some(known) = self.known.materials.get(&ptr::from_ref(material)) {
            return Ok(known.clone());
        }
        let look = match material.child("instance_effect") {
            Some(effect) => self.referenced(effect, "url").and_then(|effect| self.known_effect(effect)),
            None => Ok(None),
        };
        self.known.materials.insert(material, look.as_ref().ok().cloned().flatten());
        look
    }

    /// Returns the look of an effect, as [`look`](Self::look) does.
    fn known_effect(&mut self, effect: &'a Element) -> Outcome<Option<Rc<Material>>> {
        if let Some(known) = self.known.effects.get(&ptr::from_ref(effect)) {
            return Ok(known.clone());
        }
        let look = self.effect(effect).map(|look| look.map(Rc::new));
        self.known.effects.insert(effect, look.as_ref().ok().cloned().flatten());
        look
    }
}
