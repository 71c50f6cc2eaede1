//! The page's models while a simulation runs: what is spawned comes, what is deleted goes.

use crate::entities::{Entities, EntityId, Origin};
use crate::gltf::{self, Thing};
use crate::server::Server;
use crate::simulation::Simulation;
use crate::view::ViewServer;
use std::collections::HashMap;
use std::time::{Duration, Instant};

/// Time between two looks.
const LOOK: Duration = Duration::from_millis(200);

/// Tells a page of models that come and go.
pub(super) struct ShownScene<'a> {
    page: Option<&'a ViewServer>,
    known: Vec<EntityId>,
    /// Robots that the page has a description of, and their namespaces.
    described: HashMap<EntityId, String>,
    next_look: Instant,
}

impl<'a> ShownScene<'a> {
    /// Begins with the models that are there now, which the page, if there is one, shows already.
    pub(super) fn new(page: Option<&'a ViewServer>, simulation: &Simulation) -> Self {
        let entities = simulation.entities();
        let is_described = |namespace: &str| page.is_some_and(|page| page.has_robot_description(namespace));
        let robots = entities.iter().filter(|(_, entity)| entity.origin == Origin::Start);
        let described = robots.filter(|(_, robot)| is_described(&robot.namespace));
        Self {
            page,
            known: everybody(entities),
            described: described.map(|(id, robot)| (id, robot.namespace.clone())).collect(),
            next_look: Instant::now() + LOOK,
        }
    }

    /// Looks from time to time who is there.
    pub(super) fn refresh(&mut self, server: &Server<'_>) {
        let Some(page) = self.page.filter(|_| Instant::now() >= self.next_look) else { return };
        self.next_look = Instant::now() + LOOK;
        let simulation = server.simulation();
        let now = everybody(simulation.entities());
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

    /// Gives the page the descriptions of robots that came, and takes back those of robots that are gone. Of two robots in
    /// one namespace the first is described.
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

fn everybody(entities: &Entities) -> Vec<EntityId> {
    entities.iter().map(|(id, _)| id).collect()
}
