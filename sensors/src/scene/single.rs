//! A single mesh as a scene, in memory that the caller provides.

use super::instance::{Instance, InstanceConfig, MeshId, Shape};
use super::material::{Material, MaterialConfig};
use super::tree::{Facet, TriangleBlock, WideNode};
use super::{Mesh, Scene, SceneError};
use crate::moment::Moment;
use crate::pose::Pose;
use crate::simd::WIDTH;

/// A scene of one mesh at the world's origin, visible to all sensors, in the default material. Nothing is copied, so
/// creating one takes no time. It is meant for code that keeps its own trees and casts rays at one of them.
///
/// It needs the feature `raw`; semantic versioning does not cover it.
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
    /// Creates the scene from a tree written by [`build`](super::build::build), and its
    /// [facets](super::build::fill_facets). Check a tree from another source with
    /// [`validate_tree`](super::validate_tree) first: with an invalid tree, tracing misses triangles or panics.
    ///
    /// # Errors
    /// [`SceneError::BadTree`] if there is no root, [`SceneError::BufferTooSmall`] if there are not sixteen facets per
    /// block, [`SceneError::TooMany`] if there are more than 2²⁷ blocks.
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

    /// Returns the moment at which the sensor has the pose `world_from_sensor`.
    pub fn moment(&self, world_from_sensor: Pose) -> Moment<'static> {
        Moment { world_from_sensor, world_from_instance: &[Pose::IDENTITY] }
    }

    /// Returns the scene, for use by sensors.
    pub fn scene(&self) -> Scene<'_> {
        // Vertex indices and texture coordinates are only read for textures, and there are none.
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
