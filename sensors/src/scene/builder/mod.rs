//! An owned scene whose elements can be added, changed and removed.

mod instances;
mod looks;
mod packed;
mod pool;
mod shapes;
mod table;

use super::limits;
use super::tree::{Facet, TriangleBlock, WideNode};
use super::{
    Air, ColourSpace, Environment, HeightField, Instance, Light, Material, Mesh, Scene, SceneError, Sky,
    Texture,
};
use crate::moment::Moment;
use crate::pose::Pose;
use alloc::vec::Vec;
pub(super) use packed::Packed;
use pool::Pool;
use table::Table;

/// Owns a scene's data, which [`SceneBuilder::scene`] lends, and the current pose of each instance, which
/// [`SceneBuilder::moment`] lends.
///
/// Everything that is added has an id, which stays valid until it is removed. By its id it can be replaced (`set_…`)
/// and removed (`remove_…`). The memory and the id of something that was removed are reused, so things can come and go
/// indefinitely. What is still in use cannot be removed: remove instances first, then their meshes and materials, then
/// the textures of these.
///
/// ```
/// use belvedere_sensors::scene::*;
/// let mut builder = SceneBuilder::new();
/// let grey = builder.add_material(&MaterialConfig::default())?;
/// let ball = builder.add_instance(&InstanceConfig {
///     shape: Shape::Sphere { radius: 0.5 },
///     material: grey,
///     ..Default::default()
/// })?;
/// assert_eq!(builder.scene().instances().len(), 1);
/// let error = builder.remove_material(grey).unwrap_err();
/// assert_eq!(error, SceneError::InUse { user: "instance", index: 0 });
/// builder.remove_instance(ball)?;
/// builder.remove_material(grey)?;
/// # Ok::<(), SceneError>(())
/// ```
#[derive(Debug, Default, Clone)]
pub struct SceneBuilder {
    instances: Table<Instance>,
    /// Pose of each instance.
    poses: Vec<Pose>,
    /// Total number of slots of all instances, kept as a sum so that adding an instance takes constant time.
    slots: u64,
    meshes: Table<Mesh>,
    uvs: Pool<[f32; 2]>,
    /// One per element of `uvs`, or empty as long as no mesh has normals.
    normals: Vec<[f32; 3]>,
    triangles: Pool<[u32; 3]>,
    nodes: Pool<WideNode>,
    blocks: Pool<TriangleBlock>,
    /// Sixteen per block.
    facets: Vec<Facet>,
    height_fields: Table<HeightField>,
    heights: Pool<f32>,
    extents: Pool<[f32; 2]>,
    materials: Table<Material>,
    textures: Table<Texture>,
    texels: Pool<[u8; 4]>,
    lights: Table<Light>,
    environment: Environment,
    air: Air,
    colour_space: ColourSpace,
}

impl SceneBuilder {
    /// Creates an empty scene in Gazebo's default light.
    pub fn new() -> Self {
        Self::default()
    }

    /// The poses of all instances, in the order of their indices.
    pub fn poses(&self) -> &[Pose] {
        &self.poses
    }

    /// Returns the moment with the current poses of the instances, and the sensor at `world_from_sensor`.
    pub fn moment(&self, world_from_sensor: Pose) -> Moment<'_> {
        Moment { world_from_sensor, world_from_instance: &self.poses }
    }

    /// Sets the ambient light and the background.
    pub fn set_environment(&mut self, environment: Environment) {
        self.environment = environment;
    }

    /// Sets fog and sky.
    ///
    /// # Errors
    /// [`SceneError::BadAir`]; [`SceneError::NoSuchTexture`] and [`SceneError::WrongTexture`] for a sky of a texture.
    pub fn set_air(&mut self, air: Air) -> Result<(), SceneError> {
        limits::air(&air)?;
        limits::texture_of_sky(&air, |texture| self.textures.get(texture))?;
        let old = core::mem::replace(&mut self.air, air);
        if let Some(Sky::Cube(texture)) = air.sky {
            self.textures.use_one(texture.0);
        }
        if let Some(Sky::Cube(texture)) = old.sky {
            self.textures.leave_one(texture.0);
        }
        Ok(())
    }

    /// Lends the scene to sensors. An instance that was removed is replaced by one that no sensor sees.
    pub fn scene(&self) -> Scene<'_> {
        Scene {
            instances: self.instances.items(),
            meshes: self.meshes.items(),
            uvs: self.uvs.items(),
            normals: &self.normals,
            triangles: self.triangles.items(),
            nodes: self.nodes.items(),
            blocks: self.blocks.items(),
            facets: &self.facets,
            height_fields: self.height_fields.items(),
            heights: self.heights.items(),
            extents: self.extents.items(),
            materials: self.materials.items(),
            textures: self.textures.items(),
            texels: self.texels.items(),
            lights: self.lights.items(),
            environment: self.environment,
            air: self.air,
            colour_space: self.colour_space,
        }
    }

    /// Number of bytes of everything that the scene holds, including free memory within it.
    pub fn memory_len(&self) -> usize {
        let scene = self.scene();
        size_of_val(scene.instances)
            + size_of_val(self.poses())
            + size_of_val(scene.meshes)
            + size_of_val(scene.uvs)
            + size_of_val(scene.normals)
            + size_of_val(scene.triangles)
            + size_of_val(scene.nodes)
            + size_of_val(scene.blocks)
            + size_of_val(scene.facets)
            + size_of_val(scene.height_fields)
            + size_of_val(scene.heights)
            + size_of_val(scene.extents)
            + size_of_val(scene.materials)
            + size_of_val(scene.textures)
            + size_of_val(scene.texels)
            + size_of_val(scene.lights)
    }
}

/// Returns an element of a table, or the error `missing` if it does not exist, or that of `user` if it is in use.
fn unused<T: Copy>(
    table: &Table<T>,
    index: u32,
    missing: SceneError,
    user: impl FnOnce() -> SceneError,
) -> Result<T, SceneError> {
    let item = *table.get(index).ok_or(missing)?;
    if table.uses(index) == Some(0) { Ok(item) } else { Err(user()) }
}

fn room<T: Copy>(table: &Table<T>) -> Result<(), SceneError> {
    if table.has_room() { Ok(()) } else { Err(SceneError::TooMany) }
}
