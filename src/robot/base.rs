//! The trait of bases: what drives a model.

use super::command::Command;
use super::odometry::Odometry;
use crate::world::physics::Physics;
use belvedere_sensors::Pose;
use std::any::Any;
use std::fmt::Debug;

/// A base in the world. [`Base::control`] is called before each step, [`Base::observe`] after it.
pub trait Base: Any + Debug {
    /// Gives a velocity command at a time in ns. One that is not finite means stop.
    fn command(&mut self, command: Command, stamp_ns: u64);

    /// Sets the motors for the step to come.
    fn control(&mut self, physics: &mut Physics);

    /// Reads its sensors after a step.
    fn observe(&mut self, physics: &Physics);

    /// Notices that it was moved by hand from where its base link was.
    fn carried(&mut self, _physics: &Physics, _world_from_before: &Pose) {}

    /// The newest odometry at or before a time between the last two steps.
    fn odometry_at(&self, physics: &Physics, stamp_ns: u64) -> Odometry;

    /// Lets odometry begin at zero here and now.
    fn reset_odometry(&mut self, physics: &Physics);

    /// Turns the motors' power on or off, where it can be.
    fn set_motor_power(&mut self, _on: bool) {}
}

impl dyn Base {
    /// Returns the base as the type that it has, or `None` if it has another one.
    pub fn downcast_ref<B: Base>(&self) -> Option<&B> {
        let base: &dyn Any = self;
        base.downcast_ref()
    }
}
