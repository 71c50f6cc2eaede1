//! The sensors of the robots on their schedule: each sensor with its streams is a *channel*, and each channel has
//! its own exact rate.
//!
//! A frame is rendered straight into the shared memory that subscribers read: the bridge lends it, the sensor
//! fills it, the bridge sends it. What nobody follows is not rendered.

pub mod attendance;
pub mod base;
mod camera;
mod depth;
mod lidar;
mod mount;
mod outlet;
pub mod pictures;
mod range;
pub mod rate;
pub mod schedule;
pub mod settings;
mod state;

pub use outlet::{Outlet, Tally};
pub use rate::Rate;
pub use schedule::Schedule;
pub use settings::Settings;

use crate::description::model::{Model, Plugin, Sensor, SensorKind};
use crate::description::values::nearest;
use crate::description::{Problem, Severity};
use crate::robot::Robot;
use crate::world::physics::{ModelIndex, Physics};
use crate::world::scene::WorldScene;
use base::BaseChannel;
use belvedere_bridge::{Error as BridgeError, Lossless, Node, StreamSpec};
use belvedere_sensors::Execution;
use belvedere_sensors::trace::WorkspaceBuf;
use camera::CameraChannel;
use depth::DepthChannel;
use lidar::LidarChannel;
use range::RangeChannel;
use state::{ClockChannel, StateChannel};

/// Rate of the clock in Hz: a consumer's timers get within 10 ms of simulated time.
const CLOCK_HZ: f64 = 100.0;
/// Rate of odometry, transforms, joint states and of the base's sensors: a Kobuki's own.
const STATE_HZ: f64 = 50.0;

/// Why the sensors cannot be started.
#[derive(Debug, thiserror::Error)]
pub enum RigError {
    /// The bridge cannot open a stream.
    #[error(transparent)]
    Bridge(#[from] BridgeError),
    /// A sensor or a name in the robot's description cannot be used.
    #[error(transparent)]
    Description(#[from] Problem),
    /// A name is too long for the wire format.
    #[error("name '{name}': {reason}; rename it in the robot's description")]
    Name {
        /// The link, joint or frame.
        name: String,
        /// What is wrong with it.
        reason: String,
    },
}

impl RigError {
    fn sensor(sensor: &Sensor, error: &dyn std::error::Error) -> Self {
        Self::Description(Problem {
            severity: Severity::Error,
            source: sensor.source.clone(),
            what: format!("sensor '{}': {error}", sensor.name),
            remedy: "correct the value in the sensor's description".into(),
        })
    }

    fn name(name: &str, reason: &dyn std::error::Error) -> Self {
        Self::Name { name: name.into(), reason: reason.to_string() }
    }
}

/// How the rig is to run.
#[derive(Debug, Clone)]
pub struct RigOptions {
    /// Seed of all noise.
    pub seed: u64,
    /// Gazebo's measured habits instead of what is right.
    pub gazebo_compat: bool,
    /// Hash every byte that is published.
    pub hashed: bool,
    /// Whom every stream waits for, if for anybody.
    pub lossless: Option<Lossless>,
    /// SIMD level and threads of the sensors.
    pub execution: Execution,
}

/// What a channel needs to open.
pub(crate) struct Setting<'a> {
    node: &'a Node,
    physics: &'a Physics,
    model: &'a Model,
    model_index: ModelIndex,
    robot: usize,
    rate: Rate,
    seed: u64,
    sensor: u32,
    gazebo_compat: bool,
    hashed: bool,
    lossless: Option<&'a Lossless>,
}

impl Setting<'_> {
    /// A stream of small messages, which are sent whether or not anybody follows: late consumers get the last one.
    fn open(&self, spec: &StreamSpec) -> Result<Outlet, RigError> {
        Ok(Outlet::open(self.node, spec, self.hashed, self.lossless)?)
    }

    /// A stream that is rendered while somebody follows it. It keeps no frame for late consumers: the last one may be
    /// of long ago.
    fn open_rendered(&self, spec: StreamSpec) -> Result<Outlet, RigError> {
        self.open(&StreamSpec { history: 0, ..spec })
    }

    /// The frame that a sensor's messages name: the plugin's, or its link.
    fn frame_id(&self, sensor: &Sensor, frame_name: &str) -> String {
        let link = &self.model.links[sensor.link].name;
        if frame_name.is_empty() { link.clone() } else { frame_name.to_owned() }
    }
}

/// What a channel needs to publish a frame.
pub(crate) struct RigContext<'a> {
    stamp_ns: u64,
    physics: &'a Physics,
    robots: &'a [Robot],
    scene: &'a WorldScene,
    workspace: &'a mut WorkspaceBuf,
}

enum Channel {
    Clock(Box<ClockChannel>),
    State(Box<StateChannel>),
    Base(Box<BaseChannel>),
    Camera(Box<CameraChannel>),
    Depth(Box<DepthChannel>),
    Lidar(Box<LidarChannel>),
    Range(Box<RangeChannel>),
}

impl Channel {
    /// Its streams.
    fn outlets(&self) -> Vec<&Outlet> {
        match self {
            Self::Clock(clock) => clock.outlets().into(),
            Self::State(state) => state.outlets().collect(),
            Self::Base(base) => base.outlets().into(),
            Self::Camera(camera) => camera.outlets().into(),
            Self::Depth(depth) => depth.outlets().into(),
            Self::Lidar(lidar) => lidar.outlets().into(),
            Self::Range(range) => range.outlets().into(),
        }
    }

    /// Whether its next frame shows the scene to somebody.
    fn is_rendered(&self) -> bool {
        match self {
            Self::Clock(_) | Self::State(_) | Self::Base(_) => false,
            Self::Camera(_) | Self::Depth(_) | Self::Lidar(_) | Self::Range(_) => {
                self.outlets().into_iter().any(Outlet::is_wanted)
            }
        }
    }
}

struct Scheduled {
    /// As described.
    rate: Rate,
    schedule: Schedule,
    channel: Channel,
    /// Of what can be changed while it runs.
    tuning: Option<Tuning>,
}

/// A sensor's settings, described and as they are.
struct Tuning {
    sensor: String,
    described: Settings,
    now: Settings,
}

impl Scheduled {
    fn new(rate: Rate, channel: Channel) -> Self {
        Self { rate, schedule: Schedule::new(rate), channel, tuning: None }
    }

    /// Takes other settings from the next frame on.
    fn configure(&mut self, settings: Settings, now_ns: u64) -> Result<(), String> {
        let Some(tuning) = &mut self.tuning else { return Ok(()) };
        let rate_hz = settings.update_rate_hz();
        let rate = Rate::from_hz(rate_hz).ok_or_else(|| format!("{rate_hz} Hz is no rate"))?;
        let configured = match &mut self.channel {
            Channel::Clock(_) | Channel::State(_) | Channel::Base(_) => Ok(()),
            Channel::Camera(camera) => camera.configure(&settings),
            Channel::Depth(depth) => depth.configure(&settings),
            Channel::Lidar(lidar) => lidar.configure(&settings),
            Channel::Range(range) => range.configure(&settings),
        };
        configured.map_err(|error| error.to_string())?;
        if rate_hz.to_bits() != tuning.now.update_rate_hz().to_bits() {
            self.schedule.change_rate(rate, now_ns);
        }
        tuning.now = settings;
        self.channel.outlets().into_iter().for_each(|outlet| outlet.set_rate_hz(rate_hz));
        Ok(())
    }

    fn topics(&self) -> Vec<String> {
        self.channel.outlets().into_iter().map(Outlet::topic).collect()
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
        let settings = Outlet::open(node, &settings, options.hashed, options.lossless.as_ref())?;
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
                hashed: options.hashed,
                lossless: options.lossless.as_ref(),
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
                if let Some(channel) = open_sensor(sensor, &setting(rate, sensor_number))? {
                    let described = Settings::described(sensor, rate.hz());
                    let tuning = Tuning { sensor: sensor.name.clone(), described, now: described };
                    rig.channels.push(Scheduled { tuning: Some(tuning), ..Scheduled::new(rate, channel) });
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

    /// Publishes every frame that is due at `stamp_ns`, for which physics must have arrived there.
    pub fn publish(&mut self, stamp_ns: u64, physics: &Physics, robots: &[Robot], scene: &mut WorldScene) {
        for scheduled in &mut self.channels {
            if scheduled.schedule.next_ns() != stamp_ns {
                continue;
            }
            if scheduled.channel.is_rendered() {
                scene.move_to(physics, stamp_ns);
            }
            let workspace = &mut self.workspace;
            let mut context = RigContext { stamp_ns, physics, robots, scene, workspace };
            let frame = scheduled.schedule.next();
            match &mut scheduled.channel {
                Channel::Clock(clock) => {
                    clock.publish(&mut context);
                    // Whoever has come since the last change gets the settings now.
                    self.settings.update();
                }
                Channel::State(state) => state.publish(&mut context),
                Channel::Base(base) => base.publish(&mut context),
                Channel::Camera(camera) => camera.publish(&mut context, frame),
                Channel::Depth(depth) => depth.publish(&mut context, frame),
                Channel::Lidar(lidar) => lidar.publish(&mut context, frame),
                Channel::Range(range) => range.publish(&mut context, frame),
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
            scheduled.schedule = Schedule::new(scheduled.rate);
        }
        self.tell_settings(0);
        Ok(())
    }

    /// Changes settings of a sensor, named or told by a topic that it sends: all that the text says, or nothing.
    ///
    /// # Errors
    /// In words: there is no such sensor, or several of the name; what is wrong with the text.
    pub fn configure(&mut self, sensor: &str, text: &str, now_ns: u64) -> Result<(), String> {
        let scheduled = self.find(sensor)?;
        if let Some(Tuning { now, .. }) = &scheduled.tuning {
            let changed = now.changed(text)?;
            scheduled.configure(changed, now_ns)?;
        }
        self.tell_settings(now_ns);
        Ok(())
    }

    fn find(&mut self, sensor: &str) -> Result<&mut Scheduled, String> {
        let topic = format!("/{}", sensor.trim_start_matches('/'));
        let is_meant = |scheduled: &Scheduled| {
            scheduled.tuning.as_ref().is_some_and(|tuning| tuning.sensor == sensor)
                || scheduled.tuning.is_some() && scheduled.topics().contains(&topic)
        };
        let meant: Vec<usize> =
            (0..self.channels.len()).filter(|&index| is_meant(&self.channels[index])).collect();
        match meant[..] {
            [index] => Ok(&mut self.channels[index]),
            [] => {
                let sensors = || self.channels.iter().filter_map(|channel| channel.tuning.as_ref());
                let names: Vec<&str> = sensors().map(|tuning| tuning.sensor.as_str()).collect();
                let near = nearest(sensor, names.iter().copied())
                    .map(|near| format!("did you mean '{near}'? "))
                    .unwrap_or_default();
                let there = if names.is_empty() { "none".into() } else { names.join(", ") };
                Err(format!(
                    "there is no sensor '{sensor}', and none sends such a topic; {near}there are: {there}"
                ))
            }
            _ => Err(format!(
                "there are {} sensors '{sensor}'; name the one that is meant by a topic that it sends",
                meant.len()
            )),
        }
    }

    /// Sends what can be changed, and what it is from `stamp_ns` on.
    fn tell_settings(&mut self, stamp_ns: u64) {
        let message = |scheduled: &Scheduled| {
            let tuning = scheduled.tuning.as_ref()?;
            Some(tuning.now.message(&tuning.sensor, &scheduled.topics()))
        };
        let messages: Vec<_> = self.channels.iter().filter_map(message).collect();
        self.settings.send_structs(stamp_ns, &messages);
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

fn open_sensor(sensor: &Sensor, setting: &Setting<'_>) -> Result<Option<Channel>, RigError> {
    Ok(match (&sensor.kind, &sensor.plugin) {
        (SensorKind::Camera(camera), Some(Plugin::Camera(plugin))) => {
            Some(Channel::Camera(CameraChannel::open(sensor, camera, plugin, setting)?.into()))
        }
        (SensorKind::Depth(camera), Some(Plugin::DepthCamera(plugin))) => {
            Some(Channel::Depth(DepthChannel::open(sensor, camera, plugin, setting)?.into()))
        }
        (SensorKind::Ray(ray), Some(Plugin::Laser(plugin))) => {
            Some(Channel::Lidar(LidarChannel::open(sensor, ray, plugin, setting)?.into()))
        }
        (SensorKind::Ray(ray), Some(Plugin::Range(plugin))) => {
            Some(Channel::Range(RangeChannel::open(sensor, ray, plugin, setting)?.into()))
        }
        _ => {
            tracing::warn!(sensor = sensor.name, source = %sensor.source, "has no plugin that publishes it");
            None
        }
    })
}

/// The lower of the sensor's rate and its plugin's; every physics step if neither gives one.
fn sensor_rate(sensor: &Sensor, physics: &Physics) -> Rate {
    sensor.effective_rate_hz().and_then(Rate::from_hz).unwrap_or(Rate::from_period_ns(physics.step_ns()))
}
