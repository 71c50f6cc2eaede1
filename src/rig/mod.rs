//! Runs the robots' sensors on their schedules. Each sensor with its streams is a *channel*, and each channel has its
//! own exact rate.
//!
//! A frame is rendered directly into the memory from which it is read: the [sink](sink::Sink) lends the memory, the
//! sensor fills it, and the sink sends it. Streams without subscribers are not rendered, unless a camera's exposure
//! depends on it.

mod air_pressure;
mod altimeter;
mod annotations;
pub mod base;
mod behaviour;
mod camera;
mod channel;
mod contact;
pub mod cost;
mod depth;
mod error;
pub(crate) mod eye;
mod force_torque;
mod imu;
mod instrument;
mod joint_states;
mod lidar;
mod logical_camera;
mod magnetometer;
mod moments;
mod motion;
mod mount;
mod mounting;
mod names;
mod navsat;
mod numbers;
mod on_demand;
mod ouster;
mod outlet;
mod owner;
pub mod packets;
pub mod pictures;
mod range;
pub mod rate;
pub mod report;
mod robot_pose;
mod scanner;
pub mod schedule;
pub mod sensor_report;
pub mod settings;
mod sight;
pub mod sink;
mod state;
mod true_pose;
mod truth;
mod tuning;

pub use error::RigError;
pub use outlet::{Outlet, Tally};
pub use owner::{Owner, Part};
pub use rate::Rate;
pub use schedule::Schedule;
pub use settings::Settings;
pub use sink::{FrameBuf, Sink};

use crate::description::Problem;
use crate::description::housing::ShapeIndex;
use crate::description::model::Earth;
use crate::entities::{Entities, EntityId};
use crate::world::physics::Physics;
use crate::world::scene::WorldScene;
use annotations::Census;
use belvedere_bridge::{Error as BridgeError, StreamSpec};
use belvedere_sensors::Execution;
use belvedere_sensors::trace::WorkspaceBuf;
use channel::{Channel, Opening, RigContext};
use cost::Cost;
use mounting::Mounting;
use names::Names;
use numbers::Numbers;
use state::ClockChannel;
use std::time::Duration;
use tuning::Tuning;

/// Rate of the clock in Hz. A consumer's timers are exact to 10 ms of simulated time.
const CLOCK_HZ: f64 = 100.0;

/// Room for sensors that are spawned later, in addition to those at the start.
const MORE_SENSORS: usize = 64;

/// Options of a rig.
#[derive(Debug, Clone, Copy)]
pub struct RigOptions {
    /// Seed of all noise.
    pub seed: u64,
    /// Reproduce Gazebo's deviations from correct behaviour.
    pub gazebo_compat: bool,
    /// Also publish ground truth for every pixel and beam, in separate streams.
    pub truth: bool,
    /// Hash every byte that is published.
    pub hashed: bool,
    /// SIMD level and threads of the sensors.
    pub execution: Execution,
}

/// The state that is sensed.
#[derive(Clone, Copy)]
pub struct Stage<'a> {
    /// All models.
    pub entities: &'a Entities,
    /// Their motion.
    pub physics: &'a Physics,
    /// The world's position on the earth.
    pub earth: &'a Earth,
}

/// A channel with its schedule.
struct Scheduled {
    /// The model that it belongs to; `None` for the clock.
    entity: Option<EntityId>,
    /// The number that distinguishes its noise; 0 if it has none.
    number: u32,
    /// The rate in the description.
    rate: Rate,
    schedule: Schedule,
    channel: Box<dyn Channel>,
    /// The settings that can be changed while it runs.
    tuning: Option<Tuning>,
    /// The cost of rendering a frame.
    cost: Cost,
    /// Shapes of its own model that its sensor looks through.
    housing: Vec<ShapeIndex>,
}

/// All channels of a simulation.
pub struct Rig {
    options: RigOptions,
    channels: Vec<Scheduled>,
    /// Notes on decisions made for the user that have not been taken yet.
    notes: Vec<Problem>,
    /// The stream of sensor settings; `most_sensors` is the number that it has room for.
    settings: Outlet,
    most_sensors: usize,
    workspace: WorkspaceBuf,
    /// Changes when streams are opened or closed.
    edition: u64,
    /// The tally of closed streams.
    gone: Tally,
}

impl Rig {
    /// Opens the streams of the simulation itself (the clock, the sensor settings), then those of all models.
    ///
    /// # Errors
    /// If the sink cannot open a stream, or a sensor's description cannot be used.
    pub fn open(sink: &dyn Sink, stage: Stage<'_>, options: RigOptions) -> Result<Self, RigError> {
        let mut workspace = WorkspaceBuf::default();
        workspace.execution = options.execution;
        let sensors = stage.entities.iter().map(|(_, entity)| entity.sensors().len());
        let most_sensors = sensors.sum::<usize>() + MORE_SENSORS;
        let settings = Outlet::open(
            sink,
            &StreamSpec::sensor_settings(most_sensors),
            Owner::simulation(),
            options.hashed,
        )?;
        let clock = Outlet::open(sink, &ClockChannel::spec(CLOCK_HZ), Owner::simulation(), options.hashed)?;
        let rate = fixed_rate(CLOCK_HZ, stage.physics);
        let clock = Scheduled {
            entity: None,
            number: 0,
            rate,
            schedule: Schedule::new(rate),
            channel: Box::new(ClockChannel::new(clock)),
            tuning: None,
            cost: Cost::default(),
            housing: Vec::new(),
        };
        let mut rig = Self {
            options,
            channels: vec![clock],
            notes: Vec::new(),
            settings,
            most_sensors,
            workspace,
            edition: 0,
            gone: Tally::default(),
        };
        let mut mounting = rig.mounting(stage);
        for (id, _) in stage.entities.iter() {
            rig.open_channels(sink, stage, id, &mut mounting)?;
        }
        rig.notes.extend(mounting.names.into_notes());
        rig.send_settings(stage.physics.time_ns());
        Ok(rig)
    }

    /// Opens all streams of a new model, or none if one fails.
    ///
    /// # Errors
    /// The errors of [`Rig::open`].
    pub fn mount(&mut self, sink: &dyn Sink, stage: Stage<'_>, id: EntityId) -> Result<(), RigError> {
        let before = self.channels.len();
        let mut mounting = self.mounting(stage);
        let mounted = self.open_channels(sink, stage, id, &mut mounting);
        if mounted.is_err() {
            self.channels.truncate(before);
            return mounted;
        }
        self.notes.extend(mounting.names.into_notes());
        self.edition += 1;
        if self.channels[before..].iter().any(|channel| channel.tuning.is_some()) {
            self.send_settings(stage.physics.time_ns());
        }
        mounted
    }

    /// Closes all streams of a model.
    pub fn unmount(&mut self, id: EntityId, now_ns: u64) {
        let closed: Vec<_> = self.channels.extract_if(.., |scheduled| scheduled.entity == Some(id)).collect();
        if closed.is_empty() {
            return;
        }
        let outlets = closed.iter().flat_map(|scheduled| scheduled.channel.outlets());
        self.gone = outlets.fold(self.gone, |sum, outlet| sum + outlet.tally());
        drop(closed);
        self.edition += 1;
        self.send_settings(now_ns);
    }

    /// Collects the knowledge about open streams that is needed to open further ones.
    fn mounting(&self, stage: Stage<'_>) -> Mounting {
        Mounting {
            names: Names::of(self.outlets()),
            numbers: Numbers::of(self.channels.iter().map(|channel| channel.number)),
            census: Census::of(stage.entities),
        }
    }

    fn open_channels(
        &mut self,
        sink: &dyn Sink,
        stage: Stage<'_>,
        id: EntityId,
        mounting: &mut Mounting,
    ) -> Result<(), RigError> {
        self.channels.extend(mounting.open(sink, stage, id, &self.options)?);
        let sensors = self.channels.iter().filter(|channel| channel.tuning.is_some()).count();
        if sensors > self.most_sensors {
            return Err(RigError::TooManySensors { most: self.most_sensors });
        }
        Ok(())
    }

    /// Returns notes on decisions made for the user since the last call: topics that had to be changed, sensors that
    /// publish nothing.
    pub fn take_notes(&mut self) -> Vec<Problem> {
        std::mem::take(&mut self.notes)
    }

    /// Returns the timestamp in ns of the next frame.
    pub fn next_stamp_ns(&self) -> u64 {
        self.channels.iter().map(|channel| channel.schedule.next_ns()).min().unwrap_or(u64::MAX)
    }

    /// Returns the longest time in ns by which a frame begins before its timestamp, which physics' history must cover.
    pub fn window_ns(&self) -> u64 {
        self.channels.iter().map(|scheduled| scheduled.channel.window_ns()).max().unwrap_or(0)
    }

    /// Estimates the time to render a frame of each sensor, from their previous costs.
    pub fn cost(&self) -> Duration {
        self.channels.iter().map(|channel| channel.cost.expected()).sum()
    }

    /// Publishes every frame that is due at `stamp_ns`, which physics must have reached.
    pub fn publish(&mut self, stamp_ns: u64, stage: Stage<'_>, scene: &mut WorldScene) {
        for scheduled in &mut self.channels {
            if scheduled.schedule.next_ns() != stamp_ns {
                continue;
            }
            scheduled.take(stamp_ns, stage, scene, &mut self.workspace);
            if scheduled.entity.is_none() {
                // Subscribers that connected since the last change get the settings now.
                self.settings.update();
            }
        }
    }

    /// Restarts every channel's schedule at time 0, with the noise of its first frame and the settings in its
    /// description.
    ///
    /// # Errors
    /// None in practice, because these settings were valid before.
    pub fn restart(&mut self) -> Result<(), String> {
        for scheduled in &mut self.channels {
            if let Some(Tuning { described, .. }) = scheduled.tuning {
                scheduled.configure(described, 0)?;
            }
            scheduled.channel.restart();
            scheduled.schedule = Schedule::new(scheduled.rate);
        }
        self.send_settings(0);
        Ok(())
    }

    /// Sends the last message of every latched stream to new subscribers, for use while nothing is published.
    pub fn update(&self) {
        self.outlets().into_iter().for_each(Outlet::update);
    }

    /// Returns the first error about a consumer that was waited for in vain, if there was one.
    pub fn held_up(&self) -> Option<&BridgeError> {
        self.outlets().into_iter().find_map(Outlet::held_up)
    }

    /// Returns a number that changes when streams are opened or closed. While it is the same, so are [`Rig::outlets`]
    /// and their order.
    pub fn edition(&self) -> u64 {
        self.edition
    }

    /// Returns the tally of all streams together, including closed ones.
    pub fn tally(&self) -> Tally {
        self.outlets().into_iter().fold(self.gone, |sum, outlet| sum + outlet.tally())
    }

    /// Returns every stream, in the order in which they were opened.
    pub fn outlets(&self) -> Vec<&Outlet> {
        let of_channels = self.channels.iter().flat_map(|scheduled| scheduled.channel.outlets());
        of_channels.chain([&self.settings]).collect()
    }
}

impl Scheduled {
    /// Publishes its next frame with this timestamp.
    fn take(
        &mut self,
        stamp_ns: u64,
        stage: Stage<'_>,
        scene: &mut WorldScene,
        workspace: &mut WorkspaceBuf,
    ) {
        self.publish(self.schedule.next(), stamp_ns, stage, scene, workspace);
        self.schedule.advance();
    }

    /// Publishes its frame with this number, regardless of its schedule.
    fn publish(
        &mut self,
        frame: u64,
        stamp_ns: u64,
        stage: Stage<'_>,
        scene: &mut WorldScene,
        workspace: &mut WorkspaceBuf,
    ) {
        if self.channel.is_rendered() {
            scene.move_to(stage.physics, stamp_ns);
        }
        let Stage { entities, physics, .. } = stage;
        let model = self.entity.map(EntityId::index);
        if let Some(model) = model {
            scene.hide(model, &self.housing, true);
        }
        let rendering = Duration::ZERO;
        let mut context = RigContext { stamp_ns, physics, entities, scene, workspace, rendering };
        self.channel.publish(&mut context, frame);
        self.cost.add(context.rendering);
        if let Some(model) = model {
            scene.hide(model, &self.housing, false);
        }
    }
}

/// Returns a fixed rate, or one frame per physics step if it is invalid.
fn fixed_rate(hz: f64, physics: &Physics) -> Rate {
    Rate::from_hz(hz).unwrap_or(Rate::from_period_ns(physics.step_ns()))
}
