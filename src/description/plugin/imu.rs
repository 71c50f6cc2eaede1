//! `libgazebo_ros_imu.so` and `libhector_gazebo_ros_imu.so`.

use super::parameters::Parameters;
use crate::description::model::{ImuPlugin, ModelPlugin};

pub(super) fn imu(given: &mut Parameters<'_>) -> Option<ModelPlugin> {
    let stddev = given.not_negative(&["gaussianNoise", "gaussian_noise"], 0.0);
    unit(given, stddev, stddev)
}

/// Team Hector's, which many robots carry; its drifts and offsets are not simulated.
pub(super) fn hector(given: &mut Parameters<'_>) -> Option<ModelPlugin> {
    let (turn, acceleration) = (given.greatest("rateGaussianNoise"), given.greatest("accelGaussianNoise"));
    unit(given, turn, acceleration)
}

fn unit(given: &mut Parameters<'_>, turn: Option<f64>, acceleration: Option<f64>) -> Option<ModelPlugin> {
    let link = given.link(&["bodyName", "body_name"], "base_link");
    let rate_hz = given.rate(&["updateRate", "update_rate"], 0.0);
    let link_from_imu = given.offset();
    let topic = given.topic(&["topicName", "topic_name"], "imu");
    let of_link = given.model.links.get(link).map(|link| link.name.clone());
    let frame = given.text(&["frameName", "frame_name", "frameId"]).or(of_link).unwrap_or_default();
    given.left_out();
    Some(ModelPlugin::Imu(ImuPlugin {
        topic,
        link,
        link_from_imu: link_from_imu?,
        frame,
        rate_hz: rate_hz?,
        turn_stddev: turn?,
        acceleration_stddev: acceleration?,
    }))
}
