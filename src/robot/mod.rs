//! A robot's base and its state: drive, odometry, inertial measurements, contacts, transforms, joint states.
//!
//! A [`Robot`] accompanies a model in [`Physics`]: call [`Robot::control`] before each step and [`Robot::observe`]
//! after it, then [`Robot::state_at`] for any timestamp between the last two steps.

mod ackermann;
pub mod autopilot;
pub mod base;
mod command;
pub mod contact;
mod differential;
pub mod drives;
mod feeler;
mod grip;
pub mod imu;
mod inertial;
pub mod kobuki;
pub mod odometry;
mod planar;
pub mod state;
mod tracker;
pub mod transforms;

pub use autopilot::Autopilot;
pub use base::Base;
pub use command::Command;
pub use feeler::Feeler;
pub(crate) use feeler::Pair;
pub use inertial::InertialUnit;
pub use kobuki::Kobuki;
pub use state::RobotState;

use crate::description::diagnostics::Problem;
use crate::description::model::{LinkIndex, Model};
use crate::world::physics::{ModelIndex, Physics, Placement};
use belvedere_sensors::Pose;
use transforms::{Transform, Transforms};

/// Returns true if a model has a base that drives.
pub fn has_base(model: &Model) -> bool {
    drives::check(model).is_ok()
}

/// Returns the placement of a robot in physics, with its model's frame at a pose: the wheels are part of its body, and
/// it stays awake.
pub fn placement(model: &Model, world_from_model: Pose) -> Placement<'_> {
    Placement { model, world_from_model, carried: drives::carried_joints(model), stays_awake: true }
}

/// A robot in the world, with or without a base that drives.
#[derive(Debug)]
pub struct Robot {
    model: ModelIndex,
    base_link: LinkIndex,
    transforms: Transforms,
    base: Option<Box<dyn Base>>,
    autopilot: Option<Autopilot>,
    /// Time of the last command.
    commanded_ns: Option<u64>,
}

impl Robot {
    /// Creates a robot from the model with this index. A model without a base becomes a passive robot, which senses but
    /// does not drive; the problem states why. Its frames are in the namespace, if there is one.
    pub fn new(
        model: &Model,
        namespace: &str,
        index: ModelIndex,
        physics: &mut Physics,
    ) -> (Self, Option<Problem>) {
        let (base, problem) = match drives::of_model(model, index, physics) {
            Ok(base) => (Some(base), None),
            Err(problem) => (None, Some(problem)),
        };
        let transforms = Transforms::of(model, namespace);
        let base_link = transforms::base_link(model);
        (Self { model: index, base_link, transforms, base, autopilot: None, commanded_ns: None }, problem)
    }

    /// Sends a velocity command, which holds until the base's timeout. A passive robot ignores it.
    pub fn command(&mut self, command: Command, stamp_ns: u64) {
        self.commanded_ns = Some(stamp_ns);
        if let Some(base) = &mut self.base {
            base.command(command, stamp_ns);
        }
    }

    /// Sets the autopilot that drives the robot while it receives no commands.
    pub fn set_autopilot(&mut self, autopilot: Option<Autopilot>) {
        self.autopilot = autopilot;
    }

    /// Returns the autopilot that drives the robot while it receives no commands.
    pub fn autopilot(&self) -> Option<Autopilot> {
        self.autopilot
    }

    /// Turns the motors' power on or off; see [`Base::set_motor_power`].
    pub fn set_motor_power(&mut self, on: bool) {
        if let Some(base) = &mut self.base {
            base.set_motor_power(on);
        }
    }

    /// Resets odometry to zero; see [`Base::reset_odometry`].
    pub fn reset_odometry(&mut self, physics: &Physics) {
        if let Some(base) = &mut self.base {
            base.reset_odometry(physics);
        }
    }

    /// Sets the motors for the next step.
    pub fn control(&mut self, physics: &mut Physics) {
        let now_ns = physics.time_ns();
        let is_commanded = self.commanded_ns.is_some_and(|at_ns| now_ns < at_ns + kobuki::COMMAND_TIMEOUT_NS);
        let driver = self.autopilot.filter(|autopilot| *autopilot != Autopilot::Still && !is_commanded);
        let command = driver.map(|autopilot| autopilot.command(&self.world_from_base(physics)));
        if let Some(base) = &mut self.base {
            if let Some(command) = command {
                base.command(command, now_ns);
            }
            base.control(physics);
        }
    }

    /// Handles a move of the robot by hand, before which its base was at `world_from_before`.
    pub fn carried(&mut self, physics: &Physics, world_from_before: &Pose) {
        if let Some(base) = &mut self.base {
            base.carried(physics, world_from_before);
        }
    }

    /// Reads encoders and gyro after a step.
    pub fn observe(&mut self, physics: &Physics) {
        if let Some(base) = &mut self.base {
            base.observe(physics);
        }
    }

    /// Returns the current true pose of the robot's `base_footprint` (or root link).
    pub fn world_from_base(&self, physics: &Physics) -> Pose {
        physics.world_from_link(self.model, self.base_link)
    }

    /// Returns the index of the robot's model.
    pub fn model(&self) -> ModelIndex {
        self.model
    }

    /// Returns the base that drives, if there is one.
    pub fn base(&self) -> Option<&dyn Base> {
        self.base.as_deref()
    }

    /// Returns the transforms that never change.
    pub fn static_transforms(&self) -> &[Transform] {
        self.transforms.fixed()
    }

    /// Writes everything to publish at a time between the last two steps into `state`, whose memory is used again.
    pub fn state_into(&self, physics: &Physics, stamp_ns: u64, state: &mut RobotState) {
        state.fill(stamp_ns, self.model, &self.transforms, self.base.as_deref(), physics);
    }

    /// Returns everything to publish at a time between the last two steps.
    pub fn state_at(&self, physics: &Physics, stamp_ns: u64) -> RobotState {
        let mut state = RobotState::default();
        self.state_into(physics, stamp_ns, &mut state);
        state
    }
}
