//! The sensors of the robots on their schedule: each sensor with its streams is a *channel*, and each channel has
//! its own exact rate.
//!
//! A frame is rendered straight into the shared memory that subscribers read: the bridge lends it, the sensor
//! fills it, the bridge sends it. What nobody follows is not rendered, unless a camera's exposure depends on it.

pub mod attendance;
pub mod base;
mod camera;
mod channel;
pub mod cost;
mod depth;
mod error;
pub(crate) mod eye;
mod lidar;
mod moments;
mod mount;
mod outlet;
pub mod pictures;
pub mod post;
mod range;
pub mod rate;
pub mod schedule;
pub mod settings;
mod state;
mod truth;
mod tuning;

pub use error::RigError;
pub use outlet::{Outlet, Tally};
pub use rate::Rate;
pub use schedule::Schedule;
pub use settings::Settings;

use crate::description::housing::{CollisionIndex, housings};
use crate::description::model::{Model, Sensor, SensorKind};
use crate::robot::Robot;
use crate::world::physics::{ModelIndex, Physics};
use crate::world::scene::WorldScene;
use base::BaseChannel;
use belvedere_bridge::{Error as BridgeError, Lossless, Node, StreamSpec};
use belvedere_sensors::Execution;
use belvedere_sensors::trace::WorkspaceBuf;
use channel::{Channel, RigContext, Setting};
use cost::Cost;
use post::Post;
use state::{ClockChannel, StateChannel};
use std::sync::Arc;
use std::time::Duration;
use tuning::Tuning;

/// Rate of the clock in Hz: a consumer's timers get within 10 ms of simulated time.
const CLOCK_HZ: f64 = 100.0;
/// Rate of odometry, transforms, joint states and of the base's sensors: a Kobuki's own.
const STATE_HZ: f64 = 50.0;

/// How the rig is to run.
#[derive(Debug, Clone)]
pub struct RigOptions {
    /// Seed of all noise.
    pub seed: u64,
    /// Gazebo's measured habits instead of what is right.
    pub gazebo_compat: bool,
    /// Publish what is true of every pixel and beam, too, in streams of its own.
    pub truth: bool,
    /// Hash every byte that is published.
    pub hashed: bool,
    /// Whom every stream waits for, if for anybody.
    pub lossless: Option<Lossless>,
    /// By what frames go that are made ahead of their time, if they are.
    pub post: Option<Arc<Post>>,
    /// SIMD level and threads of the sensors.
    pub execution: Execution,
}

/// A channel and when it is due.
struct Scheduled {
    /// As described.
    rate: Rate,
    schedule: Schedule,
    channel: Channel,
    /// Of what can be changed while it runs.
    tuning: Option<Tuning>,
    /// Of rendering a frame.
    cost: Cost,
    /// What its sensor looks through: shapes of a model.
    housing: (ModelIndex, Vec<CollisionIndex>),
}

impl Scheduled {
    fn new(rate: Rate, channel: Channel) -> Self {
        let schedule = Schedule::new(rate);
        Self { rate, schedule, channel, tuning: None, cost: Cost::default(), housing: (0, Vec::new()) }
    }
}

/// All channels of a simulation.
pub struct Rig {
    channels: Vec<Scheduled>,
    /// The stream of the settings of sensors.
    settings: Outlet,
    workspace: WorkspaceBuf,
}

impl Rig {
    /// Opens every stream of the robots. `models` and `robots` belong together, in the order in which physics
    /// has them.
    ///
    /// # Errors
    /// When the bridge cannot open a stream, or a sensor's description cannot be used.
    pub fn open(
        node: &Node,
        models: &[Model],
        robots: &[Robot],
        physics: &Physics,
        options: &RigOptions,
    ) -> Result<Self, RigError> {
        let mut workspace = WorkspaceBuf::default();
        workspace.execution = options.execution;
        let sensors = models.iter().map(|model| model.sensors.len()).sum();
        let settings = StreamSpec::sensor_settings(sensors);
        let settings =
            Outlet::open(node, &settings, options.hashed, options.lossless.as_ref(), options.post.as_ref())?;
        let mut rig = Self { channels: Vec::new(), settings, workspace };
        let mut sensor_number = 0;
        for (robot, (model, running)) in models.iter().zip(robots).enumerate() {
            let setting = |rate, sensor| Setting {
                node,
                physics,
                model,
                model_index: running.model(),
                robot,
                rate,
                seed: options.seed,
                sensor,
                gazebo_compat: options.gazebo_compat,
                truth: options.truth,
                hashed: options.hashed,
                lossless: options.lossless.as_ref(),
                post: options.post.as_ref(),
            };
            let fixed = |hz| Rate::from_hz(hz).unwrap_or(Rate::from_period_ns(physics.step_ns()));
            if robot == 0 {
                let clock = ClockChannel::open(&setting(fixed(CLOCK_HZ), 0))?;
                rig.add(fixed(CLOCK_HZ), Channel::Clock(clock.into()));
            }
            let state = StateChannel::open(running, &setting(fixed(STATE_HZ), 0))?;
            rig.add(fixed(STATE_HZ), Channel::State(state.into()));
            if running.base().is_some() {
                let base = BaseChannel::open(&setting(fixed(STATE_HZ), 0))?;
                rig.add(fixed(STATE_HZ), Channel::Base(base.into()));
            }
            for sensor in &model.sensors {
                let rate = sensor_rate(sensor, physics);
                if let Some(channel) = Channel::of_sensor(sensor, &setting(rate, sensor_number))? {
                    let described = Settings::described(sensor, rate.hz());
                    let tuning = Tuning { sensor: sensor.name.clone(), described, now: described };
                    let looks_through = matches!(sensor.kind, SensorKind::Ray(_)) && !options.gazebo_compat;
                    let housing =
                        looks_through.then(|| housings(model, sensor.link, &sensor.link_from_sensor));
                    rig.channels.push(Scheduled {
                        tuning: Some(tuning),
                        housing: (running.model(), housing.unwrap_or_default()),
                        ..Scheduled::new(rate, channel)
                    });
                }
                sensor_number += 1;
            }
        }
        rig.tell_settings(physics.time_ns());
        Ok(rig)
    }

    fn add(&mut self, rate: Rate, channel: Channel) {
        self.channels.push(Scheduled::new(rate, channel));
    }

    /// Stamp in ns of the frame that is due next.
    pub fn next_stamp_ns(&self) -> u64 {
        self.channels.iter().map(|channel| channel.schedule.next_ns()).min().unwrap_or(u64::MAX)
    }

    /// How long before its stamp a frame begins, at most, in ns: for so long physics has to remember where things were.
    pub fn window_ns(&self) -> u64 {
        self.channels.iter().map(|scheduled| scheduled.channel.window_ns()).max().unwrap_or(0)
    }

    /// How long it may take to render a frame of each sensor, by what the last ones took.
    pub fn cost(&self) -> Duration {
        self.channels.iter().map(|channel| channel.cost.expected()).sum()
    }

    /// Publishes every frame that is due at `stamp_ns`, for which physics must have arrived there.
    pub fn publish(&mut self, stamp_ns: u64, physics: &Physics, robots: &[Robot], scene: &mut WorldScene) {
        for scheduled in &mut self.channels {
            if scheduled.schedule.next_ns() != stamp_ns {
                continue;
            }
            if scheduled.channel.is_rendered() {
                scene.move_to(physics, stamp_ns);
            }
            let (model, housing) = &scheduled.housing;
            scene.hide(*model, housing, true);
            let workspace = &mut self.workspace;
            let rendering = Duration::ZERO;
            let mut context = RigContext { stamp_ns, physics, robots, scene, workspace, rendering };
            let frame = scheduled.schedule.next();
            scheduled.channel.publish(&mut context, frame);
            scheduled.cost.add(context.rendering);
            scene.hide(*model, housing, false);
            if let Channel::Clock(_) = scheduled.channel {
                // Whoever has come since the last change gets the settings now.
                self.settings.update();
            }
            scheduled.schedule.advance();
        }
    }

    /// Begins every channel's schedule again at time 0, with the noise of its first frame and the settings of its
    /// description.
    ///
    /// # Errors
    /// Never in practice: these settings held before.
    pub fn restart(&mut self) -> Result<(), String> {
        for scheduled in &mut self.channels {
            if let Some(Tuning { described, .. }) = scheduled.tuning {
                scheduled.configure(described, 0)?;
            }
            scheduled.channel.restart();
            scheduled.schedule = Schedule::new(scheduled.rate);
        }
        self.tell_settings(0);
        Ok(())
    }

    /// Gives late subscribers the last message of every stream that keeps one: while nothing is published.
    pub fn update(&self) {
        self.outlets().into_iter().for_each(Outlet::update);
    }

    /// The first time that a consumer was waited for in vain, if there was one.
    pub fn held_up(&self) -> Option<&BridgeError> {
        self.outlets().into_iter().find_map(Outlet::held_up)
    }

    /// Every stream, in the order in which they were opened.
    pub fn outlets(&self) -> Vec<&Outlet> {
        let of_channels = self.channels.iter().flat_map(|scheduled| scheduled.channel.outlets());
        of_channels.chain([&self.settings]).collect()
    }
}

/// The lower of the sensor's rate and its plugin's; every physics step if neither gives one.
fn sensor_rate(sensor: &Sensor, physics: &Physics) -> Rate {
    sensor.effective_rate_hz().and_then(Rate::from_hz).unwrap_or(Rate::from_period_ns(physics.step_ns()))
}
