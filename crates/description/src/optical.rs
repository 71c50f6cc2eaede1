//! The frames that pictures are in: x right, y down, z forward (REP-103).

use super::model::{LinkIndex, Model, Sensor, SensorKind};
use belvedere_sensors::Pose;
use glam::{DMat3, DQuat, DVec3};

/// How far two poses that are the same may be apart, in metres and in the quaternion's components.
const TOLERANCE: f64 = 1e-6;

/// A frame for the pictures of a camera whose plugin names a frame that looks another way, as of its own link, along x.
#[derive(Debug, Clone, PartialEq)]
pub struct OpticalFrame {
    /// Index of the camera in [`Model::sensors`].
    pub sensor: usize,
    /// The name of what the plugin names, or of the camera's link, with `_optical` behind it.
    pub name: String,
    /// The link that the plugin names.
    pub parent: LinkIndex,
    /// Where it is there: at the sensor.
    pub parent_from_frame: Pose,
    /// Whether the model has a link of that name and place already.
    pub is_link: bool,
}

/// Those that a model's cameras need, in the order of its sensors. A camera needs none if its plugin names an optical frame
/// that looks its way, or something that is no link of the model or moves against the camera.
///
/// Gazebo stamps pictures with whatever the plugin names; who projects with them by tf is then turned by 120° about the
/// diagonal.
pub fn optical_frames(model: &Model) -> Vec<OpticalFrame> {
    let mut frames: Vec<OpticalFrame> = Vec::new();
    for (index, sensor) in model.sensors.iter().enumerate() {
        let Some(parent) = named_link(model, sensor) else { continue };
        let parent_from_frame = link_from_optical(model, parent, sensor);
        // Where another link is that frame, the sensor is put there (`rig/mount.rs`).
        let is_there = parent != sensor.link || parent_from_frame.translation().length() < TOLERANCE;
        if is_there && is_near(parent_from_frame.rotation().dot(DQuat::IDENTITY).abs(), 1.0) {
            continue;
        }
        let same = |other: &Pose| {
            other.translation().distance(parent_from_frame.translation()) < TOLERANCE
                && is_near(other.rotation().dot(parent_from_frame.rotation()).abs(), 1.0)
        };
        let plain = format!("{}_optical", model.links[parent].name);
        // Two cameras of one frame that sit or look differently have two.
        let own = format!("{}_{}_optical", model.links[parent].name, sensor.name);
        let parent_from_model = model.links[parent].model_from_link.inverse();
        let fits = |name: &String| {
            let link = model.link_named(name);
            let by_link =
                link.is_none_or(|link| same(&(parent_from_model * model.links[link].model_from_link)));
            let by_frame = frames.iter().filter(|frame| frame.name == *name);
            by_link && by_frame.clone().all(|frame| frame.parent == parent && same(&frame.parent_from_frame))
        };
        let name = if fits(&plain) { plain } else { own };
        let is_link = model.link_named(&name).is_some();
        frames.push(OpticalFrame { sensor: index, name, parent, parent_from_frame, is_link });
    }
    frames
}

/// Those that no link of the model and no one before stands for.
pub fn new_frames(frames: &[OpticalFrame]) -> impl Iterator<Item = &OpticalFrame> {
    let is_first = |index: usize| frames[..index].iter().all(|before| before.name != frames[index].name);
    frames
        .iter()
        .enumerate()
        .filter(move |(index, frame)| !frame.is_link && is_first(*index))
        .map(|(_, frame)| frame)
}

/// The sensor's pose when it sits in an optical frame: forward, left and up are z, −x and −y there.
pub fn optical_from_sensor() -> Pose {
    Pose::new(DVec3::ZERO, DQuat::from_mat3(&DMat3::from_cols(DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y)))
}

/// The link that the pictures of a camera are said to be in, if it stands still against the camera.
fn named_link(model: &Model, sensor: &Sensor) -> Option<LinkIndex> {
    let name = match &sensor.kind {
        SensorKind::Camera(camera) => &camera.plugin.as_ref()?.frame_name,
        SensorKind::Depth(depth) => &depth.plugin.as_ref()?.camera.frame_name,
        _ => return None,
    };
    let link = if name.is_empty() { Some(sensor.link) } else { model.link_named(name) };
    link.filter(|link| model.rigid_root(*link) == model.rigid_root(sensor.link))
}

fn link_from_optical(model: &Model, link: LinkIndex, sensor: &Sensor) -> Pose {
    let model_from_sensor = model.links[sensor.link].model_from_link * sensor.link_from_sensor;
    model.links[link].model_from_link.inverse() * model_from_sensor * optical_from_sensor().inverse()
}

fn is_near(a: f64, b: f64) -> bool {
    (a - b).abs() < TOLERANCE
}
