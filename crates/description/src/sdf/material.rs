//! `<material>`: an Ogre script by name, colours, gloss, normals, and `<pbr>`.

use super::resources::Resolved;
use super::{Loader, Scope, TEXTURE};
use crate::file;
use crate::gazebo_materials::{gazebo_material, gazebo_material_names};
use crate::model::{Channel, Material, PbrMaps};
use crate::ogre_material::{self, Library, OgreMaterial};
use crate::values::{child_bool, child_text};
use crate::xml::Element;
use belvedere_sensors::scene::{MAX_SHININESS, Pbr, TextureAlpha};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// File extensions of the images that can be decoded.
const PICTURES: [&str; 6] = ["png", "jpg", "jpeg", "tga", "bmp", "dds"];

/// Prefix of the names of Gazebo's own materials.
const GAZEBO: &str = "Gazebo/";

/// SDF's default of `<roughness>` and of `<metalness>`.
const DEFAULT_PBR: f32 = 0.5;

/// How gz-sim interprets the alpha of an albedo map.
const PBR_ALPHA: TextureAlpha = TextureAlpha::CutOut { least: 0.5 };

impl Loader<'_> {
    /// Reads the material of a `<visual>`; none if the file gives none, so that a mesh keeps its own.
    ///
    /// As in Gazebo, colours override the script's. The albedo map is used if the script has no image, and the rest of
    /// `<pbr>` if there is no script, so that a world can have a script for Gazebo classic and `<pbr>` for its successors.
    pub(super) fn material(&mut self, visual: &Element, scope: Scope<'_>) -> Option<Material> {
        let element = visual.child("material")?;
        let has_pbr = workflow(element).is_some();
        let script = element.child("script").and_then(|script| self.script(script, has_pbr, scope));
        let rgba = self.rgba(element, "diffuse");
        let diffuse = rgba.map(|[r, g, b, _]| [r, g, b]);
        let ambient = self.color(element, "ambient");
        let emissive = self.color(element, "emissive");
        let specular = self.color(element, "specular");
        let shininess = self.within(element, "shininess", MAX_SHININESS);
        let texture = self.albedo_map(element, scope);
        let normal_map = self.normal_map(element, scope);
        self.tell_what_is_ignored(element);
        let (pbr, pbr_maps, emissive_map) = if script.is_none() {
            let (pbr, maps) = self.pbr(element, specular, scope).unzip();
            (pbr, maps.unwrap_or_default(), self.emissive_map(element, scope))
        } else {
            (None, PbrMaps::default(), None)
        };
        let says_a_colour = diffuse.or(ambient).or(emissive).or(specular).is_some();
        let says_a_map = texture.is_some() || normal_map.is_some();
        if script.is_none() && !says_a_colour && !says_a_map && pbr.is_none() {
            return None;
        }
        let mut material = script.unwrap_or_else(|| {
            // A single colour is used for both ambient and diffuse light. A texture without a colour is not tinted.
            let plain = if texture.is_some() { [1.0; 3] } else { Material::default().diffuse };
            let color = diffuse.or(ambient).unwrap_or(plain);
            Material { diffuse: color, ambient: color, ..Material::default() }
        });
        material.diffuse = diffuse.unwrap_or(material.diffuse);
        material.ambient = ambient.unwrap_or(material.ambient);
        material.emissive = emissive.unwrap_or(material.emissive);
        // Gazebo sets both together: a specular colour without a shininess switches the script's shininess off.
        material.shininess = shininess.unwrap_or(if specular.is_some() { 0.0 } else { material.shininess });
        material.specular = specular.unwrap_or(material.specular);
        (material.pbr, material.pbr_maps) = (pbr, pbr_maps);
        // As in Ogre, black is no factor.
        if emissive_map.is_some() && material.emissive == [0.0; 3] {
            material.emissive = [1.0; 3];
        }
        material.emissive_map = emissive_map;
        material.normal_map = normal_map;
        material.alpha = rgba.map_or(material.alpha, |[.., alpha]| alpha.min(1.0));
        if material.texture.is_none() && texture.is_some() {
            material.texture = texture;
            material.texture_alpha = PBR_ALPHA;
        }
        Some(material)
    }

    /// Adds a warning for each child of a `<material>` that is not drawn.
    fn tell_what_is_ignored(&mut self, material: &Element) {
        if child_bool(material, "lighting", self.diagnostics) == Some(false) {
            self.ignored(material.child("lighting").unwrap_or(material), "every surface is lit");
        }
        if child_bool(material, "double_sided", self.diagnostics) == Some(true) {
            self.ignored(material.child("double_sided").unwrap_or(material), "cameras see only outsides");
        }
    }

    /// Reads roughness and metalness with the defaults of SDF, and their maps. As in Ogre, a map is multiplied by the
    /// number, also by the default; and highlights by `specular`, the colour of the `<material>`.
    fn pbr(
        &mut self,
        material: &Element,
        specular: Option<[f32; 3]>,
        scope: Scope<'_>,
    ) -> Option<(Pbr, PbrMaps)> {
        let workflow = workflow(material)?;
        let highlights = specular.unwrap_or([1.0; 3]);
        if workflow.name == "specular" {
            let glossiness = self.within(workflow, "glossiness", 1.0).unwrap_or(0.0);
            let pbr = Pbr { roughness: 1.0 - glossiness, metalness: 0.0, highlights };
            return Some((pbr, PbrMaps::default()));
        }
        let [roughness, metalness] =
            ["roughness", "metalness"].map(|name| self.within(workflow, name, 1.0).unwrap_or(DEFAULT_PBR));
        let [of_roughness, of_metalness] = ["roughness_map", "metalness_map"].map(|name| {
            let map = workflow.child(name)?;
            Some(Channel { path: self.map(map, material, scope)?, channel: 0 })
        });
        let maps = PbrMaps { roughness: of_roughness, metalness: of_metalness };
        Some((Pbr { roughness, metalness, highlights }, maps))
    }

    fn emissive_map(&mut self, material: &Element, scope: Scope<'_>) -> Option<PathBuf> {
        let map = workflow(material)?.child("emissive_map")?;
        self.map(map, material, scope)
    }

    fn albedo_map(&mut self, material: &Element, scope: Scope<'_>) -> Option<PathBuf> {
        let map = workflow(material)?.child("albedo_map")?;
        self.map(map, material, scope)
    }

    /// Reads the normal map in tangent space: from a `<shader>`, as in Gazebo classic, or from `<pbr>`.
    fn normal_map(&mut self, material: &Element, scope: Scope<'_>) -> Option<PathBuf> {
        let shader = material.child("shader").filter(|shader| shader.child("normal_map").is_some());
        let map = match shader.map(|shader| (shader, shader.attribute("type"))) {
            Some((shader, Some("normal_map_tangent_space"))) => shader.child("normal_map"),
            Some((shader, Some("normal_map_object_space"))) => {
                self.ignored(shader, "only normals in tangent space are read: normal_map_tangent_space");
                None
            }
            _ => workflow(material).and_then(|workflow| workflow.child("normal_map")),
        }?;
        if map.attribute("type") == Some("object") {
            self.ignored(map, "only normals in tangent space are read: type=\"tangent\"");
            return None;
        }
        self.map(map, material, scope)
    }

    /// Returns the image that an element names.
    pub(super) fn map(&mut self, map: &Element, material: &Element, scope: Scope<'_>) -> Option<PathBuf> {
        let uri = map.text();
        if uri.is_empty() || uri == "__default__" {
            return None;
        }
        let mut folder = scope.folder.to_path_buf();
        if !uri.contains("://") && !folder.join(&uri).exists() {
            // Gazebo also searches the folders of the script, and its successors the model's materials/textures.
            let uris = material.child("script").into_iter().flat_map(|script| script.elements_named("uri"));
            let mut places = vec![folder.join("materials/textures")];
            for uri in uris {
                if let Resolved::Found(path) = self.resources.resolve(&uri.text(), scope.folder) {
                    places.extend([path.join("../textures"), path]);
                }
            }
            if let Some(found) = places.into_iter().find(|place| place.join(&uri).is_file()) {
                folder = found;
            }
        }
        let path = self.existing_file(map, &uri, &folder, TEXTURE)?;
        self.picture(map, path)
    }

    /// Returns the path if it names an image that can be decoded.
    fn picture(&mut self, element: &Element, path: PathBuf) -> Option<PathBuf> {
        let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
        if PICTURES.contains(&extension.to_ascii_lowercase().as_str()) {
            return Some(path);
        }
        self.missing_picture(
            &element.source,
            &format!("the texture {} has an unsupported format", path.display()),
            format!("convert it to one of {}", PICTURES.join(", ")),
        );
        None
    }

    /// Reads the material that a script names. If there is none, `has_pbr` says that the surface has another look.
    fn script(&mut self, script: &Element, has_pbr: bool, scope: Scope<'_>) -> Option<Material> {
        let name = child_text(script, "name").filter(|name| name != "__default__")?;
        // Gazebo's own names need no script, but a script of the user's may redefine them.
        let uris: Vec<&Element> = script.elements_named("uri").collect();
        let mut folders = Vec::new();
        let mut files = Vec::new();
        let mut places = Vec::new();
        for uri in &uris {
            match self.resources.resolve(&uri.text(), scope.folder) {
                Resolved::Found(path) => {
                    files.extend(script_files(&path));
                    folders.push(path);
                }
                Resolved::NotFound(looked) => places.extend(looked),
                Resolved::UnknownScheme(_) => {}
            }
        }
        let library = self.library(files);
        if let Some(found) = library.inherited(&name, self.diagnostics) {
            return Some(self.convert(&found, &folders, script));
        }
        if let Some(material) = gazebo_material(&name) {
            return Some(material);
        }
        if name.starts_with(GAZEBO) {
            // As for links in URDF: Gazebo's own names only give a colour, and a world can run without it.
            let names: Vec<String> = gazebo_material_names().collect();
            let known = names.iter().map(String::as_str).chain(library.names());
            let what = format!("Gazebo has no material '{name}': the shape keeps its own look");
            let remedy =
                self.diagnostics.did_you_mean_or(&name, known, "name one as Gazebo/Red, or write <diffuse>");
            self.diagnostics.warning(&script.source, what, remedy);
            return None;
        }
        let remedy = self.diagnostics.did_you_mean_or(
            &name,
            library.names(),
            "name the folder of its .material file in <uri>",
        );
        let looked = match uris.first() {
            None => "its <script> has no <uri>, and Gazebo has none of that name".into(),
            Some(_) if !places.is_empty() => format!("looked for {}", file::list(&places)),
            Some(_) if !folders.is_empty() => format!("it is not in {}", file::list(&folders)),
            Some(uri) => format!("'{}' cannot be fetched", uri.text()),
        };
        let what = format!("there is no material '{name}': {looked}");
        if has_pbr {
            // As gz-sim, which reads no scripts: the file is complete without it.
            self.diagnostics.warning(&script.source, format!("{what}; its <pbr> is drawn"), remedy);
        } else {
            self.missing(&script.source, what, remedy);
        }
        None
    }

    /// Returns the materials of these scripts.
    fn library(&mut self, files: Vec<PathBuf>) -> Arc<Library> {
        if let Some(known) = self.libraries.get(&files) {
            return known.clone();
        }
        let materials = files.iter().flat_map(|file| self.read_script(file).to_vec()).collect();
        let library = Arc::new(Library::new(materials));
        self.libraries.insert(files, library.clone());
        library
    }

    fn read_script(&mut self, file: &Path) -> Arc<Vec<OgreMaterial>> {
        if let Some(known) = self.material_scripts.get(file) {
            return known.clone();
        }
        self.diagnostics.opened(file);
        let materials = match ogre_material::parse_file(file) {
            Ok(materials) => materials,
            Err(problem) => {
                self.diagnostics.add(problem);
                Vec::new()
            }
        };
        let materials = Arc::new(materials);
        self.material_scripts.insert(file.to_path_buf(), materials.clone());
        materials
    }

    /// Converts an Ogre material and finds its texture: in the folders of the `<uri>`s, and in `textures` beside the
    /// script's folder.
    fn convert(&mut self, ogre: &OgreMaterial, uris: &[PathBuf], script: &Element) -> Material {
        let mut folders: Vec<PathBuf> = Vec::new();
        for path in uris.iter().map(PathBuf::as_path).chain([&*ogre.source.file]) {
            let folder = if path.is_dir() { path } else { path.parent().unwrap_or(Path::new("")) };
            folders.push(folder.to_path_buf());
            folders.push(folder.join("../textures"));
        }
        let texture = ogre.texture.as_ref().and_then(|(name, source)| {
            let places: Vec<PathBuf> = folders.iter().map(|folder| folder.join(name)).collect();
            let Some(found) = places.iter().find(|place| place.is_file()) else {
                self.missing_picture(
                    source,
                    &format!("there is no texture '{name}': looked for {}", file::list(&places)),
                    format!(
                        "put it there, or name its folder in a <uri> of the <script> at {}",
                        script.source
                    ),
                );
                return None;
            };
            let tidy = found.canonicalize().unwrap_or_else(|_| found.clone());
            self.picture(script, tidy)
        });
        Material {
            // Ogre's own default is white for both ambient and diffuse light.
            diffuse: ogre.diffuse.unwrap_or([1.0; 3]),
            ambient: ogre.ambient.unwrap_or([1.0; 3]),
            emissive: ogre.emissive.unwrap_or([0.0; 3]),
            specular: ogre.specular.map_or([0.0; 3], |[r, g, b, _]| [r, g, b]),
            shininess: ogre.specular.map_or(0.0, |[.., shininess]| shininess.clamp(0.0, MAX_SHININESS)),
            alpha: ogre.alpha.unwrap_or(1.0).clamp(0.0, 1.0),
            texture_alpha: ogre.texture_alpha.unwrap_or_default(),
            texture,
            texture_repeat: ogre.texture_repeat.unwrap_or([1.0; 2]),
            ..Material::default()
        }
    }
}

/// Returns the workflow of `<pbr>` that is read.
fn workflow(material: &Element) -> Option<&Element> {
    let pbr = material.child("pbr")?;
    pbr.child("metal").or_else(|| pbr.child("specular"))
}

/// Returns the script itself, or all scripts of a folder, sorted by name.
fn script_files(path: &Path) -> Vec<PathBuf> {
    if path.is_file() {
        return vec![path.to_path_buf()];
    }
    let mut files: Vec<PathBuf> = std::fs::read_dir(path)
        .into_iter()
        .flatten()
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|file| file.extension().is_some_and(|extension| extension == "material"))
        .collect();
    files.sort();
    files
}
