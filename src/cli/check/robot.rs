//! A robot: the tree of its links, its sensors, its base.

use crate::description::model::{
    BasePlugin, Drive, Joint, JointKind, LinkIndex, Model, ModelPlugin, OdometryOrigin,
};
use crate::description::text::{number, pose, vector};
use crate::rig::base;
use crate::rig::report::sensor_report;
use crate::robot::base as drives;
use crate::robot::imu::Imu;
use crate::server::commands;

pub(super) fn report(robot: &Model, gazebo_compat: bool) -> Vec<String> {
    let mut lines = vec![format!("robot {} ({})", robot.name, robot.source)];
    let roots = (0..robot.links.len()).filter(|link| robot.joint_above(*link).is_none());
    for root in roots {
        lines.push(link_line(robot, root));
        branch(robot, root, "", &mut lines);
    }
    for sensor in &robot.sensors {
        lines.push(String::new());
        lines.extend(sensor_report(robot, sensor, gazebo_compat));
    }
    if let Ok(plugin) = drives::check(robot) {
        lines.push(String::new());
        lines.extend(base_report(robot, plugin));
    }
    lines.extend(reporters(robot));
    lines.push(String::new());
    lines
}

/// What the base tells and is told.
fn base_report(robot: &Model, plugin: &BasePlugin) -> Vec<String> {
    let mut lines = vec![format!("base {} ({})", plugin.drive.name(), plugin.source)];
    let mut say = |what: &str, value: String| lines.push(format!("  {what:12} {value}"));
    let odometry = &plugin.odometry;
    say("topics", format!("{}, /joint_states, /tf, /tf_static", odometry.topic));
    let is_kobuki = matches!(plugin.drive, Drive::Kobuki(_));
    if is_kobuki {
        say("", format!("{}, {}", base::IMU_TOPIC, base::CORE_TOPIC));
        say("", format!("{}, {}", base::BUMPER_TOPIC, base::CLIFF_TOPIC));
        say("", base::WHEEL_DROP_TOPIC.into());
    }
    say("commands", plugin.command_topic.clone());
    if is_kobuki {
        say("", format!("{}, {}", commands::RESET_ODOMETRY_TOPIC, commands::MOTOR_POWER_TOPIC));
        say("IMU frame", robot.links[Imu::mount(robot)].name.clone());
    }
    let from = match odometry.origin {
        OdometryOrigin::Encoders => "what the wheels turn",
        OdometryOrigin::World => "the true pose in the world",
    };
    say("odometry", format!("of {} in {}, from {from}", odometry.child_frame, odometry.frame));
    lines
}

/// What else its plugins report.
fn reporters(robot: &Model) -> Vec<String> {
    let rate = |hz: Option<f64>| hz.map_or("every step".to_owned(), |hz| format!("{} Hz", number(hz)));
    let link = |link: LinkIndex| &robot.links[link].name;
    let lines = robot.plugins.iter().filter_map(|plugin| {
        Some(match plugin {
            ModelPlugin::Base(_) => return None,
            ModelPlugin::Pose(pose) => {
                format!("true pose {} of {}, {}", pose.topic, link(pose.link), rate(pose.rate_hz))
            }
            ModelPlugin::JointStates(states) => {
                format!("joint states {}, {}", states.topic, rate(states.rate_hz))
            }
        })
    });
    lines.collect()
}

/// The joints below a link, drawn with lines. As deep as the tree, which the loader has checked to be one.
fn branch(model: &Model, parent: LinkIndex, indent: &str, lines: &mut Vec<String>) {
    let below: Vec<&Joint> = model.joints.iter().filter(|joint| joint.parent == parent).collect();
    for (number, joint) in below.iter().enumerate() {
        let is_last = number + 1 == below.len();
        let (fork, further) = if is_last { ("└─ ", "   ") } else { ("├─ ", "│  ") };
        let place = pose(&joint.parent_from_child);
        lines.push(format!("{indent}{fork}{}  {} {place}", link_line(model, joint.child), joint_kind(joint)));
        branch(model, joint.child, &format!("{indent}{further}"), lines);
    }
}

fn link_line(model: &Model, link: LinkIndex) -> String {
    let link = &model.links[link];
    let mass =
        link.inertial.map(|inertial| format!(" [{} kg]", number(inertial.mass_kg))).unwrap_or_default();
    format!("{}{mass}", link.name)
}

pub(super) fn joint_kind(joint: &Joint) -> String {
    let axis = || vector(joint.axis);
    match joint.kind {
        JointKind::Fixed => "fixed".into(),
        JointKind::Ball => format!("ball at {}", vector(joint.pivot)),
        JointKind::Floating => "floating".into(),
        JointKind::Continuous => format!("continuous about {}", axis()),
        JointKind::Revolute { lower, upper } => {
            format!("revolute about {} from {} to {} rad", axis(), number(lower), number(upper))
        }
        JointKind::Prismatic { lower, upper } => {
            format!("prismatic along {} from {} to {} m", axis(), number(lower), number(upper))
        }
    }
}
