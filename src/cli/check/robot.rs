//! A robot: the tree of its links, its sensors, its base.

use super::sensor;
use super::text::{number, pose, vector};
use crate::description::model::{Joint, JointKind, LinkIndex, Model};
use crate::rig::base;
use crate::robot::imu::Imu;
use crate::robot::kobuki::Wheels;
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
        lines.extend(sensor::report(robot, sensor, gazebo_compat));
    }
    if Wheels::of(robot).is_ok() {
        lines.push(String::new());
        lines.extend(base_report(robot));
    }
    lines.push(String::new());
    lines
}

/// What the base tells and is told, as a Kobuki's driver.
fn base_report(robot: &Model) -> Vec<String> {
    let mut lines = vec!["base kobuki".to_owned()];
    let mut say = |what: &str, value: String| lines.push(format!("  {what:12} {value}"));
    say("topics", "/odom, /joint_states, /tf, /tf_static".into());
    say("", format!("{}, {}", base::IMU_TOPIC, base::CORE_TOPIC));
    say("", format!("{}, {}", base::BUMPER_TOPIC, base::CLIFF_TOPIC));
    say("", base::WHEEL_DROP_TOPIC.into());
    say("commands", "/cmd_vel".into());
    say("", format!("{}, {}", commands::RESET_ODOMETRY_TOPIC, commands::MOTOR_POWER_TOPIC));
    say("IMU frame", robot.links[Imu::mount(robot)].name.clone());
    lines
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
