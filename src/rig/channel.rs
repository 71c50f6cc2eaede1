//! [`Channel`]: a sensor, or the state of a robot, with its streams. This file has the parts common to all kinds.

use super::RigError;
use super::annotations::Census;
use super::names::Names;
use super::outlet::Outlet;
use super::owner::Owner;
use super::packets::PacketTarget;
use super::rate::Rate;
use super::settings::Settings;
use super::sink::Sink;
use crate::description::model::{Earth, Sensor as DescribedSensor};
use crate::description::sensor_frames::SensorFrame;
use crate::entities::{Entities, Entity, EntityId};
use crate::world::physics::Physics;
use crate::world::scene::WorldScene;
use belvedere_bridge::{Kind, StreamSpec};
use belvedere_sensors::trace::WorkspaceBuf;
use belvedere_sensors::{Capture, Sensor};
use std::error::Error;
use std::io;
use std::time::{Duration, Instant};

/// Everything that a channel needs to open its streams.
#[derive(Clone)]
pub(super) struct Opening<'a> {
    pub(super) sink: &'a dyn Sink,
    pub(super) physics: &'a Physics,
    pub(super) earth: &'a Earth,
    pub(super) entity: &'a Entity,
    pub(super) id: EntityId,
    pub(super) rate: Rate,
    pub(super) seed: u64,
    /// Number of the sensor, which distinguishes its noise from others'.
    pub(super) sensor: u32,
    pub(super) gazebo_compat: bool,
    /// Whether sensors publish ground truth as well.
    pub(super) truth: bool,
    /// The numbers of objects and tags for annotations.
    pub(super) census: Census,
    pub(super) hashed: bool,
    /// The owner of the streams that are opened.
    pub(super) owner: Owner,
    /// Topics of open streams.
    pub(super) names: &'a Names,
    /// Frames of the model's sensors that are not links of the model; empty with `gazebo_compat`.
    pub(super) frames: &'a [SensorFrame],
}

impl Opening<'_> {
    /// Returns the same for streams of another part of the model.
    pub(super) fn of(&self, owner: Owner) -> Self {
        Self { owner, ..self.clone() }
    }

    /// Opens a stream of small messages, which are sent even without subscribers, so that later subscribers get the
    /// last one. Its topic and its frame are in the namespace of the entity.
    pub(super) fn open(&self, spec: &StreamSpec) -> Result<Outlet, RigError> {
        self.open_named(self.in_namespace(spec), None)
    }

    /// Like `open`, but the frame is not in the namespace.
    pub(super) fn open_in_world(&self, spec: &StreamSpec) -> Result<Outlet, RigError> {
        let topic = self.entity.topic(&spec.topic);
        self.open_named(StreamSpec { topic, ..spec.clone() }, None)
    }

    /// Opens the `CameraInfo` stream of an image. If its topic is taken, it may get one next to the image's.
    pub(super) fn open_info(&self, topic: &str, picture: &str, frame: &str) -> Result<Outlet, RigError> {
        let spec = StreamSpec::structs(topic, Kind::CameraInfo, 1).frame_id(frame).rate_hz(self.rate.hz());
        self.open_named(self.in_namespace(&spec), Some(&self.entity.topic(picture)))
    }

    fn in_namespace(&self, spec: &StreamSpec) -> StreamSpec {
        let (topic, frame_id) = (self.entity.topic(&spec.topic), self.entity.frame(&spec.frame_id));
        StreamSpec { topic, frame_id, ..spec.clone() }
    }

    fn open_named(&self, spec: StreamSpec, picture: Option<&str>) -> Result<Outlet, RigError> {
        let spec = self.names.settle(spec, picture, &self.owner, self.gazebo_compat)?;
        Ok(Outlet::open(self.sink, &spec, self.owner.clone(), self.hashed)?)
    }

    /// Opens a stream that is rendered while it has subscribers. It keeps no frame for later subscribers, because the
    /// last one may be old.
    pub(super) fn open_rendered(&self, spec: StreamSpec) -> Result<Outlet, RigError> {
        self.open(&StreamSpec { history: 0, ..spec })
    }

    /// Returns the frame of a sensor's messages: the plugin's, or else the sensor's link. Unless `gazebo_compat` is
    /// set, images have an optical frame at the same place, and a sensor with a pose in its link has its own frame.
    pub(super) fn frame_id(&self, sensor: &DescribedSensor, frame_name: &str) -> String {
        let is_of_it =
            |frame: &&SensorFrame| std::ptr::eq(&raw const self.entity.sensors()[frame.sensor], sensor);
        if let Some(frame) = self.frames.iter().find(is_of_it) {
            return frame.name.clone();
        }
        let link = &self.entity.model.links[sensor.link].name;
        if frame_name.is_empty() { link.clone() } else { frame_name.to_owned() }
    }
}

/// Everything that a channel needs to publish a frame.
pub(super) struct RigContext<'a> {
    pub(super) stamp_ns: u64,
    pub(super) physics: &'a Physics,
    pub(super) entities: &'a Entities,
    pub(super) scene: &'a WorldScene,
    pub(super) workspace: &'a mut WorkspaceBuf,
    /// Time spent on rendering.
    pub(super) rendering: Duration,
}

impl RigContext<'_> {
    /// Renders a frame of a sensor. Returns false, with a warning, if that is not possible, for example because physics
    /// has lost the sensor's body.
    pub(super) fn take<T: Sensor>(
        &mut self,
        sensor: &T,
        capture: &Capture<'_>,
        output: T::Output<'_>,
    ) -> bool {
        let scene = self.scene.scene();
        let started = Instant::now();
        let taken = sensor.sense_in(self.workspace, &scene, capture, output);
        self.rendering += started.elapsed();
        taken
            .inspect_err(|error| tracing::warn!(%error, capture.frame, "a frame of a sensor was dropped"))
            .is_ok()
    }
}

/// A sensor, or the state of a robot, with its streams.
pub(super) trait Channel {
    /// Returns its streams.
    fn outlets(&self) -> Vec<&Outlet>;

    /// Publishes its frame with this number.
    fn publish(&mut self, context: &mut RigContext<'_>, frame: u64);

    /// Returns true if its next frame has to be rendered.
    fn is_rendered(&self) -> bool {
        false
    }

    /// Returns the longest time in ns by which a frame begins before its timestamp.
    fn window_ns(&self) -> u64 {
        0
    }

    /// Resets all state that is carried over from frame to frame.
    fn restart(&mut self) {}

    /// Applies other settings from its next frame on, if it has any.
    ///
    /// # Errors
    /// If one of them is out of range.
    fn configure(&mut self, _settings: &Settings) -> Result<(), Box<dyn Error>> {
        Ok(())
    }

    /// Checks that it can send the data packets of its device to a target, without opening it.
    ///
    /// # Errors
    /// If it has no packets, or none for such a target.
    fn check_packets(&self, _target: &PacketTarget) -> io::Result<()> {
        Err(io::Error::other(
            "this sensor has no packets; only lidars with presets of Velodyne or Ouster have, and inertial units with <udp_profile_imu>",
        ))
    }

    /// Also sends the data packets of its device to a target that was checked.
    ///
    /// # Errors
    /// If the target cannot be opened.
    fn send_packets(&mut self, target: &PacketTarget) -> io::Result<()> {
        self.check_packets(target)
    }
}

/// Returns true if one of these streams needs a frame.
pub(super) fn is_any_wanted<'a>(outlets: impl IntoIterator<Item = &'a Outlet>) -> bool {
    outlets.into_iter().any(Outlet::is_wanted)
}
