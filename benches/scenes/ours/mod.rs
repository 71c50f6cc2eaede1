//! Belvedere's side: only this module uses the tracing interface.

mod cast;
mod frames;

pub use cast::{Caster, Wanted};
pub use frames::{DepthFrames, Moving};

use super::Mesh;
use belvedere_sensors::scene::build::{Quality, Tree as WideTree};
use belvedere_sensors::scene::{InstanceConfig, MaterialConfig, SceneBuilder, Shape, visibility};
use belvedere_sensors::simd::Level;
use belvedere_sensors::{Execution, Pose};

/// The tree of a mesh, without a scene.
pub struct Tree(WideTree);

impl Tree {
    pub fn new(mesh: &Mesh, level: Level) -> Self {
        let tree = WideTree::build(&mesh.vertices, &mesh.triangles, Quality::High, Execution::at(level));
        Self(tree.expect("our own mesh"))
    }

    /// Refits the tree to moved vertices.
    pub fn refit(&mut self, vertices: &[[f32; 3]], triangles: &[[u32; 3]], level: Level) {
        self.0.refit(vertices, triangles, Execution::at(level)).expect("our own mesh");
    }
}

/// A scene of one mesh.
pub struct Built {
    builder: SceneBuilder,
}

impl Built {
    /// Builds the tree.
    pub fn new(mesh: &Mesh) -> Self {
        let mut builder = SceneBuilder::new();
        let material = builder.add_material(&MaterialConfig::default()).expect("a plain material");
        let mesh = builder.add_mesh(&mesh.vertices, &[], &mesh.triangles).expect("our own mesh");
        let instance = InstanceConfig {
            shape: Shape::Mesh(mesh),
            world_from_instance: Pose::IDENTITY,
            scale: [1.0; 3],
            material,
            visibility: visibility::VISUAL | visibility::COLLISION,
            ..InstanceConfig::default()
        };
        builder.add_instance(&instance).expect("our own instance");
        Self { builder }
    }
}
