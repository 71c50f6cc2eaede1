//! Skins of a glTF in their rest pose: the vertices are moved by the joints.

use super::accessor::{Accessors, Table};
use super::container::Container;
use crate::mesh::normals;
use glam::{DAffine3, DMat4, DVec3};
use serde_json::Value;

/// The transforms that the joints of a skin apply to its vertices.
pub(super) struct Skin {
    scene_from_bound: Vec<DAffine3>,
}

/// The joints that move the vertices of a primitive, and their weights.
pub(super) struct Bound<'a> {
    pub(super) joints: Table<'a, 4>,
    pub(super) weights: Table<'a, 4>,
}

impl Bound<'_> {
    /// Returns the joints of a vertex with their weights.
    pub(super) fn of(&self, vertex: usize) -> [(f64, f64); 4] {
        let (joints, weights) = (self.joints.get(vertex), self.weights.get(vertex));
        std::array::from_fn(|at| (joints[at], weights[at]))
    }
}

impl Skin {
    /// Reads a skin. `scene_from_node` has the pose of each node.
    ///
    /// # Errors
    /// A message about what is wrong with the skin.
    pub(super) fn read(
        container: &Container<'_>,
        accessors: &Accessors<'_>,
        index: &Value,
        scene_from_node: &[DAffine3],
    ) -> Result<Self, String> {
        let skin = container.entry("skins", index)?;
        let joints = skin["joints"].as_array().map_or(&[][..], Vec::as_slice);
        let bound: Vec<[f64; 16]> = match &skin["inverseBindMatrices"] {
            Value::Null => Vec::new(),
            matrices => accessors.read(matrices)?,
        };
        let joint = |(at, joint): (usize, &Value)| {
            let node = joint.as_u64().and_then(|node| scene_from_node.get(usize::try_from(node).ok()?));
            let node = node.ok_or_else(|| format!("joint {joint} is not a node"))?;
            let joint_from_bound = bound.get(at).map_or(DAffine3::IDENTITY, affine);
            Ok(*node * joint_from_bound)
        };
        Ok(Self { scene_from_bound: joints.iter().enumerate().map(joint).collect::<Result<_, String>>()? })
    }

    /// Returns the position of a vertex, from its joints and their weights.
    ///
    /// # Errors
    /// The vertex names a joint that the skin does not have.
    pub(super) fn place(&self, point: DVec3, bound: [(f64, f64); 4]) -> Result<DVec3, String> {
        let total: f64 = bound.iter().map(|(_, weight)| weight).sum();
        let mut placed = DVec3::ZERO;
        for (joint, weight) in bound.into_iter().filter(|(_, weight)| *weight != 0.0) {
            let scene_from_bound = self.scene_from_bound.get(joint as usize);
            let scene_from_bound = scene_from_bound
                .ok_or_else(|| format!("a vertex names joint {joint}, which the skin does not have"))?;
            placed += scene_from_bound.transform_point3(point) * (weight / total);
        }
        Ok(placed)
    }

    /// Returns the normal of a vertex, from its joints and their weights.
    pub(super) fn turn(&self, normal: DVec3, bound: [(f64, f64); 4]) -> [f32; 3] {
        let mut turned = DVec3::ZERO;
        for (joint, weight) in bound.into_iter().filter(|(_, weight)| *weight != 0.0) {
            if let Some(scene_from_bound) = self.scene_from_bound.get(joint as usize) {
                turned += normals::matrix(scene_from_bound.matrix3) * normal * weight;
            }
        }
        normals::unit(turned)
    }
}

/// Converts a matrix of a file, which is stored column by column.
pub(super) fn affine(columns: &[f64; 16]) -> DAffine3 {
    DAffine3::from_mat4(DMat4::from_cols_array(columns))
}
