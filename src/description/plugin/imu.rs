//! `libgazebo_ros_imu.so`.

use super::parameters::Parameters;
use crate::description::model::{ImuPlugin, ModelPlugin};

pub(super) fn imu(given: &mut Parameters<'_>) -> Option<ModelPlugin> {
    let link = given.link(&["bodyName", "body_name"], "base_link");
    let rate_hz = given.rate(&["updateRate", "update_rate"], 0.0);
    let stddev = given.not_negative(&["gaussianNoise", "gaussian_noise"], 0.0);
    let link_from_imu = given.offset();
    let topic = given.topic(&["topicName", "topic_name"], "imu");
    let of_link = given.model.links.get(link).map(|link| link.name.clone());
    let frame = given.text(&["frameName", "frame_name"]).or(of_link).unwrap_or_default();
    given.left_out();
    let (link_from_imu, rate_hz, stddev) = (link_from_imu?, rate_hz?, stddev?);
    Some(ModelPlugin::Imu(ImuPlugin { topic, link, link_from_imu, frame, rate_hz, stddev }))
}
