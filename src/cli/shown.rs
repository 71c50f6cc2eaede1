//! The models that a page shows, in addition to the streams.

use crate::description::model::Model;
use crate::gltf::{self, Thing};
use crate::simulation::SpawnOptions;

/// The models that a page shows.
pub(super) struct Shown {
    /// A binary glTF file.
    pub(super) scene: Vec<u8>,
    /// Namespace and plain URDF of each robot.
    pub(super) robots: Vec<(String, String)>,
}

impl Shown {
    /// Creates it from the robots' `descriptions`: (namespace, URDF).
    pub(super) fn new(
        world: &[Model],
        robots: &[(Model, SpawnOptions)],
        descriptions: Vec<(String, String)>,
    ) -> Self {
        let thing = |model, world_from_model, is_robot| -> Thing<'_> {
            let model: &Model = model;
            Thing { name: &model.name, model, world_from_model, is_robot }
        };
        let things = world.iter().map(|model| thing(model, model.world_from_model, false));
        let moving = robots.iter().map(|(model, options)| thing(model, options.world_from_model, true));
        Self { scene: gltf::write(things.chain(moving)), robots: descriptions }
    }
}
