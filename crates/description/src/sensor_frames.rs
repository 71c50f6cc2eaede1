//! Frames of sensor data for which the model has no link.
//!
//! Images are in optical frames: x right, y down, z forward (REP-103). Gazebo stamps images with the frame that the plugin
//! names, often not an optical one; programs that project with it through tf are then wrong by 120° about the diagonal.
//!
//! Other data are in the axes of their sensor. If the file names no frame and the sensor has a `<pose>` in its link, the
//! link is not that frame, so the sensor gets its own, with gz-sim's name for it: `MODEL/LINK/SENSOR`, or
//! `MODEL/JOINT/SENSOR`.

use super::model::{LinkIndex, Model, Sensor, SensorKind};
use belvedere_sensors::Pose;
use glam::{DMat3, DQuat, DVec3};

/// Difference up to which two poses are equal, in metres and in the quaternion's components.
const TOLERANCE: f64 = 1e-6;

/// The greatest length of a frame's name in messages, in bytes.
const LONGEST: usize = 63;

/// A frame of a sensor's data, in addition to the links of the model.
#[derive(Debug, Clone, PartialEq)]
pub struct SensorFrame {
    /// Index of the sensor in [`Model::sensors`].
    pub sensor: usize,
    /// For a camera, the frame that its plugin names, or its link, with the suffix `_optical`; for another sensor
    /// `MODEL/LINK/SENSOR`.
    pub name: String,
    /// The link to which it is fixed: the one that the plugin names, or the sensor's.
    pub parent: LinkIndex,
    /// Pose in that link: the sensor's.
    pub parent_from_frame: Pose,
    /// True if the model already has a link with that name and pose.
    pub is_link: bool,
}

/// Returns the frames that a model's sensors need, in the sensors' order, if their names are put into a namespace.
///
/// A camera needs none if its plugin names an optical frame in its direction, or a frame that is not a link of the model or
/// moves relative to the camera. Another sensor needs none if a frame is named for its data, or if it is at its link's origin.
pub fn sensor_frames(model: &Model, namespace: &str) -> Vec<SensorFrame> {
    let room = LONGEST.saturating_sub(if namespace.is_empty() { 0 } else { namespace.len() + 1 });
    let mut frames: Vec<SensorFrame> = Vec::new();
    for (index, sensor) in model.sensors.iter().enumerate() {
        let frame = match named_frame(&sensor.kind) {
            Some((name, true)) => optical_frame(model, index, name, &frames),
            Some(("", false)) => own_frame(model, index, room, &frames),
            _ => None,
        };
        frames.extend(frame);
    }
    frames
}

/// Returns the frame that a sensor's plugin names, empty if it names none, and whether the sensor takes images. None if the
/// sensor has no plugin.
fn named_frame(kind: &SensorKind) -> Option<(&str, bool)> {
    let name = match kind {
        SensorKind::Camera(camera) => return Some((&camera.plugin.as_ref()?.frame_name, true)),
        SensorKind::Depth(depth) => return Some((&depth.plugin.as_ref()?.camera.frame_name, true)),
        SensorKind::Ray(lidar) => &lidar.plugin.as_ref()?.frame_name,
        SensorKind::Range(range) => &range.plugin.as_ref()?.frame_name,
        SensorKind::Imu(imu) => &imu.plugin.as_ref()?.frame_name,
        SensorKind::NavSat(navsat) => &navsat.plugin.as_ref()?.frame_name,
        SensorKind::Magnetometer(magnetometer) => &magnetometer.plugin.as_ref()?.frame_name,
        SensorKind::Altimeter(altimeter) => &altimeter.plugin.as_ref()?.frame_name,
        SensorKind::AirPressure(barometer) => &barometer.plugin.as_ref()?.frame_name,
        SensorKind::ForceTorque(it) => &it.plugin.as_ref()?.frame_name,
        SensorKind::Logical(it) => &it.plugin.as_ref()?.frame_name,
        // Contacts are in the world, or in the frame that the file names.
        SensorKind::Contact(_) => return None,
    };
    Some((name, false))
}

/// Returns the frame of a camera's images.
fn optical_frame(model: &Model, index: usize, name: &str, frames: &[SensorFrame]) -> Option<SensorFrame> {
    let sensor = &model.sensors[index];
    let parent = named_link(model, sensor, name)?;
    let parent_from_frame = link_from_optical(model, parent, sensor);
    // If another link is that frame, the sensor is moved there (`rig/mount.rs`).
    let is_there = parent != sensor.link || parent_from_frame.translation().length() < TOLERANCE;
    if is_there && is_near(parent_from_frame.rotation().dot(DQuat::IDENTITY).abs(), 1.0) {
        return None;
    }
    let place = (parent, parent_from_frame);
    let plain = format!("{}_optical", model.links[parent].name);
    // Two cameras with the same frame but different poses get two frames.
    let own = format!("{}_{}_optical", model.links[parent].name, sensor.name);
    let name = if fits(model, frames, &plain, place) { plain } else { own };
    Some(frame(model, index, name, place))
}

/// Returns the frame of another sensor, whose data name none.
fn own_frame(model: &Model, index: usize, room: usize, frames: &[SensorFrame]) -> Option<SensorFrame> {
    let sensor = &model.sensors[index];
    let place = (sensor.link, sensor.link_from_sensor);
    if is_same(&sensor.link_from_sensor, &Pose::IDENTITY) {
        return None;
    }
    let parts =
        [model.name.as_str(), model.place_of(sensor), &sensor.name].map(|part| part.replace("::", "/"));
    // A message has no room for a long name: then the model is omitted, and then the link. Two sensors with the same name on a
    // link get numbers.
    let names = (0..3).map(|first| parts[first..].join("/"));
    let numbered = names.flat_map(|name| {
        std::iter::once(name.clone())
            .chain((2..=frames.len() + 2).map(move |number| format!("{name}_{number}")))
    });
    let name = numbered.filter(|name| name.len() <= room).find(|name| fits(model, frames, name, place))?;
    Some(frame(model, index, name, place))
}

fn frame(
    model: &Model,
    sensor: usize,
    name: String,
    (parent, parent_from_frame): (LinkIndex, Pose),
) -> SensorFrame {
    let is_link = model.link_named(&name).is_some();
    SensorFrame { sensor, name, parent, parent_from_frame, is_link }
}

/// Returns true if a link of this name, if there is one, has this pose in another link, and so has each earlier frame.
fn fits(
    model: &Model,
    frames: &[SensorFrame],
    name: &str,
    (parent, parent_from_frame): (LinkIndex, Pose),
) -> bool {
    let parent_from_model = model.links[parent].model_from_link.inverse();
    let by_link = model.link_named(name).is_none_or(|link| {
        is_same(&(parent_from_model * model.links[link].model_from_link), &parent_from_frame)
    });
    let mut alike = frames.iter().filter(|frame| frame.name == name);
    by_link
        && alike.all(|frame| frame.parent == parent && is_same(&frame.parent_from_frame, &parent_from_frame))
}

/// Returns the frames for which there is neither a link of the model nor an earlier frame.
pub fn new_frames(frames: &[SensorFrame]) -> impl Iterator<Item = &SensorFrame> {
    let is_first = |index: usize| frames[..index].iter().all(|before| before.name != frames[index].name);
    frames
        .iter()
        .enumerate()
        .filter(move |(index, frame)| !frame.is_link && is_first(*index))
        .map(|(_, frame)| frame)
}

/// Returns the sensor's pose in an optical frame: forward, left and up are z, −x and −y there.
pub fn optical_from_sensor() -> Pose {
    Pose::new(DVec3::ZERO, DQuat::from_mat3(&DMat3::from_cols(DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y)))
}

/// Returns the link that a camera's plugin names for its images, if it is fixed to the camera.
fn named_link(model: &Model, sensor: &Sensor, name: &str) -> Option<LinkIndex> {
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

fn is_same(one: &Pose, other: &Pose) -> bool {
    one.translation().distance(other.translation()) < TOLERANCE
        && is_near(one.rotation().dot(other.rotation()).abs(), 1.0)
}
