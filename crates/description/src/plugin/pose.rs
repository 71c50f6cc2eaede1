//! `libgazebo_ros_p3d.so`: the true pose of a link.

use super::parameters::Parameters;
use crate::model::{ModelPlugin, PosePlugin};

pub(super) fn pose(given: &mut Parameters<'_>) -> Option<ModelPlugin> {
    let link = given.link(&["bodyName", "body_name"], "base_link");
    let rate_hz = given.rate(&["updateRate", "update_rate"], 0.0);
    let stddev = given.not_negative(&["gaussianNoise", "gaussian_noise"], 0.0);
    let offset = given.offset();
    let default = if given.element(&["ros"]).is_some() { "odom" } else { "ground_truth" };
    let topic = given.topic(&["topicName", "topic_name"], default);
    let frame = given.text(&["frameName", "frame_name"]).unwrap_or_else(|| "world".into());
    let frame = frame.trim_start_matches('/').to_owned();
    let source = given.plugin.source.clone();
    let (offset, rate_hz, stddev) = (offset?, rate_hz?, stddev?);
    Some(ModelPlugin::Pose(PosePlugin { topic, link, frame, offset, rate_hz, stddev, source }))
}
