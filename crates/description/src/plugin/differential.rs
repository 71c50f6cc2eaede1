//! Bases whose wheels on each side turn alike: `libgazebo_ros_diff_drive.so`,
//! `libgazebo_ros_skid_steer_drive.so`, `libgazebo_ros_create.so`, gz-sim's `DiffDrive`.

use super::parameters::Parameters;
use crate::model::{BasePlugin, DifferentialDrive, Drive, ModelPlugin, OdometryOrigin, OdometryPlugin};

/// The variance of quantities that odometry does not measure, as in Gazebo's plugins.
const UNKNOWN: f64 = 1e12;

/// The variance of the pose, as in Gazebo's plugins.
const POSE_VARIANCE: [f64; 6] = [1e-5, 1e-5, UNKNOWN, UNKNOWN, UNKNOWN, 1e-3];

pub(super) fn differential(given: &mut Parameters<'_>) -> Option<ModelPlugin> {
    let left = given.joints(&["leftJoint", "left_joint"], "left_joint");
    let right = given.joints(&["rightJoint", "right_joint"], "right_joint");
    let separation_m = given.length(&["wheelSeparation", "wheel_separation"], 0.34);
    let diameter_m = given.length(&["wheelDiameter", "wheel_diameter"], 0.15);
    let torque_n_m = given.not_negative(&["wheelTorque", "max_wheel_torque"], 5.0);
    let acceleration = given.not_negative(&["wheelAcceleration", "max_wheel_acceleration"], 0.0);
    let rate_hz = given.rate(&["updateRate", "update_rate"], 100.0)?;
    // The plugin treats every value except "encoder" as "world".
    let origin = match given.text(&["odometrySource", "odometry_source"]).as_deref() {
        Some("encoder" | "ENCODER" | "0") => OdometryOrigin::Encoders,
        _ => OdometryOrigin::World,
    };
    base(
        given,
        Wanted { left, right, separation_m, diameter_m, torque_n_m, acceleration, rate_hz, origin },
        false,
    )
}

pub(super) fn skid_steer(given: &mut Parameters<'_>) -> Option<ModelPlugin> {
    let mut pair = |front: &str, front_default: &str, rear: &str, rear_default: &str| {
        let (front, rear) = (given.joint(&[front], front_default), given.joint(&[rear], rear_default));
        Some(vec![front?, rear?])
    };
    let left = pair("leftFrontJoint", "left_front_joint", "leftRearJoint", "left_rear_joint");
    let right = pair("rightFrontJoint", "right_front_joint", "rightRearJoint", "right_rear_joint");
    let separation_m = given.length(&["wheelSeparation"], 0.4);
    let diameter_m = given.length(&["wheelDiameter"], 0.15);
    let torque_n_m = given.not_negative(&["torque"], 5.0);
    let rate_hz = given.rate(&["updateRate"], 100.0)?;
    let mut variance = POSE_VARIANCE;
    let names = [("covariance_x", 0, 1e-4), ("covariance_y", 1, 1e-4), ("covariance_yaw", 5, 0.01)];
    for (name, axis, default) in names {
        variance[axis] = given.not_negative(&[name], default)?;
    }
    let (origin, acceleration) = (OdometryOrigin::World, Some(0.0));
    let wanted = Wanted { left, right, separation_m, diameter_m, torque_n_m, acceleration, rate_hz, origin };
    let mut plugin = base(given, wanted, true)?;
    if let ModelPlugin::Base(base) = &mut plugin {
        base.odometry.pose_variance = variance;
    }
    Some(plugin)
}

/// Reads the base of the first TurtleBot. Its driver stops when no commands arrive.
pub(super) fn create(given: &mut Parameters<'_>) -> Option<ModelPlugin> {
    let left = given.joints(&["left_wheel_joint"], "left_wheel_joint");
    let right = given.joints(&["right_wheel_joint"], "right_wheel_joint");
    let separation_m = given.length(&["wheel_separation"], 0.26);
    let diameter_m = given.length(&["wheel_diameter"], 0.066);
    let torque_n_m = given.not_negative(&["torque"], 0.5);
    let (origin, acceleration) = (OdometryOrigin::Encoders, Some(0.0));
    let wanted = Wanted {
        left,
        right,
        separation_m,
        diameter_m,
        torque_n_m,
        acceleration,
        rate_hz: Some(50.0),
        origin,
    };
    let mut plugin = base(given, wanted, false)?;
    if let ModelPlugin::Base(base) = &mut plugin {
        base.command_timeout_s = Some(0.6);
        base.odometry.pose_variance = [1e-3, 1e-3, 1e6, 1e6, 1e6, 1e3];
    }
    Some(plugin)
}

/// Reads gz-sim's plugin, whose topics are under the model's name.
pub(super) fn gz(given: &mut Parameters<'_>) -> Option<ModelPlugin> {
    let left = given.joints(&["left_joint"], "left_joint");
    let right = given.joints(&["right_joint"], "right_joint");
    let separation_m = given.length(&["wheel_separation"], 1.0);
    let diameter_m = given.length(&["wheel_radius"], 0.2).map(|radius_m| 2.0 * radius_m);
    let acceleration = given.not_negative(&["max_linear_acceleration", "max_acceleration"], 0.0);
    let rate_hz = given.rate(&["odom_publish_frequency"], 50.0);
    let odometry = gz_odometry(given, rate_hz?);
    let name = given.model.name.clone();
    let command_topic = given.topic(&["topic"], &format!("model/{name}/cmd_vel"));
    let wheels = given.wheels(left?, right?, Some(0.5 * diameter_m?), f64::INFINITY)?;
    Some(ModelPlugin::Base(Box::new(BasePlugin {
        drive: Drive::Differential(DifferentialDrive {
            wheels,
            separation_m: separation_m?,
            acceleration_m_s2: acceleration.filter(|limit| *limit > 0.0),
            skids: false,
        }),
        command_topic,
        command_timeout_s: None,
        odometry,
        source: given.plugin.source.clone(),
    })))
}

/// Reads the odometry of gz-sim's bases.
pub(super) fn gz_odometry(given: &mut Parameters<'_>, rate_hz: Option<f64>) -> OdometryPlugin {
    let name = given.model.name.clone();
    let link = given.link(&[], "base_footprint");
    let link_name = given.model.links.get(link).map(|link| link.name.clone()).unwrap_or_default();
    OdometryPlugin {
        topic: given.topic(&["odom_topic"], &format!("model/{name}/odometry")),
        frame: given.text(&["frame_id"]).unwrap_or_else(|| format!("{name}/odom")),
        child_frame: given.text(&["child_frame_id"]).unwrap_or(link_name),
        link,
        rate_hz,
        origin: OdometryOrigin::Encoders,
        is_transform: true,
        pose_variance: [0.0; 6],
    }
}

/// The values that were read; each is none after an error.
struct Wanted {
    left: Option<Vec<usize>>,
    right: Option<Vec<usize>>,
    separation_m: Option<f64>,
    diameter_m: Option<f64>,
    torque_n_m: Option<f64>,
    acceleration: Option<f64>,
    /// None for every step.
    rate_hz: Option<f64>,
    origin: OdometryOrigin,
}

fn base(given: &mut Parameters<'_>, wanted: Wanted, skids: bool) -> Option<ModelPlugin> {
    let odometry = given.odometry(wanted.rate_hz, wanted.origin, POSE_VARIANCE);
    let command_topic = given.topic(&["commandTopic", "command_topic"], "cmd_vel");
    let radius_m = Some(0.5 * wanted.diameter_m?);
    let wheels = given.wheels(wanted.left?, wanted.right?, radius_m, wanted.torque_n_m?)?;
    Some(ModelPlugin::Base(Box::new(BasePlugin {
        drive: Drive::Differential(DifferentialDrive {
            wheels,
            separation_m: wanted.separation_m?,
            acceleration_m_s2: wanted.acceleration.filter(|limit| *limit > 0.0),
            skids,
        }),
        command_topic,
        command_timeout_s: None,
        odometry,
        source: given.plugin.source.clone(),
    })))
}
