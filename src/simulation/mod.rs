//! [`Simulation`]: a world with its models, advanced step by step and rendered by its sensors on demand.
//!
//! It needs no shared memory, no clock and no command line. A test or a training loop creates a simulation, spawns a
//! robot, steps it, and renders its sensors into its own memory. `belvedere run` additionally attaches a
//! [`Server`](crate::server::Server).
//!
//! ```
//! use belvedere::description::model::World;
//! use belvedere::simulation::Simulation;
//! let mut simulation = Simulation::builder(World::empty()).build()?;
//! simulation.run_for(std::time::Duration::from_millis(20));
//! assert_eq!(simulation.time_ns(), 20_000_000);
//! # Ok::<(), belvedere::simulation::SimulationError>(())
//! ```

mod error;
mod notes;
mod render;
mod spawn;

pub use error::SimulationError;
pub use spawn::SpawnOptions;

use crate::description::model::{Model, World};
use crate::description::{Problem, Severity};
use crate::entities::{Entities, Entity, EntityId, Origin};
use crate::rig::{RigOptions, Stage};
use crate::robot::{self, Autopilot, Command, Feeler, InertialUnit, Robot};
use crate::world::physics::{Physics, Placement};
use crate::world::scene::{Looks, WorldScene};
use belvedere_sensors::{Execution, Pose};
use glam::DVec3;
use notes::Notes;
use render::Studio;
use std::time::Duration;

/// A running world.
pub struct Simulation {
    world: World,
    entities: Entities,
    physics: Physics,
    scene: WorldScene,
    options: RigOptions,
    /// Renders frames on demand.
    studio: Option<Studio>,
    notes: Notes,
    /// Simulated time before the last reset.
    before_resets_ns: u64,
    /// Length of physics' history.
    window_ns: u64,
}

/// Builds a simulation.
#[derive(Debug, Clone)]
pub struct SimulationBuilder {
    world: World,
    seed: u64,
    gazebo_compat: bool,
    execution: Execution,
}

impl SimulationBuilder {
    /// Sets the seed of all noise, 1 by default. The same seed gives the same bytes.
    #[must_use]
    pub fn seed(self, seed: u64) -> Self {
        Self { seed, ..self }
    }

    /// Sets whether to reproduce Gazebo's deviations from correct behaviour; off by default.
    #[must_use]
    pub fn gazebo_compat(self, gazebo_compat: bool) -> Self {
        Self { gazebo_compat, ..self }
    }

    /// Sets threads and SIMD level of the sensors; all available ones by default. They do not change the bytes.
    #[must_use]
    pub fn execution(self, execution: Execution) -> Self {
        Self { execution, ..self }
    }

    /// Builds the simulation, at time 0.
    ///
    /// # Errors
    /// If the world cannot run, or a shape cannot be traced; with its line.
    pub fn build(self) -> Result<Simulation, SimulationError> {
        let Self { world, seed, gazebo_compat, execution } = self;
        let mut physics = Physics::with_models(&world, world.models.iter().map(|model| Some(placed(model))))?;
        let mut entities = Entities::default();
        let mut of_models = Vec::new();
        for (index, model) in world.models.iter().enumerate() {
            let robot = (!model.plugins.is_empty()).then(|| Robot::new(model, "", index, &mut physics));
            let (robot, problem) = robot.unzip();
            of_models.extend(problem.flatten().filter(|problem| problem.severity >= Severity::Warning));
            let mut named = model.clone();
            of_models.extend(named.name_sensor_topics(&world.name));
            let entity = Entity {
                name: model.name.clone(),
                namespace: String::new(),
                model: named,
                start: model.world_from_model,
                origin: Origin::World,
                noise_name: model.name.clone(),
                robot,
                units: InertialUnit::all(model, index),
                feelers: Feeler::all(model, index, &physics),
            };
            entities.add(index, entity);
        }
        let mut scene = WorldScene::new(&world, &physics)?;
        let mut notes = Notes::default();
        notes.add(physics.take_notes());
        notes.add(of_models);
        notes.add(scene.take_notes());
        let options = RigOptions { seed, gazebo_compat, truth: false, hashed: false, execution };
        Ok(Simulation {
            world,
            entities,
            physics,
            scene,
            options,
            studio: None,
            notes,
            before_resets_ns: 0,
            window_ns: 0,
        })
    }
}

/// Returns the placement of a model of the world. A model with plugins is treated as a robot, the others as plain
/// objects.
fn placed(model: &Model) -> Placement<'_> {
    let world_from_model = model.world_from_model;
    if model.plugins.is_empty() {
        Placement::of_thing(model, world_from_model)
    } else {
        robot::placement(model, world_from_model)
    }
}

impl Simulation {
    /// Returns a builder for a simulation of this world.
    pub fn builder(world: World) -> SimulationBuilder {
        SimulationBuilder { world, seed: 1, gazebo_compat: false, execution: Execution::parallel() }
    }

    /// Returns notes on decisions made for the user so far, and on ignored input.
    pub fn notes(&self) -> &[Problem] {
        self.notes.all()
    }

    /// Returns the seed, the compatibility mode and the execution.
    pub fn options(&self) -> RigOptions {
        self.options
    }

    /// Returns the name of the world.
    pub fn world_name(&self) -> &str {
        &self.world.name
    }

    /// Returns all models.
    pub fn entities(&self) -> &Entities {
        &self.entities
    }

    /// Finds the model with this name.
    ///
    /// # Errors
    /// If there is none; the message lists the existing names.
    pub fn find(&self, name: &str) -> Result<EntityId, SimulationError> {
        self.entities.find(name).map(|(id, _)| id).map_err(SimulationError::Refused)
    }

    /// Returns the state of physics.
    pub fn physics(&self) -> &Physics {
        &self.physics
    }

    /// Returns the scene that sensors see, at the current time.
    pub fn scene(&mut self) -> &WorldScene {
        self.scene.move_to(&self.physics, self.physics.time_ns());
        &self.scene
    }

    /// Returns the simulated time in ns that physics has reached.
    pub fn time_ns(&self) -> u64 {
        self.physics.time_ns()
    }

    /// Returns the simulated time in ns since the start. Resets do not set it back.
    pub fn simulated_ns(&self) -> u64 {
        self.before_resets_ns + self.physics.time_ns()
    }

    /// Returns the pose of a model's frame in the world: position in metres, x forward, z up.
    ///
    /// # Errors
    /// If the model was deleted.
    pub fn pose(&self, id: EntityId) -> Result<Pose, SimulationError> {
        self.get(id)?;
        Ok(self.physics.world_from_model(id.index()))
    }

    /// Moves a model to a pose, and sets its linear velocity in m/s and angular velocity in rad/s, along the world's
    /// axes.
    ///
    /// # Errors
    /// If the model was deleted, or a number is not finite.
    pub fn place(
        &mut self,
        id: EntityId,
        world_from_model: &Pose,
        linear: DVec3,
        angular: DVec3,
    ) -> Result<(), SimulationError> {
        self.get(id)?;
        if !(world_from_model.is_finite() && linear.is_finite() && angular.is_finite()) {
            return Err(SimulationError::Refused("a pose or velocity is not finite".into()));
        }
        if self.physics.follows_script(id.index()) {
            let name = &self.get(id)?.name;
            return Err(SimulationError::Refused(format!(
                "'{name}' follows its script, and cannot be moved"
            )));
        }
        let before = self.bases();
        self.physics.move_model(id.index(), world_from_model, linear, angular);
        self.carried(&before);
        self.scene.replace_model(id.index(), &self.physics);
        Ok(())
    }

    /// Moves a model to a pose as at the start: at rest, with its joints at zero. The result does not depend on its
    /// earlier pose, not even in the last bit.
    ///
    /// # Errors
    /// The errors of [`Simulation::place`].
    pub fn set_down(&mut self, id: EntityId, world_from_model: &Pose) -> Result<(), SimulationError> {
        let name = &self.get(id)?.name;
        if !world_from_model.is_finite() {
            return Err(SimulationError::Refused("a pose is not finite".into()));
        }
        if self.physics.follows_script(id.index()) {
            return Err(SimulationError::Refused(format!(
                "'{name}' follows its script, and cannot be moved"
            )));
        }
        let before = self.bases();
        self.physics.place_model(id.index(), world_from_model);
        self.carried(&before);
        self.scene.replace_model(id.index(), &self.physics);
        Ok(())
    }

    /// Returns true if all collision shapes are at least `clearance_m` away from a model, except those that it stands
    /// on.
    ///
    /// # Errors
    /// If the model was deleted.
    pub fn is_clear(&self, id: EntityId, clearance_m: f64) -> Result<bool, SimulationError> {
        self.get(id)?;
        Ok(self.physics.is_clear(id.index(), clearance_m))
    }

    /// Sets the seed of all noise from now on.
    pub fn set_seed(&mut self, seed: u64) {
        self.options.seed = seed;
        self.studio = None;
    }

    /// Replaces the looks that sensors see, or restores those of the files, until a model is spawned or deleted.
    /// [`Looks::of`] returns the looks of a scene: `simulation.scene().scene()`.
    ///
    /// # Errors
    /// If the number of materials or lights differs, or one of their values is invalid.
    pub fn set_looks(&mut self, looks: Option<Looks>) -> Result<(), SimulationError> {
        self.scene.set_looks(looks).map_err(|error| SimulationError::Refused(error.to_string()))
    }

    /// Returns the poses of the robots' bases.
    fn bases(&self) -> Vec<Pose> {
        let robots = self.entities.iter().filter_map(|(_, entity)| entity.robot.as_ref());
        robots.map(|robot| robot.world_from_base(&self.physics)).collect()
    }

    /// Informs robots and inertial units of a move by hand. `before` are the earlier poses of the bases.
    fn carried(&mut self, before: &[Pose]) {
        for (robot, world_from_before) in self.entities.robots_mut().zip(before) {
            robot.carried(&self.physics, world_from_before);
        }
        for (_, entity) in self.entities.iter_mut() {
            entity.units.iter_mut().for_each(|unit| unit.carried(&self.physics));
        }
    }

    /// Sends a velocity command to a robot's base, which follows it until its plugin's timeout, 0.6 s for a Kobuki.
    ///
    /// # Errors
    /// If it was deleted, or has no base that drives.
    pub fn command(&mut self, id: EntityId, command: Command) -> Result<(), SimulationError> {
        let now_ns = self.physics.time_ns();
        self.driver(id)?.command(command, now_ns);
        Ok(())
    }

    /// Sets an autopilot that drives a robot while it receives no commands.
    ///
    /// # Errors
    /// If it was deleted, or has no base that drives.
    pub fn set_autopilot(&mut self, id: EntityId, autopilot: Autopilot) -> Result<(), SimulationError> {
        self.driver(id)?.set_autopilot(Some(autopilot));
        Ok(())
    }

    fn get(&self, id: EntityId) -> Result<&Entity, SimulationError> {
        self.entities.get(id).ok_or(SimulationError::Gone)
    }

    fn driver(&mut self, id: EntityId) -> Result<&mut Robot, SimulationError> {
        let entity = self.entities.get_mut(id).ok_or(SimulationError::Gone)?;
        let name = &entity.name;
        let robot = entity.robot.as_mut().filter(|robot| robot.base().is_some());
        robot.ok_or_else(|| SimulationError::NoBase { name: name.clone() })
    }

    /// Advances physics by one step of the world's step size.
    pub fn step(&mut self) {
        for robot in self.entities.robots_mut() {
            robot.control(&mut self.physics);
        }
        self.physics.step();
        self.entities.observe(&self.physics);
    }

    /// Steps until this time is reached and returns the number of steps.
    pub fn run_until(&mut self, time_ns: u64) -> u32 {
        let mut steps = 0;
        while self.physics.time_ns() < time_ns {
            self.step();
            steps += 1;
        }
        steps
    }

    /// Steps until this much time has passed.
    pub fn run_for(&mut self, time: Duration) {
        let time_ns = u64::try_from(time.as_nanos()).unwrap_or(u64::MAX);
        self.run_until(self.physics.time_ns().saturating_add(time_ns));
    }

    /// Moves all models to their start poses; time continues.
    pub fn replace(&mut self) {
        let before = self.bases();
        for (id, entity) in self.entities.iter() {
            self.physics.place_model(id.index(), &entity.start);
        }
        self.carried(&before);
        self.scene.replace(&self.physics);
    }

    /// Restarts at time 0, with all current models at their start poses. Everything is built as at a fresh start, so
    /// the same bytes follow.
    ///
    /// # Errors
    /// None in practice, because the same world ran before.
    pub fn reset(&mut self) -> Result<(), SimulationError> {
        let mut physics = Physics::with_models(&self.world, self.entities.placements())?;
        for entity in self.entities.iter_mut() {
            let (id, Entity { robot, model, namespace, units, feelers, .. }) = entity;
            *units = InertialUnit::all(model, id.index());
            *feelers = Feeler::all(model, id.index(), &physics);
            let Some(robot) = robot else { continue };
            let autopilot = robot.autopilot();
            *robot = Robot::new(model, namespace, id.index(), &mut physics).0;
            robot.set_autopilot(autopilot);
        }
        self.before_resets_ns += self.physics.time_ns();
        self.physics = physics;
        self.physics.remember(self.window_ns);
        self.scene.replace(&self.physics);
        self.studio = None;
        Ok(())
    }

    /// Makes physics keep a history of at least this length, which sensors need.
    pub(crate) fn remember(&mut self, window_ns: u64) {
        self.window_ns = self.window_ns.max(window_ns);
        self.physics.remember(self.window_ns);
    }

    /// Calls `act` with a robot, if it exists.
    #[cfg(feature = "server")]
    pub(crate) fn with_robot(&mut self, id: EntityId, act: impl FnOnce(&mut Robot, &Physics)) {
        if let Some(robot) = self.entities.get_mut(id).and_then(|entity| entity.robot.as_mut()) {
            act(robot, &self.physics);
        }
    }

    /// Returns everything that a rig needs to publish.
    pub(crate) fn stage(&mut self) -> (Stage<'_>, &mut WorldScene) {
        let stage = Stage { entities: &self.entities, physics: &self.physics, earth: &self.world.earth };
        (stage, &mut self.scene)
    }
}
