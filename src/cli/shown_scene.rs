//! [`ShownScene`]: updates the page's models when models are spawned or deleted.

use crate::entities::{Entities, EntityId, Origin};
use crate::gltf::{self, Thing};
use crate::server::Server;
use crate::simulation::Simulation;
use crate::view::ViewServer;
use std::collections::HashMap;
use std::time::{Duration, Instant};

/// Interval at which the models are compared.
const LOOK: Duration = Duration::from_millis(200);

/// Keeps the models on a page up to date.
pub(super) struct ShownScene<'a> {
    page: Option<&'a ViewServer>,
    known: Vec<EntityId>,
    /// Robots whose description the page has, with their namespaces.
    described: HashMap<EntityId, String>,
    next_look: Instant,
}

impl<'a> ShownScene<'a> {
    /// Starts with the current models, which the page, if there is one, already shows.
    pub(super) fn new(page: Option<&'a ViewServer>, simulation: &Simulation) -> Self {
        let entities = simulation.entities();
        let is_described = |namespace: &str| page.is_some_and(|page| page.has_robot_description(namespace));
        let robots = entities.iter().filter(|(_, entity)| entity.origin == Origin::Start);
        let described = robots.filter(|(_, robot)| is_described(&robot.namespace));
        Self {
            page,
            known: ids(entities),
            described: described.map(|(id, robot)| (id, robot.namespace.clone())).collect(),
            next_look: Instant::now() + LOOK,
        }
    }

    /// Updates the page from time to time if models have been added or removed.
    pub(super) fn refresh(&mut self, server: &Server<'_>) {
        let Some(page) = self.page.filter(|_| Instant::now() >= self.next_look) else { return };
        self.next_look = Instant::now() + LOOK;
        let simulation = server.simulation();
        let now = ids(simulation.entities());
        if now == self.known {
            return;
        }
        self.known = now;
        self.describe(page, server);
        let things = simulation.entities().iter().map(|(id, entity)| Thing {
            name: &entity.name,
            model: &entity.model,
            world_from_model: simulation.physics().world_from_model(id.index()),
            is_robot: entity.origin == Origin::Start
                || entity.origin == Origin::Spawned && entity.robot.is_some(),
        });
        page.set_scene(gltf::write(things));
    }

    /// Gives the page the descriptions of new robots and removes those of deleted ones. If two robots share a
    /// namespace, the first is described.
    fn describe(&mut self, page: &ViewServer, server: &Server<'_>) {
        let entities = server.simulation().entities();
        for (_, namespace) in self.described.extract_if(|id, _| entities.get(*id).is_none()) {
            page.remove_robot_description(&namespace);
        }
        for (id, entity) in entities.iter() {
            if let Some(urdf) = server.description(id)
                && entity.robot.is_some()
                && !page.has_robot_description(&entity.namespace)
            {
                page.set_robot_description(&entity.namespace, urdf);
                self.described.insert(id, entity.namespace.clone());
            }
        }
    }
}

fn ids(entities: &Entities) -> Vec<EntityId> {
    entities.iter().map(|(id, _)| id).collect()
}
