//! The contents of a world: a scene, and bodies that move as one.

use crate::errors::value_error;
use crate::load::warnings;
use belvedere::description::load::Described;
use belvedere::description::model;
use belvedere::entities::Entities;
use belvedere::simulation::{Simulation, SpawnOptions};
use belvedere_sensors::Pose;
use belvedere_sensors::scene::{InstanceConfig, InstanceId, MaterialConfig, SceneBuilder};
use pyo3::PyResult;
use std::collections::HashMap;

/// The contents of a world. Running batches keep theirs while the world is changed.
#[derive(Debug, Clone, Default)]
pub(crate) struct Data {
    pub(crate) builder: SceneBuilder,
    pub(crate) bodies: Vec<Body>,
    /// Numbers of bodies by name; the first one if several share a name.
    by_name: HashMap<String, usize>,
    /// The largest number whose name `body_…` is taken or was skipped.
    named: usize,
}

/// A body, which moves as one.
#[derive(Debug, Clone)]
pub(crate) struct Body {
    pub(crate) name: String,
    /// Its pose in the world.
    pub(crate) pose: Pose,
    /// Its instances, and their poses in its frame.
    pub(crate) parts: Vec<(InstanceId, Pose)>,
    /// How it was added, if it was added by Python.
    pub(crate) origin: Option<Box<Origin>>,
}

/// How a body was added: its shape and its surface, which copies share.
#[derive(Debug, Clone)]
pub(crate) struct Origin {
    pub(crate) instance: InstanceConfig,
    pub(crate) material: MaterialConfig,
}

impl Data {
    /// Returns what the sensors of a simulation see now.
    pub(crate) fn of_simulation(simulation: &mut Simulation) -> Self {
        let names = names(simulation.entities());
        let scene = simulation.scene();
        let builder = scene.builder().clone();
        let parts: Vec<_> = scene.parts().collect();
        let mut made = Self { builder, ..Self::default() };
        let mut last = None;
        for (model, link, instance, body_from_part) in parts {
            if last != Some((model, link)) {
                last = Some((model, link));
                let world_from_part = made.builder.pose(instance).unwrap_or_default();
                let name =
                    names.get(model).and_then(|(_, links)| links.get(link)).cloned().unwrap_or_default();
                let pose = world_from_part * body_from_part.inverse();
                made.push(Body { name, pose, parts: Vec::new(), origin: None });
            }
            if let Some(body) = made.bodies.last_mut() {
                body.parts.push((instance, body_from_part));
            }
        }
        made
    }

    /// Also returns the warnings about what cannot be drawn as described, such as textures that cannot be read.
    pub(crate) fn of_description(described: Described) -> PyResult<(Self, Vec<String>)> {
        let mut simulation = match described {
            Described::World(world) => Simulation::builder(world).build().map_err(value_error)?,
            Described::Model(thing) => {
                let mut simulation =
                    Simulation::builder(model::World::empty()).build().map_err(value_error)?;
                simulation.spawn(&thing, SpawnOptions::default()).map_err(value_error)?;
                simulation
            }
        };
        let warnings = warnings(simulation.notes());
        Ok((Self::of_simulation(&mut simulation), warnings))
    }

    pub(crate) fn find(&self, name: &str) -> Option<usize> {
        self.by_name.get(name).copied()
    }

    /// Returns a name for an unnamed body: `body_…` with its number, or the next free one.
    pub(crate) fn free_name(&mut self) -> String {
        self.named = self.named.max(self.bodies.len());
        loop {
            let name = format!("body_{}", self.named);
            if self.find(&name).is_none() {
                return name;
            }
            self.named += 1;
        }
    }

    /// Adds a body and returns its number.
    pub(crate) fn push(&mut self, body: Body) -> usize {
        let number = self.bodies.len();
        self.by_name.entry(body.name.clone()).or_insert(number);
        self.bodies.push(body);
        number
    }
}

/// Returns the names `model::link` by the numbers of models and links.
fn names(entities: &Entities) -> Vec<(String, Vec<String>)> {
    let mut names = Vec::new();
    for (id, entity) in entities.iter() {
        if names.len() <= id.index() {
            names.resize_with(id.index() + 1, Default::default);
        }
        let links = entity.model.links.iter().map(|link| format!("{}::{}", entity.name, link.name));
        names[id.index()] = (entity.name.clone(), links.collect());
    }
    names
}
