//! One mesh as a scene of its own, over memory of the caller's.

use super::instance::{Instance, InstanceConfig, MeshId, Shape};
use super::material::{Material, MaterialConfig};
use super::tree::{Facet, TriangleBlock, WideNode};
use super::{Mesh, Scene, SceneError};
use crate::moment::Moment;
use crate::pose::Pose;
use crate::simd::WIDTH;

/// A mesh that stands at the world's origin, seen by all sensors, in the default material. Nothing is copied, so
/// making one takes no time: for who keeps trees in memory of his own and casts rays at one of them.
///
/// ```
/// use belvedere_sensors::scene::build::{Quality, Tree};
/// use belvedere_sensors::{Execution, scene::MeshScene};
/// let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let tree = Tree::build(&corners, &[[0, 1, 2]], Quality::High, Execution::default())?;
/// let facets = tree.facets();
/// let mesh = MeshScene::new(&tree.nodes, &tree.blocks, &facets)?;
/// assert_eq!(mesh.scene().instances().len(), 1);
/// # Ok::<(), belvedere_sensors::scene::SceneError>(())
/// ```
#[derive(Debug)]
pub struct MeshScene<'a> {
    meshes: [Mesh; 1],
    instances: [Instance; 1],
    materials: [Material; 1],
    nodes: &'a [WideNode],
    blocks: &'a [TriangleBlock],
    facets: &'a [Facet],
}

impl<'a> MeshScene<'a> {
    /// Takes a tree as [`build`](super::build::build) writes it, with its
    /// [facets](super::build::fill_facets). A tree from elsewhere is for [`validate_tree`](super::validate_tree)
    /// to check first: a bad one makes tracing miss triangles, or panic.
    ///
    /// # Errors
    /// [`SceneError::BadTree`] without a root, [`SceneError::BufferTooSmall`] when there are not sixteen facets
    /// for each block, [`SceneError::TooMany`] for more than 2²⁷ blocks.
    pub fn new(
        nodes: &'a [WideNode],
        blocks: &'a [TriangleBlock],
        facets: &'a [Facet],
    ) -> Result<Self, SceneError> {
        let root = nodes.first().ok_or(SceneError::BadTree(0))?;
        if blocks.len() >= (1 << 31) / WIDTH || nodes.len() > u32::MAX as usize {
            return Err(SceneError::TooMany);
        }
        let need = blocks.len() * WIDTH;
        if facets.len() < need {
            return Err(SceneError::BufferTooSmall { buffer: "facets", have: facets.len(), need });
        }
        let [min, max] = root.bounds();
        let mesh = Mesh {
            first_vertex: 0,
            vertices: 0,
            first_triangle: 0,
            triangles: 0,
            first_node: 0,
            nodes: nodes.len() as u32,
            first_block: 0,
            blocks: blocks.len() as u32,
            min,
            max,
        };
        let instance =
            Instance::new(&InstanceConfig { shape: Shape::Mesh(MeshId(0)), ..Default::default() })?;
        Ok(Self {
            meshes: [mesh],
            instances: [instance],
            materials: [Material::new(&MaterialConfig::default())],
            nodes,
            blocks,
            facets,
        })
    }

    /// The moment at which a sensor is at `world_from_sensor`.
    pub fn moment(&self, world_from_sensor: Pose) -> Moment<'static> {
        Moment { world_from_sensor, world_from_instance: &[Pose::IDENTITY] }
    }

    /// Lends the scene to sensors.
    pub fn scene(&self) -> Scene<'_> {
        // Only textures ask for the vertices of triangles and their coordinates, and there is none.
        Scene {
            instances: &self.instances,
            meshes: &self.meshes,
            nodes: self.nodes,
            blocks: self.blocks,
            facets: self.facets,
            materials: &self.materials,
            ..Scene::EMPTY
        }
    }
}
