//! `libgazebo_ros_ft_sensor.so` of ROS 1 and ROS 2: the wrench that a joint's child exerts on its parent.

use super::parameters::Parameters;
use crate::model::{ForceTorque, InstrumentPlugin, JointIndex, MeasureFrame, Sensor, SensorKind};
use crate::sensor::ros2;
use belvedere_sensors::Pose;
use belvedere_sensors::noise::InstrumentConfig;

/// The elements that name the joint.
const JOINT: [&str; 2] = ["jointName", "joint_name"];

pub(super) fn force_torque(given: &mut Parameters<'_>) -> Option<Sensor> {
    let noise = given.not_negative(&["gaussianNoise", "gaussian_noise"], 0.0);
    let rate_hz = given.rate(&["updateRate", "update_rate"], 0.0);
    let of_ros2 = given.element(&["ros"]).is_some() || given.element(&JOINT[1..]).is_some();
    let topic = if of_ros2 {
        ros2::topic(given.plugin, "wrench", &[])
    } else {
        given.topic(&["topicName"], "wrench")
    };
    let index = joint(given)?;
    let joint = &given.model.joints[index];
    let (link, link_from_sensor) = (joint.child, Pose::from_translation(joint.pivot));
    let errors = InstrumentConfig::default().stddev([noise?; 3]);
    let sensor = ForceTorque {
        joint: index,
        frame: MeasureFrame::Child,
        parent_to_child: false,
        force: errors,
        torque: errors,
        plugin: Some(InstrumentPlugin { topic, frame_name: String::new() }),
    };
    Some(given.sensor(link, link_from_sensor, rate_hz?, SensorKind::ForceTorque(sensor.into())))
}

/// The joint that the plugin names; none if it names none that there is, and that is told.
fn joint(given: &mut Parameters<'_>) -> Option<JointIndex> {
    let plugin = given.plugin;
    let Some(element) = given.element(&JOINT) else {
        if given.element(&["body_name"]).is_some() {
            given.warning(
                "it measures the forces on the link of its <body_name>, which is not simulated: it is left out",
                "write <joint_name>NAME OF A JOINT</joint_name>",
            );
            return None;
        }
        let what = format!("plugin '{}' has no <jointName>", given.name());
        given.unusable(plugin, what, "write <jointName>NAME OF A JOINT</jointName>");
        return None;
    };
    let name = element.text();
    let joints = &given.model.joints;
    let ends = |joint: &str| joint.rsplit("::").next() == Some(name.as_str());
    let found = joints.iter().position(|joint| joint.name == name);
    let found = found.or_else(|| joints.iter().position(|joint| ends(&joint.name)));
    if found.is_none() {
        let what = format!(
            "<{}> of plugin '{}' is '{name}', and there is no such joint",
            element.name,
            given.name()
        );
        let near = given.did_you_mean(&name, joints.iter().map(|joint| joint.name.as_str()));
        given.unusable(element, what, &near.unwrap_or_default());
    }
    found
}
