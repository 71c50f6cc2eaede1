//! [`Base`]: the trait of bases, which drive models.

use super::command::Command;
use super::odometry::Odometry;
use crate::world::physics::Physics;
use belvedere_sensors::Pose;
use std::any::Any;
use std::fmt::Debug;

/// A base in the world. [`Base::control`] is called before each step, [`Base::observe`] after it.
pub trait Base: Any + Debug {
    /// Sets the velocity command at a time in ns. A command that is not finite means stop.
    fn command(&mut self, command: Command, stamp_ns: u64);

    /// Sets the motors for the next step.
    fn control(&mut self, physics: &mut Physics);

    /// Reads the base's sensors after a step.
    fn observe(&mut self, physics: &Physics);

    /// Handles a move by hand, before which the base link was at `world_from_before`.
    fn carried(&mut self, _physics: &Physics, _world_from_before: &Pose) {}

    /// Returns the newest odometry at or before a time between the last two steps.
    fn odometry_at(&self, physics: &Physics, stamp_ns: u64) -> Odometry;

    /// Resets odometry to zero at the current pose.
    fn reset_odometry(&mut self, physics: &Physics);

    /// Turns the motors' power on or off, if the base supports it.
    fn set_motor_power(&mut self, _on: bool) {}
}

impl dyn Base {
    /// Returns the base as the type `B`, or `None` if it has another type.
    pub fn downcast_ref<B: Base>(&self) -> Option<&B> {
        let base: &dyn Any = self;
        base.downcast_ref()
    }
}
