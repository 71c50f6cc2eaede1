//! What the sensors see of the world: its shapes, looks and lamps as a `sensors` scene, kept in step with physics.

use crate::description::diagnostics::{Problem, Severity, Source};
use crate::description::housing::{Part, ShapeIndex};
use crate::description::model as description;
use crate::description::model::{Geometry, LinkIndex, Mesh, Model, World};
use crate::world::physics::{ModelIndex, Physics};
use belvedere_sensors::scene::{
    ColourSpace, Environment, InstanceConfig, InstanceId, LightConfig, LightKind, MaterialConfig, MaterialId,
    MeshId, Scene, SceneBuilder, SceneError, Shape, TextureAlpha, TextureId, visibility,
};
use belvedere_sensors::{Moment, Pose};
use glam::{DMat3, DQuat, DVec3};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Edge length of the rectangle that stands for an infinite collision plane, in metres.
const INFINITE_M: f64 = 20_000.0;

/// The bit of visibility of what no sensor sees.
const HIDDEN: u32 = 1 << 31;

/// The scene of a running world.
#[derive(Debug)]
pub struct WorldScene {
    assembly: Assembly,
    stamp_ns: Option<u64>,
    edition: u64,
}

impl WorldScene {
    /// Builds the scene of a world, whose links stand where `physics` has them now.
    ///
    /// # Errors
    /// A texture that cannot be read, or a shape that cannot be traced; the problem names its place in the file.
    pub fn new(world: &World, physics: &Physics) -> Result<Self, Problem> {
        let mut assembly = Assembly::default();
        assembly
            .builder
            .set_environment(Environment { ambient: world.ambient, background: world.background });
        let space = if world.linear_light { ColourSpace::Srgb } else { ColourSpace::AsGiven };
        assembly.builder.set_colour_space(space);
        for (index, model) in world.models.iter().enumerate() {
            for (link_index, link) in model.links.iter().enumerate() {
                let world_from_link = physics.world_from_link(index, link_index);
                assembly.add_link((index, link_index), link, &world_from_link)?;
            }
        }
        for light in &world.lights {
            let added = assembly.builder.add_light(&lamp(light, world.shadows));
            added.map_err(|error| refused(error, &light.source))?;
        }
        assembly.meshes.clear();
        Ok(Self { assembly, stamp_ns: None, edition: 0 })
    }

    /// Moves everything that moves to where it is at a time between the last two physics steps.
    pub fn move_to(&mut self, physics: &Physics, stamp_ns: u64) {
        if self.stamp_ns == Some(stamp_ns) {
            return;
        }
        self.stamp_ns = Some(stamp_ns);
        for (model, link, world_from_link) in physics.moving_links_at(stamp_ns) {
            self.assembly.set_pose((model, link), &world_from_link);
        }
    }

    /// Takes over where physics has everything now, also what never moves by itself: after it was moved by hand.
    pub fn replace(&mut self, physics: &Physics) {
        self.stamp_ns = None;
        for model in 0..self.assembly.placed.len() {
            self.replace_model(model, physics);
        }
    }

    /// The same of one model.
    pub fn replace_model(&mut self, model: ModelIndex, physics: &Physics) {
        self.stamp_ns = None;
        for link in 0..self.assembly.placed.get(model).map_or(0, Vec::len) {
            self.assembly.set_pose((model, link), &physics.world_from_link(model, link));
        }
    }

    /// Adds a model whose frame is at `world_from_model`.
    ///
    /// # Errors
    /// As [`WorldScene::new`]; nothing of it is seen then.
    pub fn add_model(
        &mut self,
        index: ModelIndex,
        model: &Model,
        world_from_model: &Pose,
    ) -> Result<(), Problem> {
        self.stamp_ns = None;
        self.edition += 1;
        let added = model.links.iter().enumerate().try_for_each(|(number, link)| {
            self.assembly.add_link((index, number), link, &(*world_from_model * link.model_from_link))
        });
        self.assembly.meshes.clear();
        if added.is_err() {
            self.remove_model(index);
        }
        added
    }

    /// Lets rays pass through shapes of a model, or no more.
    pub fn hide(&mut self, model: ModelIndex, shapes: &[ShapeIndex], hidden: bool) {
        for (link, part) in shapes {
            let seen = match part {
                // Not 0, so that nothing else of the scene changes.
                _ if hidden => HIDDEN,
                Part::Visual(_) => visibility::VISUAL,
                Part::Collision(_) => visibility::COLLISION,
            };
            let placed = of_link(&self.assembly.placed, (model, *link)).iter();
            for placed in placed.filter(|placed| placed.part == *part) {
                // It is there.
                let _ = self.assembly.builder.set_visibility(placed.instance, seen);
            }
        }
    }

    /// Lets a model be seen no more. Its places and memory in the scene are used again.
    pub fn remove_model(&mut self, index: ModelIndex) {
        self.edition += 1;
        let assembly = &mut self.assembly;
        let links = assembly.placed.get_mut(index).map(std::mem::take).unwrap_or_default();
        let mut gone: Vec<_> = links.into_iter().flatten().collect();
        assembly.fiducials.retain(|tag| gone.iter().all(|placed| placed.instance.0 != tag.instance));
        // The last first: the places of the first are those that are used again first.
        gone.sort_unstable_by_key(|placed| std::cmp::Reverse(placed.instance.0));
        for placed in &gone {
            // It is there.
            let _ = assembly.builder.remove_instance(placed.instance);
        }
        // What others use as well, or is gone already, is refused.
        for Placed { shape, material, .. } in gone {
            if let Shape::Mesh(mesh) = shape {
                let _ = assembly.builder.remove_mesh(mesh);
            }
            if assembly.bare != Some(material) {
                let _ = assembly.builder.remove_material(material);
            }
        }
    }

    /// The moment at which everything is where it was moved last, and a sensor at `world_from_sensor`.
    pub fn moment(&self, world_from_sensor: Pose) -> Moment<'_> {
        self.assembly.builder.moment(world_from_sensor)
    }

    /// Where all instances are.
    pub fn poses(&self) -> &[Pose] {
        self.assembly.builder.poses()
    }

    /// A number that is another one after models were added or taken out: instances are others then.
    pub fn edition(&self) -> u64 {
        self.edition
    }

    /// Appends where all instances were at an earlier time, as far back as physics remembers.
    pub fn poses_at(&self, physics: &Physics, time_ns: u64, poses: &mut Vec<Pose>) {
        let first = poses.len();
        poses.extend_from_slice(self.poses());
        for (model, link, world_from_link) in physics.moving_links_at(time_ns) {
            for placed in of_link(&self.assembly.placed, (model, link)) {
                let pose = world_from_link * placed.link_from_shape;
                if pose.is_finite() {
                    poses[first + placed.instance.0 as usize] = pose;
                }
            }
        }
    }

    /// The tags that there are, in the order in which they were added.
    pub fn fiducials(&self) -> &[PlacedFiducial] {
        &self.assembly.fiducials
    }

    /// What there is to see.
    pub fn scene(&self) -> Scene<'_> {
        self.assembly.builder.scene()
    }
}

/// A tag of a visual that is seen.
#[derive(Debug, Clone)]
pub struct PlacedFiducial {
    /// Index of the instance that bears it.
    pub instance: u32,
    /// Pose of its middle in the instance: x to the right and y up as one reads it, z towards the reader.
    pub instance_from_fiducial: Pose,
    /// As the file says: `tag36h11`, `qr`.
    pub family: String,
    /// Its number in the family.
    pub id: u32,
    /// Edge of its square without the white margin.
    pub size_m: f64,
}

/// An instance, where it is in its link, and what it is made of.
#[derive(Debug)]
struct Placed {
    instance: InstanceId,
    link_from_shape: Pose,
    shape: Shape,
    material: MaterialId,
    /// What it is of the link.
    part: Part,
}

/// A scene being put together; files and meshes that are used twice are taken in once.
#[derive(Debug, Default)]
struct Assembly {
    builder: SceneBuilder,
    /// By path, with whether they are opaque.
    textures: HashMap<PathBuf, (TextureId, bool)>,
    normal_maps: HashMap<PathBuf, TextureId>,
    /// By address: only for as long as the models that they are of are borrowed.
    meshes: HashMap<*const Mesh, MeshId>,
    /// By model and link: all that move are looked up in each frame.
    placed: Vec<Vec<Vec<Placed>>>,
    fiducials: Vec<PlacedFiducial>,
    bare: Option<MaterialId>,
}

impl Assembly {
    fn add_link(
        &mut self,
        key: (ModelIndex, LinkIndex),
        link: &description::Link,
        world_from_link: &Pose,
    ) -> Result<(), Problem> {
        // Without a label, a thing's class is its model: its place, from 1, in the simulator's list of models.
        let class = 1 + key.0 as u32;
        for (number, visual) in link.visuals.iter().enumerate() {
            let material = self.material(&visual.material, &visual.source)?;
            let (shape, shape_pose) = self.shape(&visual.geometry, false, &visual.source)?;
            let link_from_shape = visual.link_from_visual * shape_pose;
            let config = |world_from_instance| InstanceConfig {
                shape,
                world_from_instance,
                material,
                visibility: visibility::VISUAL,
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
            let material = match self.bare {
                Some(material) => material,
                None => self.material(&description::Material::default(), &collision.source)?,
            };
            self.bare = Some(material);
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
        let InstanceConfig { shape, material, .. } = config;
        let (model, link) = key;
        if self.placed.len() <= model {
            self.placed.resize_with(model + 1, Vec::new);
        }
        let links = &mut self.placed[model];
        if links.len() <= link {
            links.resize_with(link + 1, Vec::new);
        }
        links[link].push(Placed { instance, link_from_shape, shape, material, part });
        Ok(instance)
    }

    fn set_pose(&mut self, key: (ModelIndex, LinkIndex), world_from_link: &Pose) {
        for Placed { instance, link_from_shape, .. } in of_link(&self.placed, key) {
            // Fails only for a pose that is not finite: what physics lost keeps its last place.
            let _ = self.builder.set_pose(*instance, *world_from_link * *link_from_shape);
        }
    }

    /// The shape and its pose in the frame of the visual or collision.
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
            Geometry::Mesh(mesh) => upright(Shape::Mesh(self.mesh(mesh, source)?)),
        })
    }

    fn mesh(&mut self, mesh: &Arc<Mesh>, source: &Source) -> Result<MeshId, Problem> {
        if let Some(known) = self.meshes.get(&Arc::as_ptr(mesh)) {
            return Ok(*known);
        }
        let added = self.builder.add_mesh(&mesh.positions, &mesh.uvs, &mesh.triangles).map_err(|error| {
            refused(error, &Source { file: mesh.path.as_path().into(), ..source.clone() })
        })?;
        self.meshes.insert(Arc::as_ptr(mesh), added);
        Ok(added)
    }

    fn material(&mut self, material: &description::Material, source: &Source) -> Result<MaterialId, Problem> {
        let found = material.texture.as_deref().map(|path| self.texture(path, source)).transpose()?;
        let normal_map =
            material.normal_map.as_deref().map(|path| self.normal_map(path, source)).transpose()?;
        let (texture, is_opaque) = found.map_or((None, true), |(texture, opaque)| (Some(texture), opaque));
        let texture_alpha = if is_opaque { TextureAlpha::Ignored } else { material.texture_alpha };
        let config = MaterialConfig {
            diffuse: material.diffuse,
            ambient: material.ambient,
            emissive: material.emissive,
            specular: material.specular,
            shininess: material.shininess,
            alpha: material.alpha,
            texture_alpha,
            normal_map,
            texture,
            texture_repeat: material.texture_repeat,
        };
        self.builder.add_material(&config).map_err(|error| refused(error, source))
    }

    fn normal_map(&mut self, path: &Path, source: &Source) -> Result<TextureId, Problem> {
        if let Some(known) = self.normal_maps.get(path) {
            return Ok(*known);
        }
        let picture = open(path, source)?;
        let texels: &[[u8; 4]] = bytemuck::cast_slice(picture.as_raw());
        let added = self.builder.add_normal_map(picture.width(), picture.height(), texels);
        let added = added.map_err(|error| refused(error, source))?;
        self.normal_maps.insert(path.to_path_buf(), added);
        Ok(added)
    }

    /// A picture, and whether all of it is opaque.
    fn texture(&mut self, path: &Path, source: &Source) -> Result<(TextureId, bool), Problem> {
        if let Some(known) = self.textures.get(path) {
            return Ok(*known);
        }
        let picture = open(path, source)?;
        let texels: &[[u8; 4]] = bytemuck::cast_slice(picture.as_raw());
        let added = self
            .builder
            .add_texture(picture.width(), picture.height(), texels)
            .map_err(|error| refused(error, source))?;
        let found = (added, texels.iter().all(|texel| texel[3] == u8::MAX));
        self.textures.insert(path.to_path_buf(), found);
        Ok(found)
    }
}

/// What was placed of a link.
fn of_link(placed: &[Vec<Vec<Placed>>], (model, link): (ModelIndex, LinkIndex)) -> &[Placed] {
    placed.get(model).and_then(|links| links.get(link)).map_or(&[], Vec::as_slice)
}

fn open(path: &Path, source: &Source) -> Result<image::RgbaImage, Problem> {
    let picture = image::open(path).map_err(|error| Problem {
        severity: Severity::Error,
        source: source.clone(),
        what: format!("texture {} cannot be read: {error}", path.display()),
        remedy: "use a PNG, JPEG, TGA or BMP picture".into(),
    })?;
    Ok(picture.into_rgba8())
}

/// The rotation that turns a rectangle's outside (+z) to `normal`, the picture on it as on the face of a box that
/// looks the same way.
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

fn lamp(light: &description::Light, shadows: bool) -> LightConfig {
    let position = light.world_from_light.translation().to_array();
    let direction = light.world_from_light.transform_vector(light.direction).to_array();
    let kind = match light.kind {
        description::LightKind::Point => LightKind::Point { position },
        description::LightKind::Directional => LightKind::Directional { direction },
        description::LightKind::Spot { inner_angle, outer_angle, falloff } => LightKind::Spot {
            position,
            direction,
            cos_inner: (inner_angle * 0.5).cos() as f32,
            cos_outer: (outer_angle * 0.5).cos() as f32,
            falloff: falloff as f32,
        },
    };
    LightConfig {
        kind,
        diffuse: light.diffuse,
        specular: light.specular,
        range_m: light.range_m as f32,
        attenuation: light.attenuation.map(|factor| factor as f32),
        cast_shadows: shadows && light.cast_shadows,
    }
}

fn refused(error: SceneError, source: &Source) -> Problem {
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
    fn planes_face_as_boxes_do() {
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
