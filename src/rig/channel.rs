//! A channel: a sensor, or what a robot says of itself, with its streams. What all kinds of them have in common.

use super::RigError;
use super::annotations::Census;
use super::base::BaseChannel;
use super::camera::CameraChannel;
use super::depth::DepthChannel;
use super::imu::ImuChannel;
use super::joint_states::JointStatesChannel;
use super::lidar::LidarChannel;
use super::outlet::Outlet;
use super::range::RangeChannel;
use super::rate::Rate;
use super::settings::Settings;
use super::sink::Sink;
use super::state::{ClockChannel, StateChannel};
use super::true_pose::TruePoseChannel;
use crate::description::model::{Plugin, Sensor as DescribedSensor, SensorKind};
use crate::description::optical::{OpticalFrame, optical_frames};
use crate::entities::{Entities, Entity, EntityId};
use crate::world::physics::Physics;
use crate::world::scene::WorldScene;
use belvedere_bridge::StreamSpec;
use belvedere_sensors::trace::WorkspaceBuf;
use belvedere_sensors::{Capture, Sensor};
use std::cell::RefCell;
use std::collections::HashSet;
use std::time::{Duration, Instant};

/// What a channel needs to open.
pub(super) struct Opening<'a> {
    pub(super) sink: &'a dyn Sink,
    pub(super) physics: &'a Physics,
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
    /// Topics of streams that are open.
    pub(super) taken: &'a RefCell<HashSet<String>>,
}

impl Opening<'_> {
    /// A stream of small messages, which are sent whether or not anybody follows: late consumers get the last one. Its
    /// topic and its frame are in the namespace of the entity.
    pub(super) fn open(&self, spec: &StreamSpec) -> Result<Outlet, RigError> {
        let frame_id = self.entity.frame(&spec.frame_id);
        self.open_in_world(&StreamSpec { frame_id, ..spec.clone() })
    }

    /// The same, its frame nobody's own.
    pub(super) fn open_in_world(&self, spec: &StreamSpec) -> Result<Outlet, RigError> {
        let spec = StreamSpec { topic: self.entity.topic(&spec.topic), ..spec.clone() };
        if !self.taken.borrow_mut().insert(format!("/{}", spec.name()?)) {
            return Err(RigError::TopicTaken { topic: spec.topic, model: self.entity.name.clone() });
        }
        Ok(Outlet::open(self.sink, &spec, self.hashed)?)
    }

    /// A stream that is rendered while somebody follows it. It keeps no frame for late consumers: the last one may be
    /// of long ago.
    pub(super) fn open_rendered(&self, spec: StreamSpec) -> Result<Outlet, RigError> {
        self.open(&StreamSpec { history: 0, ..spec })
    }

    /// The frame that a sensor's messages name: the plugin's, or its link; for pictures an optical one beside it, unless
    /// Gazebo's habits are asked for.
    pub(super) fn frame_id(&self, sensor: &DescribedSensor, frame_name: &str) -> String {
        let optical = optical_frames(&self.entity.model).into_iter();
        let is_of_it =
            |frame: &OpticalFrame| std::ptr::eq(&raw const self.entity.sensors()[frame.sensor], sensor);
        if let Some(frame) = optical.filter(|_| !self.gazebo_compat).find(is_of_it) {
            return frame.name;
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
        let workspace = &mut self.workspace.lend(sensor.workspace_len(&scene, capture));
        let started = Instant::now();
        let taken = sensor.sense(&scene, capture, workspace, output);
        self.rendering += started.elapsed();
        taken
            .inspect_err(|error| tracing::warn!(%error, capture.frame, "a frame of a sensor is left out"))
            .is_ok()
    }
}

/// The kinds of channels.
pub(super) enum Channel {
    Clock(Box<ClockChannel>),
    State(Box<StateChannel>),
    Base(Box<BaseChannel>),
    Imu(Box<ImuChannel>),
    TruePose(Box<TruePoseChannel>),
    JointStates(Box<JointStatesChannel>),
    Camera(Box<CameraChannel>),
    Depth(Box<DepthChannel>),
    Lidar(Box<LidarChannel>),
    Range(Box<RangeChannel>),
}

impl Channel {
    /// The channel of a sensor; none if it has no plugin that publishes it.
    pub(super) fn of_sensor(
        sensor: &DescribedSensor,
        opening: &Opening<'_>,
    ) -> Result<Option<Self>, RigError> {
        Ok(match (&sensor.kind, &sensor.plugin) {
            (SensorKind::Camera(camera), Some(Plugin::Camera(plugin))) => {
                Some(Self::Camera(CameraChannel::open(sensor, camera, plugin, opening)?.into()))
            }
            (SensorKind::Depth(camera), Some(Plugin::DepthCamera(plugin))) => {
                Some(Self::Depth(DepthChannel::open(sensor, camera, plugin, opening)?.into()))
            }
            (SensorKind::Ray(ray), Some(Plugin::Laser(plugin))) => {
                Some(Self::Lidar(LidarChannel::open(sensor, ray, plugin, opening)?.into()))
            }
            (SensorKind::Ray(ray), Some(Plugin::Range(plugin))) => {
                Some(Self::Range(RangeChannel::open(sensor, ray, plugin, opening)?.into()))
            }
            _ => {
                tracing::warn!(sensor = sensor.name, source = %sensor.source, "has no plugin that publishes it");
                None
            }
        })
    }

    /// Its streams.
    pub(super) fn outlets(&self) -> Vec<&Outlet> {
        match self {
            Self::Clock(clock) => clock.outlets().into(),
            Self::State(state) => state.outlets().collect(),
            Self::Base(base) => base.outlets().into(),
            Self::Imu(imu) => imu.outlets().into(),
            Self::TruePose(pose) => pose.outlets().into(),
            Self::JointStates(joints) => joints.outlets().into(),
            Self::Camera(camera) => camera.outlets().collect(),
            Self::Depth(depth) => depth.outlets().collect(),
            Self::Lidar(lidar) => lidar.outlets().collect(),
            Self::Range(range) => range.outlets().into(),
        }
    }

    /// Whether its next frame shows the scene to somebody.
    pub(super) fn is_rendered(&self) -> bool {
        match self {
            Self::Clock(_)
            | Self::State(_)
            | Self::Base(_)
            | Self::Imu(_)
            | Self::TruePose(_)
            | Self::JointStates(_) => false,
            Self::Camera(camera) if camera.eye().is_automatic() => true,
            Self::Depth(depth) if depth.eye().is_automatic() => true,
            Self::Camera(_) | Self::Depth(_) | Self::Lidar(_) | Self::Range(_) => {
                self.outlets().into_iter().any(Outlet::is_wanted)
            }
        }
    }

    /// How long before its stamp a frame of it begins, at most, in ns.
    pub(super) fn window_ns(&self) -> u64 {
        match self {
            Self::Camera(camera) => camera.eye().window_ns(),
            Self::Depth(depth) => depth.eye().window_ns(),
            _ => 0,
        }
    }

    /// Forgets what its frames so far have left to the next.
    pub(super) fn restart(&mut self) {
        match self {
            Self::Camera(camera) => camera.restart(),
            Self::Depth(depth) => depth.restart(),
            Self::Lidar(lidar) => lidar.restart(),
            Self::Imu(imu) => imu.restart(),
            _ => {}
        }
    }

    /// Sends its frame of this number.
    pub(super) fn publish(&mut self, context: &mut RigContext<'_>, frame: u64) {
        match self {
            Self::Clock(clock) => clock.publish(context),
            Self::State(state) => state.publish(context),
            Self::Base(base) => base.publish(context),
            Self::Imu(imu) => imu.publish(context, frame),
            Self::TruePose(pose) => pose.publish(context, frame),
            Self::JointStates(joints) => joints.publish(context),
            Self::Camera(camera) => camera.publish(context, frame),
            Self::Depth(depth) => depth.publish(context, frame),
            Self::Lidar(lidar) => lidar.publish(context, frame),
            Self::Range(range) => range.publish(context, frame),
        }
    }

    /// Takes other settings from its next frame on, if it has any.
    pub(super) fn configure(&mut self, settings: &Settings) -> Result<(), Box<dyn std::error::Error>> {
        match self {
            Self::Clock(_)
            | Self::State(_)
            | Self::Base(_)
            | Self::Imu(_)
            | Self::TruePose(_)
            | Self::JointStates(_) => Ok(()),
            Self::Camera(camera) => camera.configure(settings),
            Self::Depth(depth) => depth.configure(settings),
            Self::Lidar(lidar) => lidar.configure(settings),
            Self::Range(range) => range.configure(settings),
        }
    }
}
