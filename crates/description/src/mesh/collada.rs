//! Collada 1.4 and 1.5 (`.dae`): the triangles of the visual scene in metres, and their colours.
//!
//! Read: units and, if wanted, the up axis, nodes with all their transforms and instances, `triangles`, `polylist`, `polygons`,
//! `trifans`, `tristrips`, diffuse as colour or picture, emission, specular, shininess, and what is
//! transparent if it says how (`opaque="…"`), as in Gazebo. Skins are in the pose in which they were bound. Passed over:
//! lines, splines, skeletons, animation, lights and cameras, with the nodes that hold nothing else. Materials and looks that are missing or wrong
//! cost a warning, not the mesh.

mod numbers;

use super::{Look, Part, UpAxis};
use crate::budget::Budget;
use crate::diagnostics::{Diagnostics, Source};
use crate::model::Material;
use crate::xml::Element;
use belvedere_sensors::scene::TextureAlpha;
use glam::{DAffine3, DMat3, DVec3};
use numbers::{Values, list, offset, polygons, transform, values};
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

/// Where in the file it is wrong, and what.
struct Wrong(Source, String);

type Outcome<T> = Result<T, Wrong>;

fn wrong<T>(element: &Element, what: impl Into<String>) -> Outcome<T> {
    Err(Wrong(element.source.clone(), what.into()))
}

/// Reads the file; none after an error, which then stands in `diagnostics`.
pub(super) fn load(path: &Path, up_axis: UpAxis, diagnostics: &mut Diagnostics) -> Option<Vec<Part>> {
    let root = match Element::parse_file(path) {
        Ok(root) => root,
        Err(problem) => {
            diagnostics.add(problem);
            return None;
        }
    };
    let mut document = Document::new(&root, up_axis);
    let parts = document.parts();
    for Wrong(source, what) in document.left_out {
        diagnostics.warning(&source, format!("{what}: it is left out"), "export the mesh again");
    }
    match parts {
        Ok(parts) => Some(parts),
        Err(Wrong(source, what)) => {
            diagnostics.error(&source, format!("broken Collada: {what}"), "export the mesh again");
            None
        }
    }
}

struct Document<'a> {
    root: &'a Element,
    up_axis: UpAxis,
    by_id: HashMap<&'a str, &'a Element>,
    budget: Budget,
    /// Geometries that were taken once: from then on they are copies.
    taken: HashSet<*const Element>,
    /// What is wrong, and can be done without.
    left_out: Vec<Wrong>,
}

/// An `<input>` of a primitive.
struct Input<'a> {
    offset: usize,
    values: Values<'a>,
}

impl<'a> Document<'a> {
    fn new(root: &'a Element, up_axis: UpAxis) -> Self {
        fn collect<'a>(element: &'a Element, by_id: &mut HashMap<&'a str, &'a Element>) {
            if let Some(id) = element.attribute("id") {
                by_id.entry(id).or_insert(element);
            }
            for child in element.elements() {
                collect(child, by_id);
            }
        }
        let mut by_id = HashMap::new();
        collect(root, &mut by_id);
        let (budget, taken, left_out) = (Budget::default(), HashSet::new(), Vec::new());
        Self { root, up_axis, by_id, budget, taken, left_out }
    }

    fn parts(&mut self) -> Outcome<Vec<Part>> {
        if self.root.name != "COLLADA" {
            return wrong(self.root, format!("the root element is <{}>", self.root.name));
        }
        let world_from_file = self.world_from_file()?;
        let mut parts = Vec::new();
        let scene = self.root.child("scene").and_then(|scene| scene.child("instance_visual_scene"));
        if let Some(instance) = scene {
            let scene = self.referenced(instance, "url")?;
            for node in scene.elements_named("node") {
                self.node(node, world_from_file, &mut parts)?;
            }
        } else {
            let geometries = self.root.elements_named("library_geometries");
            for geometry in geometries.flat_map(|library| library.elements_named("geometry")) {
                self.geometry(geometry, world_from_file, &HashMap::new(), &mut parts)?;
            }
        }
        Ok(parts)
    }

    /// From the file's unit and, if wanted, up axis to metres and z up.
    fn world_from_file(&self) -> Outcome<DAffine3> {
        let asset = self.root.child("asset");
        let unit = asset.and_then(|asset| asset.child("unit"));
        let metre = match unit.and_then(|unit| Some((unit, unit.attribute("meter")?))) {
            None => 1.0,
            Some((element, text)) => match text.trim().parse::<f64>() {
                Ok(metre) if metre.is_finite() && metre > 0.0 => metre,
                _ => return wrong(element, format!("the unit is '{text}' metres")),
            },
        };
        let axis = asset.and_then(|asset| asset.child("up_axis"));
        let axis = axis.filter(|_| self.up_axis == UpAxis::Applied);
        let turn = match axis.map(Element::text).as_deref() {
            // Columns: where the file's x, y and z go.
            None | Some("Z_UP") => DMat3::IDENTITY,
            Some("Y_UP") => DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::NEG_Y),
            Some("X_UP") => DMat3::from_cols(DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y),
            Some(other) => return wrong(axis.unwrap_or(self.root), format!("<up_axis> is '{other}'")),
        };
        Ok(DAffine3::from_mat3(turn * metre))
    }

    /// The element that an attribute `#id` refers to.
    fn referenced(&self, element: &Element, attribute: &str) -> Outcome<&'a Element> {
        let Some(reference) = element.attribute(attribute) else {
            return wrong(element, format!("<{}> has no '{attribute}'", element.name));
        };
        match self.by_id.get(reference.trim_start_matches('#')) {
            Some(found) => Ok(found),
            None => wrong(element, format!("there is nothing with the id '{reference}'")),
        }
    }

    fn node(&mut self, node: &'a Element, world_from_parent: DAffine3, parts: &mut Vec<Part>) -> Outcome<()> {
        // What stands on a camera's or lamp's node moves no triangle.
        let holds = |name: &str| {
            matches!(name, "node" | "instance_node" | "instance_geometry" | "instance_controller")
        };
        if !node.elements().any(|child| holds(&child.name)) {
            return Ok(());
        }
        if let Err(spent) = self.budget.take(1, 0).and_then(|()| self.budget.enter(1)) {
            return wrong(node, spent.to_string());
        }
        let mut world_from_node = world_from_parent;
        for child in node.elements() {
            if child.name == "skew" {
                self.left_out.push(Wrong(child.source.clone(), "<skew> is not read".into()));
            } else if let Some(transform) = transform(child)? {
                world_from_node *= transform;
            }
        }
        for child in node.elements() {
            match child.name.as_str() {
                "node" => self.node(child, world_from_node, parts)?,
                "instance_node" => self.node(self.referenced(child, "url")?, world_from_node, parts)?,
                "instance_geometry" => {
                    let materials = self.bound_materials(child);
                    let first = parts.len();
                    self.geometry(self.referenced(child, "url")?, world_from_node, &materials, parts)?;
                    // Gazebo knows a part by its node.
                    let names = ["name", "id"].iter().filter_map(|name| node.attribute(name));
                    for part in &mut parts[first..] {
                        part.aliases.extend(names.clone().map(str::to_owned));
                    }
                }
                "instance_controller" => self.skin(child, parts)?,
                _ => {}
            }
        }
        self.budget.leave(1);
        Ok(())
    }

    /// A skin in the pose that its mesh was bound in: no skeleton moves it.
    fn skin(&mut self, instance: &'a Element, parts: &mut Vec<Part>) -> Outcome<()> {
        let controller = self.referenced(instance, "url")?;
        let Some(skin) = controller.child("skin") else {
            self.left_out.push(Wrong(controller.source.clone(), "only skins are read of controllers".into()));
            return Ok(());
        };
        let bind_shape = skin.child("bind_shape_matrix").map(transform).transpose()?.flatten();
        let materials = self.bound_materials(instance);
        let geometry = self.referenced(skin, "source")?;
        // Where a skin is comes from its joints, not from the node that it stands on.
        let world_from_geometry = self.world_from_file()? * bind_shape.unwrap_or(DAffine3::IDENTITY);
        self.geometry(geometry, world_from_geometry, &materials, parts)
    }

    /// The materials that an instance gives to the symbols of its primitives.
    fn bound_materials(&mut self, instance: &'a Element) -> HashMap<&'a str, Material> {
        let mut materials = HashMap::new();
        let technique = instance.child("bind_material").and_then(|binding| binding.child("technique_common"));
        for bound in technique.iter().flat_map(|technique| technique.elements_named("instance_material")) {
            match self.look_of(bound) {
                Ok(look) => materials.extend(bound.attribute("symbol").zip(look)),
                Err(wrong) => self.left_out.push(wrong),
            }
        }
        materials
    }

    fn look_of(&self, bound: &Element) -> Outcome<Option<Material>> {
        let material = self.referenced(bound, "target")?;
        match material.child("instance_effect") {
            Some(effect) => self.effect(self.referenced(effect, "url")?),
            None => Ok(None),
        }
    }

    fn effect(&self, effect: &Element) -> Outcome<Option<Material>> {
        let Some(profile) = effect.child("profile_COMMON") else { return Ok(None) };
        let Some(shading) = profile.child("technique").and_then(|technique| {
            ["phong", "lambert", "blinn", "constant"].iter().find_map(|name| technique.child(name))
        }) else {
            return Ok(None);
        };
        let color = |name: &str| -> Outcome<Option<[f32; 3]>> {
            match shading.child(name).and_then(|part| part.child("color")) {
                Some(element) => rgba(element).map(|[r, g, b, _]| Some([r, g, b])),
                None => Ok(None),
            }
        };
        let shininess = shading.child("shininess").map(float).transpose()?.flatten();
        let (alpha, texture_alpha) = opacity(shading)?;
        let texture = shading.child("diffuse").and_then(|diffuse| diffuse.child("texture"));
        let picture = texture
            .and_then(|texture| texture.attribute("texture"))
            .and_then(|sampler| self.picture(profile, sampler));
        let (diffuse, emissive, specular) = (color("diffuse")?, color("emission")?, color("specular")?);
        let look = Look { diffuse, emissive, specular, shininess, alpha, texture_alpha, texture: picture };
        Ok(look.material())
    }

    /// The file behind a texture: sampler → surface → image (1.4), sampler → image (1.5), or the image itself.
    fn picture(&self, profile: &Element, sampler: &str) -> Option<PathBuf> {
        let parameter = |sid: &str| {
            profile.elements_named("newparam").find(|parameter| parameter.attribute("sid") == Some(sid))
        };
        let mut id = sampler;
        let source;
        if let Some(sampler) = parameter(sampler).and_then(|parameter| parameter.child("sampler2D")) {
            if let Some(image) = sampler.child("instance_image") {
                id = image.attribute("url")?.trim_start_matches('#');
            } else {
                let surface = parameter(&sampler.child("source")?.text())?.child("surface")?;
                source = surface.child("init_from")?.text();
                id = &source;
            }
        }
        let init = self.by_id.get(id)?.child("init_from")?;
        let file = init.child("ref").unwrap_or(init).text();
        let file = file.trim_start_matches("file://").replace('\\', "/").replace("%20", " ");
        (!file.is_empty()).then(|| file.into())
    }

    fn geometry(
        &mut self,
        geometry: &'a Element,
        world_from_geometry: DAffine3,
        materials: &HashMap<&str, Material>,
        parts: &mut Vec<Part>,
    ) -> Outcome<()> {
        let Some(mesh) = geometry.child("mesh") else { return Ok(()) };
        let mut copied = 0;
        for primitive in mesh.elements() {
            let polygons = match primitive.name.as_str() {
                "triangles" | "polylist" | "polygons" | "trifans" | "tristrips" => polygons(primitive)?,
                _ => continue,
            };
            let material = primitive.attribute("material").and_then(|symbol| materials.get(symbol)).cloned();
            let mut part = Part {
                name: geometry.attribute("id").unwrap_or_default().into(),
                aliases: geometry.attribute("name").map(str::to_owned).into_iter().collect(),
                material,
                ..Part::default()
            };
            self.triangulate(primitive, &polygons, world_from_geometry, &mut part)?;
            copied += size_of_val(&part.positions[..]) + size_of_val(&part.uvs[..]);
            parts.push(part);
        }
        if !self.taken.insert(std::ptr::from_ref(geometry))
            && let Err(spent) = self.budget.take(0, copied)
        {
            return wrong(geometry, spent.to_string());
        }
        Ok(())
    }

    fn inputs(&self, primitive: &'a Element) -> Outcome<(Input<'a>, Option<Input<'a>>, usize)> {
        let (mut vertex, mut texture, mut stride) = (None, None, 0);
        for input in primitive.elements_named("input") {
            let offset = offset(input)?;
            stride = stride.max(offset + 1);
            let source = self.referenced(input, "source")?;
            match input.attribute("semantic") {
                Some("VERTEX") => {
                    // Its source is <vertices>, which names that of the positions, and of others in step.
                    for inner in source.elements_named("input") {
                        let values = || values(self.referenced(inner, "source")?);
                        match inner.attribute("semantic") {
                            Some("POSITION") => vertex = Some(Input { offset, values: values()? }),
                            Some("TEXCOORD") => texture = Some(Input { offset, values: values()? }),
                            _ => {}
                        }
                    }
                }
                Some("TEXCOORD") if texture.is_none() => {
                    texture = Some(Input { offset, values: values(source)? });
                }
                _ => {}
            }
        }
        match vertex {
            Some(vertex) => Ok((vertex, texture, stride)),
            None => wrong(primitive, format!("<{}> has no positions", primitive.name)),
        }
    }

    /// Cuts polygons into fans of triangles, each corner a vertex of its own.
    fn triangulate(
        &self,
        primitive: &'a Element,
        polygons: &[Vec<usize>],
        world_from_geometry: DAffine3,
        part: &mut Part,
    ) -> Outcome<()> {
        let (vertex, texture, stride) = self.inputs(primitive)?;
        let mirrored = world_from_geometry.matrix3.determinant() < 0.0;
        for polygon in polygons {
            let first = part.positions.len() as u32;
            for corner in polygon.chunks_exact(stride) {
                let position: [f32; 3] = vertex.values.get(corner[vertex.offset])?;
                let point = DVec3::from_array(position.map(f64::from));
                part.positions.push(world_from_geometry.transform_point3(point).as_vec3().to_array());
                if let Some(texture) = &texture {
                    part.uvs.push(texture.values.get(corner[texture.offset])?);
                }
            }
            let corners = part.positions.len() as u32 - first;
            part.triangles.extend((2..corners).map(|i| {
                if mirrored { [first, first + i, first + i - 1] } else { [first, first + i - 1, first + i] }
            }));
        }
        Ok(())
    }
}

/// The colour of an element's text; opaque if it does not say.
fn rgba(element: &Element) -> Outcome<[f32; 4]> {
    match list::<f32>(element)?[..] {
        [r, g, b, ref rest @ ..] if [r, g, b].iter().chain(rest).all(|value| value.is_finite()) => {
            Ok([r, g, b, rest.first().copied().unwrap_or(1.0)])
        }
        _ => wrong(element, "a colour needs three finite numbers"),
    }
}

/// The number in an element's `<float>`, if there is one.
fn float(element: &Element) -> Outcome<Option<f32>> {
    let Some(float) = element.child("float") else { return Ok(None) };
    match list::<f32>(float)?[..] {
        [value] if value.is_finite() => Ok(Some(value)),
        _ => wrong(float, format!("<{}> needs one finite number", element.name)),
    }
}

/// How much of a surface is to be seen. Exporters disagree on what `<transparency>` alone means, so it counts only beside
/// a `<transparent>` that says how it is meant, as in Gazebo; with a picture there, the picture's alpha cuts out.
fn opacity(shading: &Element) -> Outcome<(Option<f32>, TextureAlpha)> {
    let transparent = shading.child("transparent");
    let Some((transparent, mode)) = transparent.and_then(|it| Some((it, it.attribute("opaque")?))) else {
        return Ok((None, TextureAlpha::Ignored));
    };
    if transparent.child("texture").is_some() {
        return Ok((None, TextureAlpha::CutOut { least: 0.5 }));
    }
    let share = shading.child("transparency").map(float).transpose()?.flatten().unwrap_or(1.0);
    let [r, g, b, a] = transparent.child("color").map(rgba).transpose()?.unwrap_or([1.0; 4]);
    let luminance = 0.212_671 * r + 0.715_160 * g + 0.072_169 * b;
    let alpha = match mode {
        "A_ONE" => a * share,
        "A_ZERO" => 1.0 - a * share,
        "RGB_ONE" => luminance * share,
        "RGB_ZERO" => 1.0 - luminance * share,
        _ => {
            return wrong(
                transparent,
                format!("opaque='{mode}' is none of A_ONE, A_ZERO, RGB_ONE, RGB_ZERO"),
            );
        }
    };
    Ok((Some(alpha), TextureAlpha::Ignored))
}
