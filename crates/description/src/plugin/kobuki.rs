//! `libgazebo_ros_kobuki.so`.

use super::parameters::Parameters;
use crate::model::{BasePlugin, Drive, ModelPlugin, OdometryOrigin, OdometryPlugin};

/// The variance of quantities that a Kobuki's odometry does not measure: z, roll, pitch.
const UNKNOWN: f64 = 1e6;

/// Rate of everything that a Kobuki publishes, in Hz.
const RATE_HZ: f64 = 50.0;

pub(super) fn kobuki(given: &mut Parameters<'_>) -> Option<ModelPlugin> {
    let left = given.joints(&["left_wheel_joint_name"], "wheel_left_joint");
    let right = given.joints(&["right_wheel_joint_name"], "wheel_right_joint");
    let torque_n_m = given.positive(&["torque"], 1.0);
    let timeout_s = given.positive(&["velocity_command_timeout"], 0.6);
    let is_transform = given.flag(&["publish_tf"], true);
    let link = given.link(&[], "base_footprint");
    let wheels = given.wheels(left?, right?, None, torque_n_m?)?;
    Some(ModelPlugin::Base(Box::new(BasePlugin {
        drive: Drive::Kobuki(wheels),
        command_topic: given.topic(&[], "cmd_vel"),
        command_timeout_s: Some(timeout_s?),
        odometry: OdometryPlugin {
            topic: given.topic(&[], "odom"),
            frame: "odom".into(),
            child_frame: given.model.links.get(link).map(|link| link.name.clone()).unwrap_or_default(),
            link,
            rate_hz: Some(RATE_HZ),
            origin: OdometryOrigin::Encoders,
            is_transform,
            pose_variance: [0.1, 0.1, UNKNOWN, UNKNOWN, UNKNOWN, 0.05],
        },
        source: given.plugin.source.clone(),
    })))
}
