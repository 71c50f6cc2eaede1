//! An owned scene that grows.

use super::build::{Quality, Tree};
use super::texture::{TextureId, fill_mip_levels, mip_levels, mip_texels};
use super::tree::{Facet, TriangleBlock, WIDTH, WideNode};
use super::{
    Environment, HeightField, HeightFieldId, Instance, InstanceConfig, InstanceId, KIND_HEIGHT_FIELD,
    KIND_MESH, Light, LightConfig, Material, MaterialConfig, MaterialId, Mesh, MeshId, NO_TEXTURE, Scene,
    SceneError, Texture,
};
use crate::execution::Execution;
use crate::pose::Pose;
use alloc::vec;
use alloc::vec::Vec;

/// Owns a scene's data; [`SceneBuilder::scene`] lends it.
///
/// ```
/// use belvedere_sensors::scene::*;
/// let mut builder = SceneBuilder::new();
/// let grey = builder.add_material(&MaterialConfig::default())?;
/// builder.add_instance(&InstanceConfig {
///     shape: Shape::Sphere { radius: 0.5 },
///     material: grey,
///     ..Default::default()
/// })?;
/// assert_eq!(builder.scene().instances().len(), 1);
/// # Ok::<(), SceneError>(())
/// ```
#[derive(Debug, Default, Clone)]
pub struct SceneBuilder {
    instances: Vec<Instance>,
    meshes: Vec<Mesh>,
    uvs: Vec<[f32; 2]>,
    triangles: Vec<[u32; 3]>,
    nodes: Vec<WideNode>,
    blocks: Vec<TriangleBlock>,
    facets: Vec<Facet>,
    height_fields: Vec<HeightField>,
    heights: Vec<f32>,
    extents: Vec<[f32; 2]>,
    materials: Vec<Material>,
    textures: Vec<Texture>,
    texels: Vec<[u8; 4]>,
    lights: Vec<Light>,
    environment: Environment,
}

impl SceneBuilder {
    /// An empty scene in Gazebo's default light.
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes in a picture of `width` × `height` RGBA texels, top row first, and makes its mip levels.
    ///
    /// # Errors
    /// [`SceneError::BadTexture`], [`SceneError::TooMany`].
    pub fn add_texture(
        &mut self,
        width: u32,
        height: u32,
        rgba8: &[[u8; 4]],
    ) -> Result<TextureId, SceneError> {
        if width == 0 || height == 0 || rgba8.len() as u64 != u64::from(width) * u64::from(height) {
            return Err(SceneError::BadTexture);
        }
        let first_texel =
            index(self.texels.len() + mip_texels(width, height))? - mip_texels(width, height) as u32;
        self.texels.extend_from_slice(rgba8);
        self.texels.resize(first_texel as usize + mip_texels(width, height), [0; 4]);
        fill_mip_levels(width, height, &mut self.texels[first_texel as usize..]);
        self.textures.push(Texture { first_texel, width, height, levels: mip_levels(width, height) });
        Ok(TextureId(index(self.textures.len() - 1)?))
    }

    /// Takes in a material.
    ///
    /// # Errors
    /// [`SceneError::NoSuchTexture`].
    pub fn add_material(&mut self, config: &MaterialConfig) -> Result<MaterialId, SceneError> {
        let material = Material::new(config);
        if material.texture != NO_TEXTURE && material.texture as usize >= self.textures.len() {
            return Err(SceneError::NoSuchTexture);
        }
        self.materials.push(material);
        Ok(MaterialId(index(self.materials.len() - 1)?))
    }

    /// Takes in triangles, counter-clockwise seen from outside, and builds their tree. `uvs` holds one texture
    /// coordinate per vertex, or none at all.
    ///
    /// # Errors
    /// Those of [`Tree::build`], [`SceneError::UvCount`].
    pub fn add_mesh(
        &mut self,
        positions: &[[f32; 3]],
        uvs: &[[f32; 2]],
        triangles: &[[u32; 3]],
    ) -> Result<MeshId, SceneError> {
        if !uvs.is_empty() && uvs.len() != positions.len() {
            return Err(SceneError::UvCount);
        }
        let tree = Tree::build(positions, triangles, Quality::High, Execution::default())?;
        let bounds = tree.bounds();
        let mesh = Mesh {
            first_vertex: index(self.uvs.len())?,
            vertices: index(positions.len())?,
            first_triangle: index(self.triangles.len())?,
            triangles: index(triangles.len())?,
            first_node: index(self.nodes.len())?,
            nodes: index(tree.nodes.len())?,
            first_block: index(self.blocks.len())?,
            blocks: index(tree.blocks.len())?,
            min: bounds[0],
            max: bounds[1],
        };
        let vertices = self.uvs.len() + positions.len();
        index(vertices)?;
        index((self.blocks.len() + tree.blocks.len()) * WIDTH)?;
        self.nodes.extend_from_slice(&tree.nodes);
        self.blocks.extend_from_slice(&tree.blocks);
        self.facets.extend_from_slice(&tree.facets());
        self.triangles.extend_from_slice(triangles);
        self.uvs.extend_from_slice(uvs);
        self.uvs.resize(vertices, [0.0; 2]);
        self.meshes.push(mesh);
        Ok(MeshId(index(self.meshes.len() - 1)?))
    }

    /// Takes in a terrain of `rows` × `columns` heights in metres, row by row from +y to −y, each row from −x to
    /// +x. `size` are its full lengths along x and y; z = 0 is where the height is 0.
    ///
    /// # Errors
    /// Those of [`HeightField::build`].
    pub fn add_height_field(
        &mut self,
        rows: u32,
        columns: u32,
        size: [f64; 2],
        heights: &[f32],
    ) -> Result<HeightFieldId, SceneError> {
        let first_height = index(self.heights.len())?;
        let first_extent = index(self.extents.len())?;
        index(self.heights.len() + heights.len())?;
        // Nothing is allocated for a grid whose heights are not there.
        let fits = u64::from(rows) * u64::from(columns) == heights.len() as u64;
        let need = if fits { HeightField::extents_len(rows, columns) } else { 0 };
        index(self.extents.len() + need)?;
        let mut extents = vec![[0.0; 2]; need];
        let mut field = HeightField::build(rows, columns, size, heights, &mut extents)?;
        (field.first_height, field.first_extent) = (first_height, first_extent);
        self.heights.extend_from_slice(heights);
        self.extents.extend_from_slice(&extents);
        self.height_fields.push(field);
        Ok(HeightFieldId(index(self.height_fields.len() - 1)?))
    }

    /// Takes in an instance.
    ///
    /// # Errors
    /// Those of [`Instance::new`], [`SceneError::NoSuchMesh`], [`SceneError::NoSuchHeightField`],
    /// [`SceneError::NoSuchMaterial`].
    pub fn add_instance(&mut self, config: &InstanceConfig) -> Result<InstanceId, SceneError> {
        let instance = self.check_instance(config)?;
        self.instances.push(instance);
        Ok(InstanceId(index(self.instances.len() - 1)?))
    }

    fn check_instance(&self, config: &InstanceConfig) -> Result<Instance, SceneError> {
        let instance = Instance::new(config)?;
        if instance.kind == KIND_MESH && instance.mesh as usize >= self.meshes.len() {
            return Err(SceneError::NoSuchMesh);
        }
        if instance.kind == KIND_HEIGHT_FIELD && instance.mesh as usize >= self.height_fields.len() {
            return Err(SceneError::NoSuchHeightField);
        }
        if instance.material as usize >= self.materials.len() {
            return Err(SceneError::NoSuchMaterial);
        }
        // Slots of all instances together are counted in 31 bits.
        let scene = self.scene();
        let slots = self.instances.iter().map(|instance| u64::from(scene.slots(instance))).sum::<u64>();
        if slots + u64::from(scene.slots(&instance)) >= 1 << 31 {
            return Err(SceneError::TooMany);
        }
        Ok(instance)
    }

    /// Puts another instance in the place of one; its id stays.
    ///
    /// # Errors
    /// [`SceneError::NoSuchInstance`], and those of [`SceneBuilder::add_instance`].
    pub fn set_instance(&mut self, instance: InstanceId, config: &InstanceConfig) -> Result<(), SceneError> {
        let checked = self.check_instance(config)?;
        *self.instances.get_mut(instance.0 as usize).ok_or(SceneError::NoSuchInstance)? = checked;
        Ok(())
    }

    /// Sets which sensors see an instance; with 0 none does.
    ///
    /// # Errors
    /// [`SceneError::NoSuchInstance`].
    pub fn set_visibility(&mut self, instance: InstanceId, visibility: u32) -> Result<(), SceneError> {
        self.instances.get_mut(instance.0 as usize).ok_or(SceneError::NoSuchInstance)?.visibility =
            visibility;
        Ok(())
    }

    /// Where an instance stands; none if there is no such.
    pub fn pose(&self, instance: InstanceId) -> Option<Pose> {
        Some(self.instances.get(instance.0 as usize)?.world_from_instance)
    }

    /// Moves an instance.
    ///
    /// # Errors
    /// [`SceneError::NoSuchInstance`], [`SceneError::BadPose`].
    pub fn set_pose(&mut self, instance: InstanceId, world_from_instance: Pose) -> Result<(), SceneError> {
        if !world_from_instance.is_finite() {
            return Err(SceneError::BadPose);
        }
        let slot = self.instances.get_mut(instance.0 as usize).ok_or(SceneError::NoSuchInstance)?;
        slot.world_from_instance = world_from_instance;
        Ok(())
    }

    /// Takes in a lamp.
    pub fn add_light(&mut self, config: &LightConfig) {
        self.lights.push(Light::new(config));
    }

    /// Sets ambient light and background.
    pub fn set_environment(&mut self, environment: Environment) {
        self.environment = environment;
    }

    /// Lends the scene to sensors.
    pub fn scene(&self) -> Scene<'_> {
        Scene {
            instances: &self.instances,
            meshes: &self.meshes,
            uvs: &self.uvs,
            triangles: &self.triangles,
            nodes: &self.nodes,
            blocks: &self.blocks,
            facets: &self.facets,
            height_fields: &self.height_fields,
            heights: &self.heights,
            extents: &self.extents,
            materials: &self.materials,
            textures: &self.textures,
            texels: &self.texels,
            lights: &self.lights,
            environment: self.environment,
        }
    }
}

fn index(count: usize) -> Result<u32, SceneError> {
    u32::try_from(count).map_err(|_| SceneError::TooMany)
}
