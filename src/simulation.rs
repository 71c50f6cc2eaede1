//! A world, its robot and its sensors, advanced from frame to frame, and controlled by other processes in between.

mod operations;

use crate::control::{Inbox, Resident, Role, Roster, SpawnOptions, StateStreams};
use crate::description::model::{Model, World};
use crate::description::{Problem, Severity};
use crate::rig::base::BaseCommands;
use crate::rig::cost::Cost;
use crate::rig::post::Post;
use crate::rig::{Rig, RigError, RigOptions};
use crate::robot::{Command, Drive, Robot};
use crate::world::physics::Physics;
use crate::world::scene::WorldScene;
use belvedere_bridge::payload::{SimulationCommand, VelocityCommand};
use belvedere_bridge::{Node, StreamSpec, Subscriber};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// How long a command from outside keeps the built-in drive off, in ns: as long as it holds for the base.
const COMMAND_HOLDS_NS: u64 = crate::robot::kobuki::COMMAND_TIMEOUT_NS;

/// A running simulation of one robot.
pub struct Simulation {
    world: World,
    roster: Roster,
    physics: Physics,
    robots: Vec<Robot>,
    scene: WorldScene,
    rig: Rig,
    drive: Drive,
    commands: Subscriber,
    commanded_ns: Option<u64>,
    base_commands: Option<BaseCommands>,
    inbox: Inbox,
    states: StateStreams,
    spawn_options: SpawnOptions,
    paused: bool,
    steps: Option<Steps>,
    /// Of a physics step.
    step_cost: Cost,
    post: Option<Arc<Post>>,
    epoch: u64,
    /// Simulated time before the last return to 0.
    before_resets_ns: u64,
}

/// A step command that is being followed.
struct Steps {
    command: SimulationCommand,
    until_ns: u64,
}

impl Simulation {
    /// Puts the robot into the world at the start of the drive and opens all streams. What is worth knowing, but
    /// no error, is pushed to `notes`.
    ///
    /// # Errors
    /// A world that cannot run, a texture that cannot be read, a sensor that cannot be made, a stream that cannot
    /// be opened.
    pub fn new(
        world: &World,
        robot: &Model,
        drive: Drive,
        node: &Node,
        options: &RigOptions,
        notes: &mut Vec<Problem>,
    ) -> Result<Self, RigError> {
        let mut roster = Roster::default();
        let of_world = world.models.iter().map(|model| (model, model.world_from_model, Role::World));
        let of_robot = (robot, drive.start_pose() * robot.world_from_model, Role::Robot);
        for (model, start, role) in of_world.chain([of_robot]) {
            roster.add(Resident { name: model.name.clone(), model: model.clone(), start, role });
        }
        let mut physics = Physics::with_models(world, roster.places())?;
        notes.extend_from_slice(physics.notes());
        let models = [robot.clone()];
        let index = physics.robot(0);
        let (running, problem) = Robot::new(robot, index, &mut physics);
        notes.extend(problem.filter(|problem| problem.severity < Severity::Error));
        let robots = vec![running];
        let scene = WorldScene::new(world, &models, &physics)?;
        let commands = node.command_subscriber(&StreamSpec::velocity_command("/cmd_vel"))?;
        let base_commands = robots[0].base().map(|_| BaseCommands::open(node)).transpose()?;
        let rig = Rig::open(node, &models, &robots, &physics, options)?;
        physics.remember(rig.window_ns());
        Ok(Self {
            world: world.clone(),
            inbox: Inbox::open(node)?,
            states: StateStreams::open(node, &roster, &physics, options.post.as_ref())?,
            spawn_options: SpawnOptions::default(),
            roster,
            physics,
            robots,
            scene,
            rig,
            drive,
            commands,
            commanded_ns: None,
            base_commands,
            paused: false,
            steps: None,
            step_cost: Cost::default(),
            post: options.post.clone(),
            epoch: 0,
            before_resets_ns: 0,
        })
    }

    /// Where the files of models are that other processes spawn.
    pub fn set_spawn_options(&mut self, options: SpawnOptions) {
        self.spawn_options = options;
    }

    /// Stamp in ns of the frame that is due next.
    pub fn next_stamp_ns(&self) -> u64 {
        self.rig.next_stamp_ns()
    }

    /// Simulated time in ns to which [`Simulation::advance`] goes: that frame's stamp, or the end of a step command.
    pub fn next_ns(&self) -> u64 {
        self.next_stamp_ns().min(self.steps.as_ref().map_or(u64::MAX, |steps| steps.until_ns))
    }

    /// How long it may take to make a frame of each sensor, and to bring physics there from the frame before, by what
    /// that took before.
    pub fn cost(&self) -> Duration {
        let steps = self.next_ns().saturating_sub(self.physics.time_ns()).div_ceil(self.physics.step_ns());
        let physics = self.step_cost.expected().saturating_mul(u32::try_from(steps).unwrap_or(u32::MAX));
        physics.saturating_add(self.rig.cost())
    }

    /// Brings physics to the next frame's stamp and publishes all that is due then; stops before it where a step
    /// command ends.
    pub fn advance(&mut self) {
        let (stamp_ns, until_ns) = (self.next_stamp_ns(), self.next_ns());
        self.take_commands();
        self.step_until(until_ns);
        if stamp_ns == until_ns {
            self.rig.publish(stamp_ns, &self.physics, &self.robots, &mut self.scene);
            self.states.publish(stamp_ns, &self.roster, &self.physics);
        }
        if self.next_stamp_ns() > self.physics.time_ns() {
            self.finish_steps();
        }
    }

    fn step_until(&mut self, until_ns: u64) {
        let started = Instant::now();
        let mut steps = 0;
        while self.physics.time_ns() < until_ns {
            self.step();
            steps += 1;
        }
        if steps > 0 {
            self.step_cost.add(started.elapsed() / steps);
        }
    }

    /// One physics step.
    fn step(&mut self) {
        let now_ns = self.physics.time_ns();
        let from_outside = self.commanded_ns.is_some_and(|at_ns| now_ns < at_ns + COMMAND_HOLDS_NS);
        for robot in &mut self.robots {
            if !from_outside && self.drive != Drive::Still {
                robot.command(self.drive.command(&robot.world_from_base(&self.physics)), now_ns);
            }
            robot.control(&mut self.physics);
        }
        self.physics.step();
        for robot in &mut self.robots {
            robot.observe(&self.physics);
        }
    }

    /// Hands the newest commands from outside to the robot.
    fn take_commands(&mut self) {
        if let Some(commands) = &mut self.base_commands {
            commands.apply(&mut self.robots[0], &self.physics);
        }
        let command: VelocityCommand = match self.commands.take_newest() {
            Ok(None) => return,
            Ok(Some(frame)) => match frame.message() {
                Ok(command) => command,
                Err(error) => {
                    tracing::warn!(%error, "a velocity command was refused");
                    return;
                }
            },
            Err(error) => {
                tracing::warn!(%error, "velocity commands cannot be read");
                return;
            }
        };
        let command = Command { linear_m_s: command.linear[0], angular_rad_s: command.angular[2] };
        let now_ns = self.physics.time_ns();
        self.commanded_ns = Some(now_ns);
        for robot in &mut self.robots {
            robot.command(command, now_ns);
        }
    }

    /// The sensors and their streams.
    pub fn rig(&self) -> &Rig {
        &self.rig
    }

    /// Simulated time in ns that physics has reached.
    pub fn time_ns(&self) -> u64 {
        self.physics.time_ns()
    }

    /// Simulated time in ns since the start at which the next frame is due, not set back by resets.
    pub fn next_simulated_ns(&self) -> u64 {
        self.before_resets_ns.saturating_add(self.next_stamp_ns())
    }

    /// Simulated time in ns since the start, not set back by resets.
    pub fn simulated_ns(&self) -> u64 {
        self.before_resets_ns + self.physics.time_ns()
    }
}
