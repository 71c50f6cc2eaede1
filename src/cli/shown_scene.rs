//! [`ShownScene`]: updates the page's models, and the descriptions of robots, when models are spawned or deleted.

use super::robot_descriptions::RobotDescriptions;
use crate::entities::{Entities, EntityId, Origin};
use crate::gltf::{self, Thing};
use crate::server::Server;
use crate::simulation::Simulation;
use crate::view::ViewServer;
use std::time::{Duration, Instant};

/// Interval at which the models are compared.
const LOOK: Duration = Duration::from_millis(200);

/// Keeps the models on a page, and the descriptions of robots, up to date.
pub(super) struct ShownScene<'a> {
    page: Option<&'a ViewServer>,
    descriptions: RobotDescriptions<'a>,
    known: Vec<EntityId>,
    next_look: Instant,
}

impl<'a> ShownScene<'a> {
    /// Starts with the current models, which the page, if there is one, already shows.
    pub(super) fn new(
        page: Option<&'a ViewServer>,
        descriptions: RobotDescriptions<'a>,
        simulation: &Simulation,
    ) -> Self {
        let known = ids(simulation.entities());
        Self { page, descriptions, known, next_look: Instant::now() + LOOK }
    }

    /// Updates all from time to time if models have been added or removed.
    pub(super) fn refresh(&mut self, server: &Server<'_>) {
        if self.descriptions.is_unused() || Instant::now() < self.next_look {
            return;
        }
        self.next_look = Instant::now() + LOOK;
        let simulation = server.simulation();
        let now = ids(simulation.entities());
        if now == self.known {
            return;
        }
        self.known = now;
        self.descriptions.update(server);
        let Some(page) = self.page else { return };
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

fn ids(entities: &Entities) -> Vec<EntityId> {
    entities.iter().map(|(id, _)| id).collect()
}
