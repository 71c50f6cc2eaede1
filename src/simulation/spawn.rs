//! Spawns and deletes models.

use super::{Simulation, SimulationError};
use crate::description::Severity;
use crate::description::model::Model;
use crate::entities::{Entity, EntityId, Origin, model_name, namespace};
use crate::robot::{self, Feeler, InertialUnit, Robot, has_base};
use crate::world::physics::Placement;
use belvedere_sensors::Pose;

/// Options for spawning a model.
#[derive(Debug, Clone, PartialEq)]
pub struct SpawnOptions {
    /// Name of the model; empty for the name in its file.
    pub name: String,
    /// Prefix of its topics and frames, as in `/NAMESPACE/scan`; empty for none.
    pub namespace: String,
    /// Pose of the model. Its own `<pose>` is relative to this, as when Gazebo spawns it.
    pub world_from_model: Pose,
    /// True if it publishes transforms and joint states like a robot; by default, models with a base or plugins do.
    /// Robots never sleep in physics, and neither do models with sensors.
    pub is_robot: Option<bool>,
}

impl Default for SpawnOptions {
    fn default() -> Self {
        Self {
            name: String::new(),
            namespace: String::new(),
            world_from_model: Pose::IDENTITY,
            is_robot: None,
        }
    }
}

impl Simulation {
    /// Adds a model to the world, with its base and its sensors, at the start or later.
    ///
    /// # Errors
    /// If the name is taken or invalid, the namespace is invalid in ROS, or a part of the model cannot be used. Then
    /// the model is not added.
    pub fn spawn(&mut self, model: &Model, options: SpawnOptions) -> Result<EntityId, SimulationError> {
        self.spawn_as(model, options, Origin::Start)
    }

    pub(crate) fn spawn_as(
        &mut self,
        model: &Model,
        options: SpawnOptions,
        origin: Origin,
    ) -> Result<EntityId, SimulationError> {
        let SpawnOptions { name, namespace: given, world_from_model, is_robot } = options;
        let name = if name.is_empty() { model.name.clone() } else { name };
        model_name(&name).map_err(|why| {
            SimulationError::Refused(format!("'{name}' cannot be a model's name: {why}; give it another"))
        })?;
        if self.entities.is_taken(&name) {
            return Err(SimulationError::Refused(format!(
                "there is a model '{name}' already; give it another name, or delete that one first"
            )));
        }
        let namespace = namespace(&given).map_err(SimulationError::Refused)?;
        let start = world_from_model * model.world_from_model;
        let mut model = Model { name: name.clone(), ..model.clone() };
        let mut topic_notes = model.name_sensor_topics(&self.world.name);
        let is_robot = is_robot.unwrap_or_else(|| has_base(&model) || !model.plugins.is_empty());
        let mut placement = robot::placement(&model, start);
        if !is_robot {
            let stays_awake = !model.sensors.is_empty();
            placement = Placement { stays_awake, ..Placement::of_thing(&model, start) };
        }
        let index = self.physics.insert_model(&placement)?;
        let starts = origin == Origin::Start && has_base(&model);
        if let Some((link, other)) = starts.then(|| self.physics.inside(index)).flatten() {
            self.physics.remove_model(index);
            let found = self.entities.iter().find(|(id, _)| id.index() == other);
            return Err(SimulationError::Refused(format!(
                "the robot '{name}' would start with its link '{}' inside the model '{}'; give it another pose",
                model.links[link].name,
                found.map(|(_, entity)| &*entity.name).unwrap_or_default()
            )));
        }
        if let Err(problem) = self.scene.add_model(index, &model, &start) {
            self.physics.remove_model(index);
            return Err(problem.into());
        }
        let mut notes = self.physics.take_notes();
        notes.append(&mut self.scene.take_notes());
        notes.append(&mut topic_notes);
        let robot = is_robot.then(|| {
            let (robot, problem) = Robot::new(&model, &namespace, index, &mut self.physics);
            notes.extend(problem.filter(|problem| problem.severity < Severity::Error));
            robot
        });
        self.notes.add(notes);
        self.studio = None;
        let units = InertialUnit::all(&model, index);
        let feelers = Feeler::all(&model, index, &self.physics);
        let noise_name = self.entities.noise_name(&name, &namespace, origin);
        let entity = Entity { name, namespace, model, start, origin, noise_name, robot, units, feelers };
        Ok(self.entities.add(index, entity))
    }

    /// Removes a model from the world. Frames that were already rendered do not change.
    ///
    /// # Errors
    /// If it was already deleted.
    pub fn delete(&mut self, id: EntityId) -> Result<(), SimulationError> {
        self.get(id)?;
        self.physics.remove_model(id.index());
        self.scene.remove_model(id.index());
        self.entities.remove(id);
        self.studio = None;
        Ok(())
    }
}
