//! Annotations of a camera's images: bounding boxes of all visible objects, and corners of tags, in two streams in
//! addition to the sensor's own. They are computed only while they have subscribers.

use super::mount::Mount;
use super::outlet::Outlet;
use super::{Opening, RigContext, RigError};
use crate::entities::Entities;
use crate::world::scene::PlacedFiducial;
use belvedere_bridge::payload::{BoundingBox, Message, TagDetection};
use belvedere_bridge::{Kind, StreamSpec, Text};
use belvedere_sensors::camera::Camera;
use belvedere_sensors::trace::{
    Landmark, SeenBox, Sight, Sighting, Truth, landmarks_workspace_len, see_landmarks, seen_boxes,
};
use belvedere_sensors::{Pose, Shutter};
use glam::{DMat3, DQuat, DVec3};
use std::time::Instant;

/// Room for boxes of objects that are spawned later, in addition to those at the start.
const SPAWNED_THINGS: usize = 256;
/// Room for tags of such objects.
const SPAWNED_TAGS: usize = 64;

/// Numbers of objects (visuals) and tags in a world at its start.
#[derive(Debug, Clone, Copy)]
pub(super) struct Census {
    things: usize,
    tags: usize,
}

impl Census {
    pub(super) fn of(entities: &Entities) -> Self {
        let links = || entities.iter().flat_map(|(_, entity)| &entity.model.links);
        let visuals = || links().flat_map(|link| &link.visuals);
        Self { things: visuals().count(), tags: visuals().map(|visual| visual.fiducials.len()).sum() }
    }
}

/// The streams of a camera's boxes and tags; not opened unless ground truth is requested.
pub(super) struct Annotations {
    boxes: Option<Stream<BoundingBox>>,
    tags: Option<Stream<TagDetection>>,
    width: usize,
    /// The instance image, used while its own stream has no subscribers.
    instance: Vec<u32>,
    seen: Vec<SeenBox>,
    landmarks: Vec<Landmark>,
    sightings: Vec<Sighting>,
}

impl Annotations {
    /// Opens `<topic>/truth/boxes` and `<topic>/truth/tags` for a camera with this width and height in pixels.
    pub(super) fn open(
        topic: &str,
        frame_id: &str,
        [width, height]: [u32; 2],
        opening: &Opening<'_>,
    ) -> Result<Self, RigError> {
        let Census { things, tags } = opening.census;
        let boxes = || Stream::open(topic, "boxes", things + SPAWNED_THINGS, frame_id, opening);
        let tags = || Stream::open(topic, "tags", tags + SPAWNED_TAGS, frame_id, opening);
        Ok(Self {
            boxes: opening.truth.then(boxes).transpose()?,
            tags: opening.truth.then(tags).transpose()?,
            width: width as usize,
            instance: vec![0; if opening.truth { width as usize * height as usize } else { 0 }],
            seen: Vec::new(),
            landmarks: Vec::new(),
            sightings: Vec::new(),
        })
    }

    pub(super) fn outlets(&self) -> impl Iterator<Item = &Outlet> {
        let boxes = self.boxes.iter().map(|stream| &stream.outlet);
        boxes.chain(self.tags.iter().map(|stream| &stream.outlet))
    }

    /// Returns true if one of the streams has subscribers, so that the moments of the frame are needed.
    pub(super) fn is_wanted(&self) -> bool {
        self.outlets().any(Outlet::is_wanted)
    }

    /// Requests the instance image, from which boxes are made, unless it is requested already.
    pub(super) fn ask<'a>(&'a mut self, truth: &mut Option<Truth<'a>>) {
        if self.boxes.as_ref().is_some_and(|stream| stream.outlet.is_wanted()) {
            let truth = truth.get_or_insert_with(Truth::new);
            truth.instance.get_or_insert(&mut self.instance);
        }
    }

    /// Sends the annotations of a frame that is taken `at` its moments, if they have subscribers. `instance` is its
    /// instance image if its own stream has it, else `None`.
    pub(super) fn send(
        &mut self,
        context: &mut RigContext<'_>,
        camera: &Camera<'_>,
        at: &Shutter<'_>,
        world_from_sensor: &Pose,
        (taken, instance): (bool, Option<&[u32]>),
    ) {
        let started = Instant::now();
        if taken && let Some(stream) = self.boxes.as_mut().filter(|stream| stream.outlet.is_wanted()) {
            let scene = context.scene.scene();
            self.seen.resize(scene.instances().len(), SeenBox::EMPTY);
            seen_boxes(instance.unwrap_or(&self.instance), self.width, &mut self.seen);
            let optical_from_world = optical_from_world(world_from_sensor);
            let boxes = self.seen.iter().enumerate().filter(|(_, seen)| !seen.is_empty());
            stream.messages.clear();
            stream.messages.extend(boxes.map(|(index, seen)| {
                let [low, high] = scene.bounds(index).unwrap_or_default();
                let middle = Pose::from_translation((low + high) * 0.5);
                let pose = optical_from_world * context.scene.poses()[index] * middle;
                BoundingBox {
                    instance: index as u32,
                    label: scene.instances()[index].class(),
                    pixels: seen.pixels,
                    min: seen.min,
                    max: seen.max,
                    reserved: 0,
                    position: pose.translation().to_array(),
                    orientation: pose.rotation().to_array(),
                    size: (high - low).to_array(),
                }
            }));
            stream.send(context.stamp_ns, world_from_sensor, started);
        }
        self.send_tags(context, camera, at, world_from_sensor);
        context.rendering += started.elapsed();
    }

    fn send_tags(
        &mut self,
        context: &mut RigContext<'_>,
        camera: &Camera<'_>,
        at: &Shutter<'_>,
        world_from_sensor: &Pose,
    ) {
        let started = Instant::now();
        let Some(stream) = self.tags.as_mut().filter(|stream| stream.outlet.is_wanted()) else { return };
        let tags = context.scene.fiducials();
        self.landmarks.clear();
        self.landmarks.extend(tags.iter().flat_map(corners));
        self.sightings.clear();
        self.sightings.resize(self.landmarks.len(), Sighting::NONE);
        let (scene, config) = (context.scene.scene(), camera.config());
        let workspace = &mut context.workspace.lend(landmarks_workspace_len(&scene, &config.optics));
        let sight = Sight { range: [config.near_m, config.far_m], visibility: config.visibility };
        let (landmarks, sightings) = (&self.landmarks, &mut self.sightings);
        if let Err(error) = see_landmarks(&scene, at, &config.optics, sight, workspace, landmarks, sightings)
        {
            tracing::warn!(%error, stamp_ns = context.stamp_ns, "the tags of a frame were dropped");
            return;
        }
        let optical_from_world = optical_from_world(world_from_sensor);
        let seen = tags.iter().zip(self.sightings.as_chunks::<4>().0);
        stream.messages.clear();
        stream.messages.extend(seen.filter(|(_, corners)| corners.iter().any(|corner| corner.visible)).map(
            |(tag, corners)| {
                let world_from_instance = context.scene.poses()[tag.instance as usize];
                let pose = optical_from_world * world_from_instance * tag.instance_from_fiducial;
                TagDetection {
                    family: Text::cut(&tag.family),
                    id: tag.id,
                    visible: corners.map(|corner| corner.visible.into()),
                    size: tag.size_m,
                    corners: corners.map(|corner| corner.pixel),
                    position: pose.translation().to_array(),
                    orientation: pose.rotation().to_array(),
                }
            },
        ));
        stream.send(context.stamp_ns, world_from_sensor, started);
    }
}

/// Returns top left, top right, bottom right and bottom left of a tag as one reads it, which is the order of OpenCV's
/// `ArUco`.
fn corners(tag: &PlacedFiducial) -> [Landmark; 4] {
    let (pose, half) = (&tag.instance_from_fiducial, tag.size_m / 2.0);
    [(-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)].map(|(right, up)| Landmark {
        instance: tag.instance,
        point: pose.transform_point(DVec3::new(right * half, up * half, 0.0)),
        normal: pose.transform_vector(DVec3::Z),
    })
}

/// Returns the transform to the optical frame (x right, y down, z forward) of a sensor that looks along its x with z
/// up.
fn optical_from_world(world_from_sensor: &Pose) -> Pose {
    let axes = DMat3::from_cols(DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y);
    Pose::new(DVec3::ZERO, DQuat::from_mat3(&axes)) * world_from_sensor.inverse()
}

/// A stream of structs that is computed while it has subscribers.
struct Stream<T> {
    outlet: Outlet,
    /// Messages of the next frame.
    messages: Vec<T>,
    /// Most messages that fit into a frame.
    most: usize,
    /// Whether a warning about dropped messages was logged.
    has_warned: bool,
}

impl<T: Message> Stream<T> {
    fn open(
        topic: &str,
        name: &str,
        most: usize,
        frame_id: &str,
        opening: &Opening<'_>,
    ) -> Result<Self, RigError> {
        let kind = if name == "boxes" { Kind::BoundingBoxes } else { Kind::TagDetections };
        let spec = StreamSpec::structs(format!("{topic}/truth/{name}"), kind, most);
        let spec = StreamSpec { buffer: 4, ..spec.frame_id(frame_id).rate_hz(opening.rate.hz()) };
        Ok(Self { outlet: opening.open_rendered(spec)?, messages: Vec::new(), most, has_warned: false })
    }

    /// Sends the messages. If there are too many, sends the first ones and logs one warning.
    fn send(&mut self, stamp_ns: u64, world_from_sensor: &Pose, started: Instant) {
        let count = self.messages.len();
        if count > self.most && !std::mem::replace(&mut self.has_warned, true) {
            let (topic, most) = (self.outlet.topic(), self.most);
            tracing::warn!(
                %topic, count, most,
                "more objects are visible than a frame has room for, because many were spawned: the rest is dropped"
            );
        }
        let messages = &self.messages[..count.min(self.most)];
        let mut frame = self.outlet.loan(size_of_val(messages));
        if let Some(frame) = &mut frame {
            frame.payload_mut().copy_from_slice(bytemuck::cast_slice(messages));
            let header = frame.header_mut();
            header.set_packed(1, messages.len() as u32);
            header.stamp_ns = stamp_ns;
            Mount::write(world_from_sensor, header);
        }
        let outcome = self.outlet.send(frame);
        self.outlet.record(outcome, started.elapsed());
    }
}
