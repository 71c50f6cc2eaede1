//! Serves a simulation to other processes: publishes its streams and accepts commands.
//!
//! | file | is |
//! |---|---|
//! | `shared_memory` | the sink of all streams |
//! | `room` | limits the streams' pools to the available shared memory |
//! | `post` | sends frames that were made ahead of time when they are due |
//! | `commands` | commands to robots |
//! | `inbox` | commands to the simulation, and their results |
//! | `operations` | executes these commands |
//! | `files` | loads models from the texts of commands |
//! | `states` | streams of the poses and velocities of all models and links |
//! | `values` | checks the poses and velocities in commands |
//! | `attendance` | consumers that the simulation waits for |
//!
//! Commands are applied between two frames, so that the same commands at the same simulated times give the same bytes.

pub mod attendance;
pub mod commands;
mod files;
pub(crate) mod inbox;
mod operations;
pub mod post;
pub(crate) mod room;
mod shared_memory;
mod states;
pub(crate) mod values;

pub use files::ModelFiles;
pub use shared_memory::SharedMemory;

use crate::description::Severity;
use crate::entities::EntityId;
use crate::rig::cost::Cost;
use crate::rig::packets::PacketTarget;
use crate::rig::{Rig, RigError, RigOptions};
use crate::simulation::Simulation;
use belvedere_bridge::Node;
use belvedere_bridge::payload::SimulationCommand;
use commands::RobotCommands;
use inbox::Inbox;
use states::StateStreams;
use std::collections::HashMap;
use std::time::{Duration, Instant};

/// Options for serving a simulation.
#[derive(Debug, Clone, Default)]
pub struct ServerOptions {
    /// Also publish ground truth for every pixel and beam, in separate streams.
    pub truth: bool,
    /// Hash every byte that is published.
    pub hashed: bool,
    /// The places of the files that spawned models refer to.
    pub files: ModelFiles,
}

/// Publishes a simulation and lets other processes control it, as `belvedere run` does.
pub struct Server<'a> {
    simulation: &'a mut Simulation,
    sink: SharedMemory,
    rig: Rig,
    commands: Vec<RobotCommands>,
    inbox: Inbox,
    states: StateStreams,
    files: ModelFiles,
    /// URDFs of robots that were spawned from one.
    descriptions: HashMap<EntityId, String>,
    paused: bool,
    steps: Option<Steps>,
    /// The cost of a physics step.
    step_cost: Cost,
    epoch: u64,
}

/// A step command in progress.
struct Steps {
    command: SimulationCommand,
    until_ns: u64,
}

impl<'a> Server<'a> {
    /// Opens all streams of the models in the simulation, and the streams that control it. A model that is spawned by a
    /// command later adds streams of its own, which are closed when it is deleted.
    ///
    /// ```
    /// use belvedere::{description::model::World, server::{Server, ServerOptions}, simulation::Simulation};
    /// use belvedere_bridge::{Domain, Node};
    /// let mut simulation = Simulation::builder(World::empty()).build()?;
    /// let domain = Domain::new(&format!("doc-{}", std::process::id()))?;
    /// let node = Node::open(&domain, "belvedere")?;
    /// let mut server = Server::attach(&mut simulation, &node, ServerOptions::default())?;
    /// server.advance();
    /// assert_eq!(server.next_stamp_ns(), 10_000_000); // the clock ticks at 100 Hz
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// If a stream cannot be opened, or a sensor cannot be created.
    pub fn attach(
        simulation: &'a mut Simulation,
        node: &Node,
        options: ServerOptions,
    ) -> Result<Self, RigError> {
        Self::attach_to(simulation, SharedMemory::new(node.clone()), options)
    }

    /// Like [`Server::attach`], with a sink that may wait for consumers or have a post.
    ///
    /// # Errors
    /// The errors of [`Server::attach`].
    pub fn attach_to(
        simulation: &'a mut Simulation,
        sink: SharedMemory,
        options: ServerOptions,
    ) -> Result<Self, RigError> {
        let ServerOptions { truth, hashed, files } = options;
        let options = RigOptions { truth, hashed, ..simulation.options() };
        let ids: Vec<_> = simulation.entities().iter().map(|(id, _)| id).collect();
        let mut commands = Vec::new();
        for id in ids {
            commands.extend(robot_commands(simulation, &sink.node, id)?);
        }
        let (mut rig, states) = sink.room.fit(RigError::lacks_memory, || {
            let rig = Rig::open(&sink, simulation.stage().0, options)?;
            Ok((rig, StateStreams::open(&sink, simulation.entities(), simulation.physics())?))
        })?;
        log_notes(&mut rig);
        simulation.remember(rig.window_ns());
        Ok(Self {
            inbox: Inbox::open(&sink.node)?,
            states,
            simulation,
            sink,
            rig,
            commands,
            files,
            descriptions: HashMap::new(),
            paused: false,
            steps: None,
            step_cost: Cost::default(),
            epoch: 0,
        })
    }

    /// Returns the simulation.
    pub fn simulation(&self) -> &Simulation {
        self.simulation
    }

    /// Returns the URDF of a model that was spawned from one.
    pub fn description(&self, id: EntityId) -> Option<&str> {
        self.descriptions.get(&id).map(String::as_str)
    }

    /// Also sends the data packets of a lidar, given by its name or one of its topics, to a target.
    ///
    /// # Errors
    /// A message, if there is no such sensor, it has no packets, or the target cannot be opened.
    pub fn send_packets(&mut self, feeds: &[(&str, PacketTarget)]) -> Result<(), String> {
        self.rig.send_packets(feeds)
    }

    /// Opens the streams of a new model.
    fn mount(&mut self, id: EntityId) -> Result<(), RigError> {
        let commands = robot_commands(self.simulation, &self.sink.node, id)?;
        let (rig, simulation, sink) = (&mut self.rig, &mut self.simulation, &self.sink);
        sink.room.fit(RigError::lacks_memory, || rig.mount(sink, simulation.stage().0, id))?;
        log_notes(&mut self.rig);
        self.commands.extend(commands);
        self.simulation.remember(self.rig.window_ns());
        Ok(())
    }

    /// Closes the streams of a model that is to be deleted.
    fn unmount(&mut self, id: EntityId) {
        // Frames that wait in the post belong to streams that are closed now.
        if let Some(post) = &self.sink.post {
            post.flush();
        }
        self.commands.retain(|commands| commands.id() != id);
        self.descriptions.remove(&id);
        self.rig.unmount(id, self.simulation.time_ns());
    }

    /// Returns the timestamp in ns of the next frame.
    pub fn next_stamp_ns(&self) -> u64 {
        self.rig.next_stamp_ns()
    }

    /// Returns the simulated time in ns to which [`Server::advance`] runs: the next frame's timestamp, or the end of a
    /// step command.
    pub fn next_ns(&self) -> u64 {
        self.next_stamp_ns().min(self.steps.as_ref().map_or(u64::MAX, |steps| steps.until_ns))
    }

    /// Estimates the time to make a frame of each sensor and to advance physics to the next frame, from their previous
    /// costs.
    pub fn cost(&self) -> Duration {
        let physics = self.simulation.physics();
        let steps = self.next_ns().saturating_sub(physics.time_ns()).div_ceil(physics.step_ns());
        let physics = self.step_cost.expected().saturating_mul(u32::try_from(steps).unwrap_or(u32::MAX));
        physics.saturating_add(self.rig.cost())
    }

    /// Advances physics to the next frame's timestamp and publishes everything that is due then. If a step command ends
    /// earlier, stops there.
    pub fn advance(&mut self) {
        let (stamp_ns, until_ns) = (self.next_stamp_ns(), self.next_ns());
        self.take_commands();
        let started = Instant::now();
        let steps = self.simulation.run_until(until_ns);
        if steps > 0 {
            self.step_cost.add(started.elapsed() / steps);
        }
        if stamp_ns == until_ns {
            let (stage, scene) = self.simulation.stage();
            self.rig.publish(stamp_ns, stage, scene);
            self.states.publish(stamp_ns, stage.entities, stage.physics);
        }
        if self.next_stamp_ns() > self.simulation.time_ns() {
            self.finish_steps();
        }
    }

    /// Passes the newest commands from other processes on to the robots.
    fn take_commands(&mut self) {
        for commands in &mut self.commands {
            self.simulation.with_robot(commands.id(), |robot, physics| commands.apply(robot, physics));
        }
    }

    /// Returns the sensors and their streams.
    pub fn rig(&self) -> &Rig {
        &self.rig
    }

    /// Returns the simulated time in ns that physics has reached.
    pub fn time_ns(&self) -> u64 {
        self.simulation.time_ns()
    }

    /// Returns the simulated time in ns since the start at which the next frame is due. Resets do not set it back.
    pub fn next_simulated_ns(&self) -> u64 {
        let before_resets_ns = self.simulated_ns() - self.time_ns();
        before_resets_ns.saturating_add(self.next_stamp_ns())
    }

    /// Returns the simulated time in ns since the start. Resets do not set it back.
    pub fn simulated_ns(&self) -> u64 {
        self.simulation.simulated_ns()
    }
}

/// Logs the decisions that were made for the user when streams were opened.
fn log_notes(rig: &mut Rig) {
    for note in rig.take_notes() {
        if note.severity == Severity::Note {
            tracing::debug!("{note}");
        } else {
            tracing::warn!("{note}");
        }
    }
}

fn robot_commands(
    simulation: &Simulation,
    node: &Node,
    id: EntityId,
) -> Result<Option<RobotCommands>, belvedere_bridge::Error> {
    let entity = simulation.entities().get(id).filter(|entity| entity.robot.is_some());
    entity.map(|entity| RobotCommands::open(node, id, entity)).transpose()
}
