//! A scene from slices that the caller provides.

use super::{
    Air, ColourSpace, Environment, HeightField, Instance, Light, Material, MeshSlices, Meshes, Scene,
    SceneFault, Texture, check,
};

/// The parts of a scene as slices that the caller provides, which needs no heap. Parts that are not set are empty.
///
/// ```
/// use belvedere_sensors::scene::build::{Scratch, max_size, scratch_len};
/// use belvedere_sensors::scene::tree::{Facet, TriangleBlock, WideNode};
/// use belvedere_sensors::trace::{CacheLine, Faces, Hits, Workspace, cast_grid};
/// use belvedere_sensors::optics::{Intrinsics, Pinhole, PinholeGrid};
/// use belvedere_sensors::{Execution, Moment, Pose, scene::*};
/// use bytemuck::Zeroable;
/// use belvedere_sensors::glam::DVec3;
///
/// // Two meshes, a wall of 2 m and a smaller one, built into arrays.
/// let wall = |half: f32| [[0.0, -half, -half], [0.0, half, -half], [0.0, half, half], [0.0, -half, half]];
/// let faces = [[0, 2, 1], [0, 3, 2]];
/// const MOST: usize = 2 * max_size(2).blocks;
/// let (mut meshes, mut uvs, mut triangles) = ([Mesh::zeroed(); 2], [[0.0; 2]; 8], [[0; 3]; 4]);
/// let (mut nodes, mut blocks) = ([WideNode::zeroed(); MOST], [TriangleBlock::zeroed(); MOST]);
/// let (mut facets, mut scratch) = ([Facet::zeroed(); 16 * MOST], [Scratch::zeroed(); scratch_len(2)]);
/// let mut store = MeshStore::new(MeshMemory {
///     meshes: &mut meshes,
///     uvs: &mut uvs,
///     normals: &mut [],
///     triangles: &mut triangles,
///     nodes: &mut nodes,
///     blocks: &mut blocks,
///     facets: &mut facets,
///     scratch: &mut scratch,
/// });
/// let execution = Execution::default();
/// let large = store.add(&wall(1.0), &[], &faces, execution)?;
/// let small = store.add(&wall(0.2), &[], &faces, execution)?;
///
/// // Three instances and where they are.
/// let of = |shape| Instance::new(&InstanceConfig { shape, ..Default::default() });
/// let instances = [of(Shape::Mesh(large))?, of(Shape::Mesh(small))?, of(Shape::Sphere { radius: 0.25 })?];
/// let poses = [DVec3::X * 3.0, DVec3::X * 2.0, DVec3::new(2.0, 1.0, 0.0)].map(Pose::from_translation);
/// let materials = [Material::new(&MaterialConfig::default())];
/// let slices = SceneSlices::new().meshes(store.meshes()).instances(&instances).materials(&materials);
/// let scene = Scene::from_slices(&slices).unwrap();
///
/// // Three rays, to the left, ahead and to the right.
/// let lens = Pinhole::new(Intrinsics { fx: 2.0, fy: 2.0, cx: 1.0, cy: 0.0, skew: 0.0 }).unwrap();
/// let optics = PinholeGrid::new(3, 1, lens).unwrap().into();
/// let moment = Moment { world_from_sensor: Pose::IDENTITY, world_from_instance: &poses };
/// let (mut distance, mut instance) = ([0.0; 3], [0; 3]);
/// let hits = Hits { distance: Some(&mut distance), instance: Some(&mut instance), ..Default::default() };
/// let mut workspace = Workspace { buffer: &mut [CacheLine::ZERO; 256], execution };
/// cast_grid(&scene, &moment, &optics, [0.1, 100.0], visibility::VISUAL, Faces::Front, &mut workspace, hits).unwrap();
/// assert_eq!(instance, [2, 1, u32::MAX]);
/// assert_eq!(distance[1], 2.0);
/// // A sphere with its centre on the ray.
/// assert!((f64::from(distance[0]) - (5_f64.sqrt() - 0.25)).abs() < 1e-6);
/// # Ok::<(), SceneError>(())
/// ```
#[derive(Debug, Clone, Copy, Default)]
#[non_exhaustive]
pub struct SceneSlices<'a> {
    /// Instances of shapes, meshes and height fields. Their poses are given by a [`Moment`](crate::Moment).
    pub instances: &'a [Instance],
    /// Meshes, from a [`MeshStore`](super::MeshStore) or checked by [`Meshes::new`].
    pub meshes: Meshes<'a>,
    /// Height fields, [placed](HeightField::at) so that the heights and extents of each follow those of the previous
    /// one.
    pub height_fields: &'a [HeightField],
    /// Heights of all height fields.
    pub heights: &'a [f32],
    /// Extents of all height fields, as [`HeightField::build`] fills them.
    pub extents: &'a [[f32; 2]],
    /// Materials; at least one if there is an instance.
    pub materials: &'a [Material],
    /// Textures; the texels of each follow those of the previous one.
    pub textures: &'a [Texture],
    /// Texels of all textures, with [all mip levels](super::fill_mip_levels) of each.
    pub texels: &'a [[u8; 4]],
    /// Lamps.
    pub lights: &'a [Light],
    /// Ambient light and background.
    pub environment: Environment,
    /// Fog and sky.
    pub air: Air,
    /// The colour space. In sRGB, fill the mip levels with [`fill_srgb_mip_levels`](super::fill_srgb_mip_levels).
    pub colour_space: ColourSpace,
}

impl<'a> SceneSlices<'a> {
    /// Creates the parts of an empty scene in Gazebo's default light.
    pub fn new() -> Self {
        Self::default()
    }

    setters! {
        /// Sets the instances.
        instances: &'a [Instance],
        /// Sets the meshes.
        meshes: Meshes<'a>,
        /// Sets the materials.
        materials: &'a [Material],
        /// Sets the lamps.
        lights: &'a [Light],
        /// Sets the ambient light and the background.
        environment: Environment,
        /// Sets fog and sky.
        air: Air,
        /// Sets the colour space.
        colour_space: ColourSpace,
    }

    /// Sets the height fields, and the heights and extents of all of them.
    #[must_use]
    pub const fn height_fields(
        mut self,
        fields: &'a [HeightField],
        heights: &'a [f32],
        extents: &'a [[f32; 2]],
    ) -> Self {
        (self.height_fields, self.heights, self.extents) = (fields, heights, extents);
        self
    }

    /// Sets the textures, and the texels of all of them.
    #[must_use]
    pub const fn textures(mut self, textures: &'a [Texture], texels: &'a [[u8; 4]]) -> Self {
        (self.textures, self.texels) = (textures, texels);
        self
    }
}

impl<'a> Scene<'a> {
    /// Creates a scene that borrows the given slices.
    ///
    /// Everything that tracing relies on is checked, in time proportional to the number of heights, instances,
    /// materials, textures and lamps.
    ///
    /// # Errors
    /// [`SceneFault`] names the slice, the element and what is wrong.
    pub fn from_slices(slices: &SceneSlices<'a>) -> Result<Self, SceneFault> {
        let MeshSlices { meshes, uvs, normals, triangles, nodes, blocks, facets } = slices.meshes.slices();
        let scene = Self {
            instances: slices.instances,
            meshes,
            uvs,
            normals,
            triangles,
            nodes,
            blocks,
            facets,
            height_fields: slices.height_fields,
            heights: slices.heights,
            extents: slices.extents,
            materials: slices.materials,
            textures: slices.textures,
            texels: slices.texels,
            lights: slices.lights,
            environment: slices.environment,
            air: slices.air,
            colour_space: slices.colour_space,
        };
        check::all_but_meshes(&scene)?;
        Ok(scene)
    }
}
