//! Cars: `libgazebo_ros_ackermann_drive.so`, with commands of speed and steering angle, and gz-sim's `AckermannSteering`,
//! with commands of speed and yaw rate.

use super::differential::gz_odometry;
use super::parameters::Parameters;
use crate::model::{AckermannDrive, BasePlugin, Drive, ModelPlugin, OdometryOrigin};

/// Steering rate in rad/s per rad of error, in place of gains for another physics engine.
const STEERING_GAIN: f64 = 10.0;

pub(super) fn ackermann(given: &mut Parameters<'_>) -> Option<ModelPlugin> {
    let rear_left = given.joints(&["rear_left_joint"], "rear_left_joint");
    let rear_right = given.joints(&["rear_right_joint"], "rear_right_joint");
    let front_left = given.joints(&["front_left_joint"], "front_left_joint");
    let front_right = given.joints(&["front_right_joint"], "front_right_joint");
    let left = given.joint(&["left_steering_joint"], "left_steering_joint");
    let right = given.joint(&["right_steering_joint"], "right_steering_joint");
    let steering_limit_rad = given.number(
        &["max_steer"],
        0.6,
        |angle| angle > 0.0 && angle < std::f64::consts::FRAC_PI_2,
        "write an angle in radians above 0 and below π/2",
    );
    let max_speed_m_s = given.positive(&["max_speed"], 20.0);
    let rate_hz = given.rate(&["updateRate", "update_rate"], 100.0)?;
    let odometry = given.odometry(rate_hz, OdometryOrigin::World, [1e-5, 1e-5, 1e12, 1e12, 1e12, 1e-3]);
    let command_topic = given.topic(&["commandTopic", "command_topic"], "cmd_vel");
    let rear = given.wheels(rear_left?, rear_right?, None, f64::INFINITY)?;
    let front = given.wheels(front_left?, front_right?, None, 0.0)?;
    Some(ModelPlugin::Base(Box::new(BasePlugin {
        drive: Drive::Ackermann(AckermannDrive {
            rear,
            front: Some(front),
            steering: [left?, right?],
            wheel_base_m: None,
            steering_limit_rad: steering_limit_rad?,
            steering_gain: STEERING_GAIN,
            max_speed_m_s: max_speed_m_s?,
            is_told_angle: true,
        }),
        command_topic,
        command_timeout_s: None,
        odometry,
        source: given.plugin.source.clone(),
    })))
}

pub(super) fn gz(given: &mut Parameters<'_>) -> Option<ModelPlugin> {
    let left = given.joints(&["left_joint"], "left_joint");
    let right = given.joints(&["right_joint"], "right_joint");
    let steer_left = given.joint(&["left_steering_joint"], "left_steering_joint");
    let steer_right = given.joint(&["right_steering_joint"], "right_steering_joint");
    let radius_m = given.length(&["wheel_radius"], 0.2);
    let wheel_base_m = given.length(&["wheel_base"], 1.0);
    let steering_limit_rad = given.number(
        &["steering_limit"],
        0.5,
        |angle| angle > 0.0 && angle < std::f64::consts::FRAC_PI_2,
        "write an angle in radians above 0 and below π/2",
    );
    let steering_gain = given.positive(&["steer_p_gain"], 1.0);
    let max_speed_m_s = given.positive(&["max_velocity"], f64::INFINITY);
    let rate_hz = given.rate(&["odom_publish_frequency"], 50.0)?;
    let odometry = gz_odometry(given, rate_hz);
    let name = given.model.name.clone();
    let command_topic = given.topic(&["topic"], &format!("model/{name}/cmd_vel"));
    let steering = [steer_left?, steer_right?];
    // gz-sim uses one name for all wheels: those on steered links are the front ones.
    let model = given.model;
    let steers = |wheel: &usize| {
        steering.iter().any(|joint| model.joints[*joint].child == model.joints[*wheel].parent)
    };
    let (front_left, rear_left): (Vec<_>, Vec<_>) = left?.into_iter().partition(steers);
    let (front_right, rear_right): (Vec<_>, Vec<_>) = right?.into_iter().partition(steers);
    if rear_left.is_empty() || rear_right.is_empty() {
        given.warning("all wheels steer: it is left out", "name the wheels of the other axle, too");
        return None;
    }
    let front = given.wheels(front_left, front_right, radius_m, 0.0)?;
    let rear = given.wheels(rear_left, rear_right, radius_m, f64::INFINITY)?;
    Some(ModelPlugin::Base(Box::new(BasePlugin {
        drive: Drive::Ackermann(AckermannDrive {
            rear,
            front: (!front.left.is_empty() && !front.right.is_empty()).then_some(front),
            steering,
            wheel_base_m: Some(wheel_base_m?),
            steering_limit_rad: steering_limit_rad?,
            steering_gain: steering_gain?,
            max_speed_m_s: max_speed_m_s?,
            is_told_angle: false,
        }),
        command_topic,
        command_timeout_s: None,
        odometry,
        source: given.plugin.source.clone(),
    })))
}
