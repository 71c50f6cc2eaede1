//! What drives a model: one implementation of [`Base`] for each way to drive, found by the model's plugin.

use super::ackermann::Ackermann;
use super::command::Command;
use super::differential::Differential;
use super::grip::Axle;
use super::kobuki::Kobuki;
use super::odometry::Odometry;
use super::planar::Planar;
use crate::description::diagnostics::{Problem, Severity};
use crate::description::model::{BasePlugin, Drive, JointIndex, Model};
use crate::world::physics::{ModelIndex, Physics};
use belvedere_sensors::Pose;
use std::fmt::Debug;

/// A base in the world. [`Base::control`] is called before each step, [`Base::observe`] after it.
pub trait Base: Debug {
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

    /// What only a Kobuki has.
    fn as_kobuki(&self) -> Option<&Kobuki> {
        None
    }
}

/// The base of a model that is in `physics`.
///
/// # Errors
/// If the model has none, a note; if it cannot drive, a warning.
pub(super) fn of_model(
    model: &Model,
    index: ModelIndex,
    physics: &mut Physics,
) -> Result<Box<dyn Base>, Problem> {
    let plugin = check(model)?;
    Ok(match &plugin.drive {
        Drive::Kobuki(wheels) => Box::new(Kobuki::new(model, plugin, wheels, index, physics)?),
        Drive::Differential(drive) => Box::new(Differential::new(model, plugin, drive, index, physics)?),
        Drive::Planar => Box::new(Planar::new(model, plugin, index, physics)),
        Drive::Ackermann(drive) => Box::new(Ackermann::new(model, plugin, drive, index, physics)?),
    })
}

/// The joints that a base turns itself, not physics: of none if it cannot drive.
pub(super) fn carried_joints(model: &Model) -> Vec<JointIndex> {
    match model.base() {
        Some(plugin) if can_drive(model, plugin).is_err() => Vec::new(),
        Some(plugin) if plugin.drive == Drive::Planar => super::planar::wheels(model),
        Some(plugin) => plugin.drive.joints(),
        None => Vec::new(),
    }
}

/// Whether a model has a base that drives.
///
/// # Errors
/// A note if it has none, a warning if it cannot drive.
pub fn check(model: &Model) -> Result<&BasePlugin, Problem> {
    let plugin = model.base().ok_or_else(|| no_base(model))?;
    can_drive(model, plugin).map(|()| plugin)
}

fn can_drive(model: &Model, plugin: &BasePlugin) -> Result<(), Problem> {
    if model.is_static {
        return Err(Problem {
            severity: Severity::Warning,
            source: plugin.source.clone(),
            what: format!("robot '{}' cannot drive: it is static", model.name),
            remedy: "take its <static> out".into(),
        });
    }
    match &plugin.drive {
        Drive::Kobuki(wheels) => Axle::of(model, plugin, wheels).map(|_| ()),
        Drive::Differential(drive) => Axle::of(model, plugin, &drive.wheels).map(|_| ()),
        Drive::Planar => Ok(()),
        Drive::Ackermann(drive) => super::ackermann::Steering::of(model, plugin, drive).map(|_| ()),
    }
}

fn no_base(model: &Model) -> Problem {
    Problem {
        severity: Severity::Note,
        source: model.source.clone(),
        what: format!("robot '{}' does not drive: it has no <plugin> of a base", model.name),
        remedy: "give it that of its base in a <gazebo>, such as <plugin name=\"kobuki\" \
                 filename=\"libgazebo_ros_kobuki.so\"/>, if it is to drive"
            .into(),
    }
}
