//! `libgazebo_ros_planar_move.so`, and `libgazebo_ros_force_based_move.so`, which does the same with forces.

use super::parameters::Parameters;
use crate::model::{BasePlugin, Drive, ModelPlugin, OdometryOrigin};

/// Reads the force-based plugin. Its gains are for the forces of another physics engine and are ignored.
pub(super) fn force_based(given: &mut Parameters<'_>) -> Option<ModelPlugin> {
    // Here 0 is no limit.
    let timeout_s = given.not_negative(&["commandTimeoutDuration"], 0.0)?;
    let mut plugin = planar(given)?;
    if let ModelPlugin::Base(base) = &mut plugin
        && timeout_s > 0.0
    {
        base.command_timeout_s = Some(timeout_s);
    }
    Some(plugin)
}

pub(super) fn planar(given: &mut Parameters<'_>) -> Option<ModelPlugin> {
    let rate_hz = given.rate(&["odometryRate", "publish_rate"], 20.0)?;
    // If negative, a command holds until the next one.
    let timeout_s = given.number(&["cmdTimeout", "cmd_timeout"], -1.0, |_| true, "")?;
    let odometry = given.odometry(rate_hz, OdometryOrigin::World, [1e-5, 1e-5, 1e12, 1e12, 1e12, 1e-3]);
    let command_topic = given.topic(&["commandTopic", "command_topic"], "cmd_vel");
    Some(ModelPlugin::Base(Box::new(BasePlugin {
        drive: Drive::Planar,
        command_topic,
        command_timeout_s: (timeout_s >= 0.0).then_some(timeout_s),
        odometry,
        source: given.plugin.source.clone(),
    })))
}
