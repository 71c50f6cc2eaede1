//! A channel: a sensor, or what a robot says of itself, with its streams. What all kinds of them have in common.

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

/// What a channel needs to open.
#[derive(Clone)]
pub(super) struct Opening<'a> {
    pub(super) sink: &'a dyn Sink,
    pub(super) physics: &'a Physics,
    pub(super) earth: &'a Earth,
    pub(super) entity: &'a Entity,
    pub(super) id: EntityId,
    pub(super) rate: Rate,
    pub(super) seed: u64,
    /// Number of the sensor, by which its noise differs from others'.
    pub(super) sensor: u32,
    pub(super) gazebo_compat: bool,
    /// Whether sensors tell the truth, too.
    pub(super) truth: bool,
    /// How much of it there may be.
    pub(super) census: Census,
    pub(super) hashed: bool,
    /// What publishes what is opened.
    pub(super) owner: Owner,
    /// Topics of streams that are open.
    pub(super) names: &'a Names,
    /// The frames of the model's sensors that are no links of it; none where Gazebo's habits are asked for.
    pub(super) frames: &'a [SensorFrame],
}

impl Opening<'_> {
    /// The same for what another part of the model publishes.
    pub(super) fn of(&self, owner: Owner) -> Self {
        Self { owner, ..self.clone() }
    }

    /// A stream of small messages, which are sent whether or not anybody follows: late consumers get the last one. Its
    /// topic and its frame are in the namespace of the entity.
    pub(super) fn open(&self, spec: &StreamSpec) -> Result<Outlet, RigError> {
        self.open_named(self.in_namespace(spec), None)
    }

    /// The same, its frame nobody's own.
    pub(super) fn open_in_world(&self, spec: &StreamSpec) -> Result<Outlet, RigError> {
        let topic = self.entity.topic(&spec.topic);
        self.open_named(StreamSpec { topic, ..spec.clone() }, None)
    }

    /// The `CameraInfo` of a picture, which may lie beside that.
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

    /// A stream that is rendered while somebody follows it. It keeps no frame for late consumers: the last one may be
    /// of long ago.
    pub(super) fn open_rendered(&self, spec: StreamSpec) -> Result<Outlet, RigError> {
        self.open(&StreamSpec { history: 0, ..spec })
    }

    /// The frame that a sensor's messages name: the plugin's, or its link; unless Gazebo's habits are asked for, an optical one
    /// beside it for pictures, and the sensor's own if it has a pose in its link.
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

/// What a channel needs to publish a frame.
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
    /// Takes a frame of a sensor; false, with a warning, if there is none to be had: of a body that physics has lost.
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
            .inspect_err(|error| tracing::warn!(%error, capture.frame, "a frame of a sensor is left out"))
            .is_ok()
    }
}

/// A sensor, or what somebody says of himself, with its streams.
pub(super) trait Channel {
    /// Its streams.
    fn outlets(&self) -> Vec<&Outlet>;

    /// Sends its frame of this number.
    fn publish(&mut self, context: &mut RigContext<'_>, frame: u64);

    /// Whether its next frame shows the scene to somebody.
    fn is_rendered(&self) -> bool {
        false
    }

    /// How long before its stamp a frame of it begins, at most, in ns.
    fn window_ns(&self) -> u64 {
        0
    }

    /// Forgets what its frames so far have left to the next.
    fn restart(&mut self) {}

    /// Takes other settings from its next frame on, if it has any.
    ///
    /// # Errors
    /// When one of them is out of range.
    fn configure(&mut self, _settings: &Settings) -> Result<(), Box<dyn Error>> {
        Ok(())
    }

    /// Sends the data packets of its device to somebody as well.
    ///
    /// # Errors
    /// When it has none, or they cannot go there.
    fn send_packets(&mut self, _target: &PacketTarget) -> io::Result<()> {
        Err(io::Error::other(
            "this sensor has none; lidars with presets of Velodyne and Ouster have, and inertial units with <udp_profile_imu>",
        ))
    }
}

/// Whether somebody wants a frame of one of these streams.
pub(super) fn is_any_wanted<'a>(outlets: impl IntoIterator<Item = &'a Outlet>) -> bool {
    outlets.into_iter().any(Outlet::is_wanted)
}
