//! `libgazebo_ros_joint_state_publisher.so`, and gz-sim's `JointStatePublisher`.

use super::parameters::Parameters;
use crate::model::{JointStatesPlugin, ModelPlugin};

pub(super) fn joint_states(given: &mut Parameters<'_>) -> Option<ModelPlugin> {
    let topic = given.topic(&[], "joint_states");
    reporter(given, topic)
}

/// Reads gz-sim's plugin, whose topic is under the model's name; gz-sim's prefix with the world's name is omitted.
pub(super) fn gz(given: &mut Parameters<'_>) -> Option<ModelPlugin> {
    let name = given.model.name.clone();
    let topic = given.topic(&["topic"], &format!("model/{name}/joint_state"));
    reporter(given, topic)
}

fn reporter(given: &mut Parameters<'_>, topic: String) -> Option<ModelPlugin> {
    // Either one element with names separated by commas, or one element for each name.
    let is_name = |name: &str| name == "jointName" || name == "joint_name";
    let texts: Vec<String> = given
        .plugin
        .elements()
        .filter(|element| is_name(&element.name))
        .flat_map(|element| {
            let text = element.text();
            text.split([',', ' ']).filter(|name| !name.is_empty()).map(str::to_owned).collect::<Vec<_>>()
        })
        .collect();
    for name in &texts {
        if !given.model.joints.iter().any(|joint| joint.name == *name) {
            given.warning(&format!("there is no joint '{name}'"), "correct its name");
        }
    }
    let rate_hz = given.rate(&["updateRate", "update_rate"], 100.0)?;
    let source = given.plugin.source.clone();
    Some(ModelPlugin::JointStates(JointStatesPlugin { topic, joints: texts, rate_hz, source }))
}
