//! The registry of bases: one implementation of [`Base`] for each kind of drive, selected by the model's plugin.

use super::ackermann::Ackermann;
use super::base::Base;
use super::differential::Differential;
use super::grip::Axle;
use super::kobuki::Kobuki;
use super::planar::Planar;
use crate::description::diagnostics::{Problem, Severity};
use crate::description::model::{BasePlugin, Drive, JointIndex, Model};
use crate::world::physics::{ModelIndex, Physics};

/// Creates the base of a model that is in `physics`.
///
/// # Errors
/// A note if the model has no base, a warning if it cannot drive.
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

/// Returns the joints that the base turns itself, instead of physics; empty if it cannot drive.
pub(super) fn carried_joints(model: &Model) -> Vec<JointIndex> {
    match model.base() {
        Some(plugin) if can_drive(model, plugin).is_err() => Vec::new(),
        Some(plugin) if plugin.drive == Drive::Planar => super::planar::wheels(model),
        Some(plugin) => plugin.drive.joints(),
        None => Vec::new(),
    }
}

/// Returns the plugin of the base, if the model has one that can drive.
///
/// # Errors
/// A note if the model has no base, a warning if it cannot drive.
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
        remedy: "add the plugin of its base in a <gazebo>, such as <plugin name=\"kobuki\" \
                 filename=\"libgazebo_ros_kobuki.so\"/>, if it is to drive"
            .into(),
    }
}
