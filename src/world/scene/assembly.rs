//! [`Assembly`]: builds the sensors' scene from the shapes, materials and textures of links.

use crate::description::diagnostics::{Problem, Severity, Source};
use crate::description::housing::Part;
use crate::description::image_file;
use crate::description::model as description;
use crate::description::model::{Geometry, Heights, LinkIndex, Mesh, Optics, PbrMaps};
use crate::description::pbr_picture;
use crate::world::physics::ModelIndex;
use belvedere_sensors::Pose;
use belvedere_sensors::scene::{
    HeightFieldId, InstanceConfig, InstanceId, MaterialConfig, MaterialId, MeshId, SceneBuilder, SceneError,
    Shape, TextureAlpha, TextureId, TextureMode, visibility,
};
use glam::{DMat3, DQuat, DVec3};
use image::DynamicImage;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::PlacedFiducial;
use super::flags::flag_bits;

/// Edge length in metres of the rectangle that represents an infinite collision plane.
const INFINITE_M: f64 = 20_000.0;

/// An instance with its pose in its link, its shape and its material.
#[derive(Debug)]
pub(super) struct Placed {
    pub(super) instance: InstanceId,
    pub(super) link_from_shape: Pose,
    pub(super) shape: Shape,
    pub(super) material: MaterialId,
    /// The visual or collision of the link that it shows.
    pub(super) part: Part,
    /// Its visibility bits in the scene.
    pub(super) visibility: u32,
}

/// A scene that is being built. Files and meshes that are used several times are added once.
#[derive(Debug, Default)]
pub(super) struct Assembly {
    pub(super) builder: SceneBuilder,
    /// Textures by path, and true for opaque ones; `None` for an image that cannot be used.
    textures: HashMap<PathBuf, Option<(TextureId, bool)>>,
    normal_maps: HashMap<PathBuf, Option<TextureId>>,
    pbr_maps: HashMap<PbrMaps, Option<TextureId>>,
    /// Meshes by address, which is valid only while their models are borrowed.
    meshes: HashMap<*const Mesh, MeshId>,
    height_fields: HashMap<*const Heights, HeightFieldId>,
    /// Instances by model and link, which are looked up in each frame.
    pub(super) placed: Vec<Vec<Vec<Placed>>>,
    pub(super) fiducials: Vec<PlacedFiducial>,
    pub(super) bare: Option<MaterialId>,
    /// Warnings about images that cannot be used, until they are taken.
    pub(super) notes: Vec<Problem>,
}

impl Assembly {
    pub(super) fn add_link(
        &mut self,
        key: (ModelIndex, LinkIndex),
        link: &description::Link,
        world_from_link: &Pose,
    ) -> Result<(), Problem> {
        // Without a label, the class is the model's number in the simulator's list of models, starting at 1.
        let class = 1 + key.0 as u32;
        for (number, visual) in link.visuals.iter().enumerate() {
            let material = self.material(&visual.material, visual.optics, &visual.source)?;
            let (shape, shape_pose) = self.shape(&visual.geometry, false, &visual.source)?;
            let link_from_shape = visual.link_from_visual * shape_pose;
            let config = |world_from_instance| InstanceConfig {
                shape,
                world_from_instance,
                material,
                visibility: visibility::VISUAL | flag_bits(visual.visibility_flags),
                laser_retro: visual.laser_retro,
                class: visual.label.unwrap_or(class),
                ..Default::default()
            };
            let place = (key, Part::Visual(number));
            let instance = self.place(place, world_from_link, link_from_shape, &visual.source, config)?;
            self.fiducials.extend(visual.fiducials.iter().map(|tag| PlacedFiducial {
                instance: instance.0,
                instance_from_fiducial: shape_pose.inverse() * tag.visual_from_fiducial,
                family: tag.family.clone(),
                id: tag.id,
                size_m: tag.size_m,
            }));
        }
        for (number, collision) in link.collisions.iter().enumerate() {
            let is_plain = collision.optics == Optics::default();
            let bare = self.bare.filter(|_| is_plain);
            let material = match bare {
                Some(material) => material,
                None => {
                    self.material(&description::Material::default(), collision.optics, &collision.source)?
                }
            };
            if is_plain {
                self.bare = Some(material);
            }
            let (shape, shape_pose) = self.shape(&collision.geometry, true, &collision.source)?;
            let link_from_shape = collision.link_from_collision * shape_pose;
            let key = (key, Part::Collision(number));
            self.place(key, world_from_link, link_from_shape, &collision.source, |world_from_instance| {
                InstanceConfig {
                    shape,
                    world_from_instance,
                    material,
                    visibility: visibility::COLLISION,
                    laser_retro: collision.laser_retro,
                    class,
                    ..Default::default()
                }
            })?;
        }
        Ok(())
    }

    fn place(
        &mut self,
        (key, part): ((ModelIndex, LinkIndex), Part),
        world_from_link: &Pose,
        link_from_shape: Pose,
        source: &Source,
        config: impl FnOnce(Pose) -> InstanceConfig,
    ) -> Result<InstanceId, Problem> {
        let config = config(*world_from_link * link_from_shape);
        let instance = self.builder.add_instance(&config).map_err(|error| refused(error, source))?;
        let InstanceConfig { shape, material, visibility, .. } = config;
        let (model, link) = key;
        if self.placed.len() <= model {
            self.placed.resize_with(model + 1, Vec::new);
        }
        let links = &mut self.placed[model];
        if links.len() <= link {
            links.resize_with(link + 1, Vec::new);
        }
        links[link].push(Placed { instance, link_from_shape, shape, material, part, visibility });
        Ok(instance)
    }

    pub(super) fn set_pose(&mut self, key: (ModelIndex, LinkIndex), world_from_link: &Pose) {
        for Placed { instance, link_from_shape, .. } in of_link(&self.placed, key) {
            // This fails only for a pose that is not finite: a body that physics has lost keeps its last pose.
            let _ = self.builder.set_pose(*instance, *world_from_link * *link_from_shape);
        }
    }

    /// Returns the shape and its pose in the frame of the visual or collision.
    fn shape(
        &mut self,
        geometry: &Geometry,
        collides: bool,
        source: &Source,
    ) -> Result<(Shape, Pose), Problem> {
        let upright = |shape| (shape, Pose::IDENTITY);
        Ok(match geometry {
            Geometry::Box { size } => upright(Shape::Box { size: size.to_array() }),
            Geometry::Sphere { radius } => upright(Shape::Sphere { radius: *radius }),
            Geometry::Cylinder { radius, length } => {
                upright(Shape::Cylinder { radius: *radius, length: *length })
            }
            Geometry::Capsule { radius, length } => {
                upright(Shape::Capsule { radius: *radius, length: *length })
            }
            Geometry::Plane { normal, size } => {
                let size = if collides { [INFINITE_M; 2] } else { *size };
                (Shape::Rectangle { size }, Pose::new(DVec3::ZERO, facing(*normal)))
            }
            Geometry::Ellipsoid { radii } => upright(Shape::Ellipsoid { radii: radii.to_array() }),
            Geometry::Cone { radius, length } => upright(Shape::Cone { radius: *radius, length: *length }),
            Geometry::Mesh(mesh) => upright(Shape::Mesh(self.mesh(mesh, source)?)),
            Geometry::HeightMap(map) => {
                let field = self.height_field(&map.heights, source)?;
                (Shape::HeightField(field), Pose::from_translation(map.offset))
            }
        })
    }

    /// Forgets the addresses of meshes and height maps: after their models are dropped, others may get the same
    /// addresses.
    pub(super) fn forget_files(&mut self) {
        self.meshes.clear();
        self.height_fields.clear();
    }

    fn mesh(&mut self, mesh: &Arc<Mesh>, source: &Source) -> Result<MeshId, Problem> {
        if let Some(known) = self.meshes.get(&Arc::as_ptr(mesh)) {
            return Ok(*known);
        }
        let wrong = |error| refused(error, &Source { file: mesh.path.as_path().into(), ..source.clone() });
        let added = self.builder.add_mesh(&mesh.positions, &mesh.uvs, &mesh.triangles).map_err(wrong)?;
        self.builder.set_mesh_normals(added, &mesh.normals).map_err(wrong)?;
        self.meshes.insert(Arc::as_ptr(mesh), added);
        Ok(added)
    }

    fn height_field(&mut self, heights: &Arc<Heights>, source: &Source) -> Result<HeightFieldId, Problem> {
        if let Some(known) = self.height_fields.get(&Arc::as_ptr(heights)) {
            return Ok(*known);
        }
        let [rows, columns] = heights.grid;
        let added = self.builder.add_height_field(rows, columns, heights.size, &heights.metres);
        let added = added.map_err(|error| {
            refused(error, &Source { file: heights.path.as_path().into(), ..source.clone() })
        })?;
        self.height_fields.insert(Arc::as_ptr(heights), added);
        Ok(added)
    }

    fn material(
        &mut self,
        material: &description::Material,
        optics: Optics,
        source: &Source,
    ) -> Result<MaterialId, Problem> {
        let found = material.texture.as_deref().and_then(|path| self.texture(path, source));
        let normal_map = material.normal_map.as_deref().and_then(|path| self.normal_map(path, source));
        let pbr_map = self.pbr_map(&material.pbr_maps, source);
        let glow = material.emissive_map.as_deref().map(|path| self.texture(path, source));
        // Without its map, the whole surface would emit light.
        let emissive = if glow == Some(None) { [0.0; 3] } else { material.emissive };
        let (texture, is_opaque) = found.map_or((None, true), |(texture, opaque)| (Some(texture), opaque));
        let texture_alpha = if is_opaque { TextureAlpha::Ignored } else { material.texture_alpha };
        let config = MaterialConfig {
            diffuse: material.diffuse,
            ambient: material.ambient,
            emissive,
            specular: material.specular,
            shininess: material.shininess,
            pbr: material.pbr,
            alpha: material.alpha,
            texture_alpha,
            specular_reflectance: optics.specular_reflectance,
            transmittance: optics.transmittance,
            normal_map,
            pbr_map,
            emissive_map: glow.flatten().map(|(texture, _)| texture),
            texture,
            cube_texture: None,
            texture_mode: TextureMode::Reflectance,
            texture_repeat: material.texture_repeat,
        };
        self.builder.add_material(&config).map_err(|error| refused(error, source))
    }

    /// Returns the normal map from an image, or `None`, after a warning, if the image cannot be used.
    fn normal_map(&mut self, path: &Path, source: &Source) -> Option<TextureId> {
        if let Some(known) = self.normal_maps.get(path) {
            return *known;
        }
        let added = open(path, source).and_then(|picture| {
            let texels: &[[u8; 4]] = bytemuck::cast_slice(picture.as_raw());
            let added = self.builder.add_normal_map(picture.width(), picture.height(), texels);
            added.map_err(|error| unused(path, source, &error))
        });
        let added = added.map_err(|problem| self.notes.push(problem)).ok();
        self.normal_maps.insert(path.to_path_buf(), added);
        added
    }

    /// Returns the map of roughness and metalness; `None` if there is none, or, after a warning, if it cannot be used.
    fn pbr_map(&mut self, maps: &PbrMaps, source: &Source) -> Option<TextureId> {
        if let Some(known) = self.pbr_maps.get(maps) {
            return *known;
        }
        let notes = &mut self.notes;
        let picture = pbr_picture::picture(maps, |path, error| notes.push(unused(path, source, error)));
        let added = picture.and_then(|picture| {
            let texels: &[[u8; 4]] = bytemuck::cast_slice(picture.as_raw());
            let added = self.builder.add_pbr_map(picture.width(), picture.height(), texels);
            let path = maps.paths().next().map_or(Path::new(""), PathBuf::as_path);
            added.map_err(|error| self.notes.push(unused(path, source, &error))).ok()
        });
        self.pbr_maps.insert(maps.clone(), added);
        added
    }

    /// Returns the texture from an image, and whether all of it is opaque; or `None`, after a warning, if the image
    /// cannot be used.
    fn texture(&mut self, path: &Path, source: &Source) -> Option<(TextureId, bool)> {
        if let Some(known) = self.textures.get(path) {
            return *known;
        }
        let added = open(path, source).and_then(|picture| {
            let texels: &[[u8; 4]] = bytemuck::cast_slice(picture.as_raw());
            let added = self.builder.add_texture(picture.width(), picture.height(), texels);
            let added = added.map_err(|error| unused(path, source, &error))?;
            Ok((added, texels.iter().all(|texel| texel[3] == u8::MAX)))
        });
        let added = added.map_err(|problem| self.notes.push(problem)).ok();
        self.textures.insert(path.to_path_buf(), added);
        added
    }
}

/// Returns the instances of a link.
pub(super) fn of_link(placed: &[Vec<Vec<Placed>>], (model, link): (ModelIndex, LinkIndex)) -> &[Placed] {
    placed.get(model).and_then(|links| links.get(link)).map_or(&[], Vec::as_slice)
}

fn open(path: &Path, source: &Source) -> Result<image::RgbaImage, Problem> {
    let picture = image_file::open(path).map_err(|error| unused(path, source, &error))?;
    Ok(rgba(picture))
}

/// Converts an image to four channels of eight bits. The usual formats are widened directly, because the library
/// converts all formats via floats, which took a third of the time of loading a world.
fn rgba(picture: DynamicImage) -> image::RgbaImage {
    let (width, height) = (picture.width(), picture.height());
    let mut texels = vec![u8::MAX; width as usize * height as usize * 4];
    let (wide, _) = texels.as_chunks_mut::<4>();
    match &picture {
        DynamicImage::ImageLuma8(grey) => {
            for (texel, &value) in wide.iter_mut().zip(grey.as_raw()) {
                texel[..3].fill(value);
            }
        }
        DynamicImage::ImageRgb8(colours) => {
            for (texel, colour) in wide.iter_mut().zip(colours.as_raw().as_chunks::<3>().0) {
                texel[..3].copy_from_slice(colour);
            }
        }
        _ => return picture.into_rgba8(),
    }
    // This cannot fail, because the number of bytes matches the size.
    image::RgbaImage::from_raw(width, height, texels).unwrap_or_else(|| picture.into_rgba8())
}

/// Returns the warning about an image that cannot be used. As in Gazebo, the surface is drawn without it.
fn unused(path: &Path, source: &Source, error: &dyn std::error::Error) -> Problem {
    Problem {
        severity: Severity::Warning,
        source: source.clone(),
        what: format!(
            "the picture {} cannot be used, so the surface is drawn without it: {error}",
            path.display()
        ),
        remedy: "use a PNG, JPEG, TGA, BMP or DDS picture".into(),
    }
}

/// Returns the rotation that turns a rectangle's outside (+z) to `normal`. Its texture then lies as on the face of a
/// box with the same normal.
fn facing(normal: DVec3) -> DQuat {
    let normal = normal.normalize_or(DVec3::Z);
    let (right, up) = if normal.z.abs() > 0.999 {
        (DVec3::X, normal.cross(DVec3::X).normalize())
    } else {
        let right = DVec3::Z.cross(normal).normalize();
        (right, normal.cross(right))
    };
    DQuat::from_mat3(&DMat3::from_cols(up.cross(normal).normalize_or(right), up, normal))
}

pub(super) fn refused(error: SceneError, source: &Source) -> Problem {
    Problem {
        severity: Severity::Error,
        source: source.clone(),
        what: format!("cannot be shown: {error}"),
        remedy: "correct the shape, or remove it".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_that_cannot_be_used_is_left_out_with_a_warning() {
        let folder = tempfile::tempdir().unwrap();
        let torn = folder.path().join("torn.png");
        std::fs::write(&torn, b"\x89PNG\r\n\x1a\n").unwrap();
        let (source, mut assembly) = (Source::new("w.sdf", 3), Assembly::default());
        for path in [torn, folder.path().join("gone.png")] {
            let problem = open(&path, &source).unwrap_err();
            assert!(problem.to_string().starts_with("w.sdf:3: warning: the picture "), "{problem}");
            let material = description::Material {
                texture: Some(path.clone()),
                normal_map: Some(path),
                ..description::Material::default()
            };
            assert!(assembly.material(&material, Optics::default(), &source).is_ok());
        }
    }

    #[test]
    fn pictures_are_widened_as_the_library_does() {
        let values = |channels: usize| (0..256 * channels).map(|at| (at * 7 % 256) as u8).collect();
        let kinds = [
            DynamicImage::ImageLuma8(image::GrayImage::from_raw(16, 16, values(1)).unwrap()),
            DynamicImage::ImageRgb8(image::RgbImage::from_raw(16, 16, values(3)).unwrap()),
            DynamicImage::ImageRgba8(image::RgbaImage::from_raw(16, 16, values(4)).unwrap()),
        ];
        for picture in kinds {
            assert!(rgba(picture.clone()) == picture.to_rgba8(), "{:?}", picture.color());
        }
    }

    #[test]
    fn planes_are_oriented_like_the_faces_of_boxes() {
        // Normal, right, up: the table of `sensors::scene`.
        for (normal, right, up) in [
            (DVec3::Z, DVec3::X, DVec3::Y),
            (DVec3::NEG_Z, DVec3::X, DVec3::NEG_Y),
            (DVec3::X, DVec3::Y, DVec3::Z),
            (DVec3::NEG_X, DVec3::NEG_Y, DVec3::Z),
            (DVec3::Y, DVec3::NEG_X, DVec3::Z),
            (DVec3::NEG_Y, DVec3::X, DVec3::Z),
        ] {
            let turn = facing(normal);
            assert!((turn * DVec3::Z - normal).length() < 1e-12);
            assert!((turn * DVec3::X - right).length() < 1e-12, "{normal}: right is {}", turn * DVec3::X);
            assert!((turn * DVec3::Y - up).length() < 1e-12, "{normal}: up is {}", turn * DVec3::Y);
        }
    }
}
