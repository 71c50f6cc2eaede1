//! The page's models while a simulation runs: what is spawned comes, what is deleted goes.

use crate::entities::{EntityId, Origin};
use crate::gltf::{self, Thing};
use crate::simulation::Simulation;
use crate::view::ViewServer;
use std::time::{Duration, Instant};

/// Time between two looks.
const LOOK: Duration = Duration::from_millis(200);

/// Tells a page of models that come and go.
pub(super) struct ShownScene<'a> {
    page: Option<&'a ViewServer>,
    known: Vec<EntityId>,
    next_look: Instant,
}

impl<'a> ShownScene<'a> {
    /// The page, if there is one, shows those that are there now.
    pub(super) fn new(page: Option<&'a ViewServer>, simulation: &Simulation) -> Self {
        Self { page, known: everybody(simulation), next_look: Instant::now() + LOOK }
    }

    /// Looks from time to time who is there.
    pub(super) fn refresh(&mut self, simulation: &Simulation) {
        let Some(page) = self.page.filter(|_| Instant::now() >= self.next_look) else { return };
        self.next_look = Instant::now() + LOOK;
        let now = everybody(simulation);
        if now == self.known {
            return;
        }
        self.known = now;
        let things = simulation.entities().iter().map(|(id, entity)| Thing {
            name: &entity.name,
            model: &entity.model,
            world_from_model: simulation.physics().world_from_model(id.index()),
            is_robot: entity.origin == Origin::Start
                || entity.origin == Origin::Spawned && entity.robot.is_some(),
        });
        page.set_scene(gltf::write(things));
    }
}

fn everybody(simulation: &Simulation) -> Vec<EntityId> {
    simulation.entities().iter().map(|(id, _)| id).collect()
}
