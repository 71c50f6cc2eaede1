//! The report on a robot: the tree of its links, its sensors, its base.

use super::counted::fiducials;
use super::streams::Streams;
use crate::description::model::{
    BasePlugin, Drive, Joint, JointKind, LinkIndex, Model, ModelPlugin, OdometryOrigin,
};
use crate::description::text::{number, pose, vector};
use crate::rig::Part;
use crate::rig::sensor_report::sensor_report;
use crate::robot::drives;
use crate::server::commands;

/// Returns the report on a robot, which has this number in the simulation and this namespace.
pub(super) fn report(
    robot: &Model,
    namespace: &str,
    number: usize,
    streams: &Streams,
    gazebo_compat: bool,
) -> Vec<String> {
    let mut lines = vec![format!("robot {} ({})", robot.name, robot.source)];
    if !namespace.is_empty() {
        lines.push(format!("namespace /{namespace}"));
    }
    lines.extend(tree(robot));
    let tags = fiducials(robot).map(|line| format!("fiducials: {line}"));
    lines.extend(tags.into_iter().flat_map(|line| [String::new(), line]));
    for (index, sensor) in robot.sensors.iter().enumerate() {
        lines.push(String::new());
        lines.extend(sensor_report(robot, sensor, gazebo_compat));
        lines.extend(streams.of_part(number, Part::Sensor(index)));
    }
    lines.push(String::new());
    lines.push("robot state".to_owned());
    lines.extend(streams.of_part(number, Part::Robot));
    lines.extend(parts(robot, number, streams));
    lines.push(String::new());
    lines
}

/// Returns the report on a model's plugins, with their topics: its base first.
pub(super) fn parts(model: &Model, number: usize, streams: &Streams) -> Vec<String> {
    let base = drives::check(model).ok();
    let mut lines: Vec<String> =
        base.into_iter().flat_map(|base| base_report(base, number, streams)).collect();
    let link = |link: LinkIndex| &model.links[link].name;
    for (index, plugin) in model.plugins.iter().enumerate() {
        match plugin {
            ModelPlugin::Base(_) => continue,
            ModelPlugin::Pose(pose) => {
                lines.push(format!("true pose of {} ({})", link(pose.link), pose.source));
            }
            ModelPlugin::JointStates(states) => lines.push(format!("joint states ({})", states.source)),
        }
        lines.extend(streams.of_part(number, Part::Plugin(index)));
    }
    lines
}

/// Returns the report on the base: its streams, its command topics and its odometry.
fn base_report(plugin: &BasePlugin, number: usize, streams: &Streams) -> Vec<String> {
    let mut lines = vec![format!("base {} ({})", plugin.drive.name(), plugin.source)];
    lines.extend(streams.of_part(number, Part::Base));
    let mut say = |what: &str, value: String| lines.push(format!("  {what:12} {value}"));
    say("commands", plugin.command_topic.clone());
    if matches!(plugin.drive, Drive::Kobuki(_)) {
        say("", format!("{}, {}", commands::RESET_ODOMETRY_TOPIC, commands::MOTOR_POWER_TOPIC));
    }
    let odometry = &plugin.odometry;
    let from = match odometry.origin {
        OdometryOrigin::Encoders => "the turns of the wheels",
        OdometryOrigin::World => "the true pose in the world",
    };
    say("odometry", format!("of {} in {}, from {from}", odometry.child_frame, odometry.frame));
    lines
}

/// Draws the tree of links. Each link is expanded once, even if joints of an SDF model close a loop.
fn tree(model: &Model) -> Vec<String> {
    let (mut lines, mut shown) = (Vec::new(), vec![false; model.links.len()]);
    let above = model.joints_above();
    let is_root = |link: &LinkIndex| above[*link].is_none();
    let links = || 0..model.links.len();
    // Links that cannot be reached from a root are part of a loop.
    for link in links().filter(is_root).chain(links()) {
        if !std::mem::replace(&mut shown[link], true) {
            lines.push(link_line(model, link));
            branch(model, link, "", &mut shown, &mut lines);
        }
    }
    lines
}

/// Adds the joints below a link. A branch ends with a remark at a link that is already `shown`.
fn branch(model: &Model, parent: LinkIndex, indent: &str, shown: &mut [bool], lines: &mut Vec<String>) {
    let below: Vec<&Joint> = model.joints.iter().filter(|joint| joint.parent == parent).collect();
    for (number, joint) in below.iter().enumerate() {
        let is_last = number + 1 == below.len();
        let (fork, further) = if is_last { ("└─ ", "   ") } else { ("├─ ", "│  ") };
        let (kind, place) = (joint_kind(joint), pose(&joint.parent_from_child));
        if std::mem::replace(&mut shown[joint.child], true) {
            let name = &model.links[joint.child].name;
            lines.push(format!("{indent}{fork}{name}, shown already  {kind} {place}"));
            continue;
        }
        lines.push(format!("{indent}{fork}{}  {kind} {place}", link_line(model, joint.child)));
        branch(model, joint.child, &format!("{indent}{further}"), shown, lines);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::load::{Described, LoadOptions, load_text};
    use crate::description::models::package_path;
    use crate::description::{Diagnostics, Rules};

    #[test]
    fn a_joint_that_closes_a_loop_ends_its_branch() {
        let joint = |parent: &str, child: &str| {
            format!(
                "<joint name='{parent}{child}' type='fixed'><parent>{parent}</parent><child>{child}</child></joint>"
            )
        };
        let ends = [("a", "b"), ("b", "c"), ("c", "b"), ("a", "c"), ("d", "e"), ("e", "d")];
        let joints: String = ends.iter().map(|(parent, child)| joint(parent, child)).collect();
        let links: String = ["a", "b", "c", "d", "e"].map(|name| format!("<link name='{name}'/>")).concat();
        let text = format!("<sdf version='1.6'><model name='m'>{links}{joints}</model></sdf>");
        let packages = package_path([], None);
        let options = LoadOptions { packages, rules: Rules::default(), xacro_args: Vec::new() };
        let mut diagnostics = Diagnostics::default();
        let loaded = load_text(&text, "m.sdf", &options, &mut diagnostics);
        let Some(Described::Model(model)) = loaded else { panic!("{:?}", diagnostics.problems()) };
        let names: Vec<String> = tree(&model)
            .iter()
            .map(|line| line.split("  fixed").next().unwrap_or_default().replace(" [1 kg]", ""))
            .collect();
        let expected = [
            "a",
            "├─ b",
            "│  └─ c",
            "│     └─ b, shown already",
            "└─ c, shown already",
            "d",
            "└─ e",
            "   └─ d, shown already",
        ];
        assert_eq!(names, expected);
    }
}
