//! [`Mounting`]: opens the streams of a model.

use super::annotations::Census;
use super::base::BaseChannel;
use super::behaviour::behaviour;
use super::channel::{Channel, Opening};
use super::cost::Cost;
use super::error::RigError;
use super::joint_states::JointStatesChannel;
use super::names::Names;
use super::numbers::Numbers;
use super::owner::Owner;
use super::rate::Rate;
use super::robot_pose::RobotPoseChannel;
use super::schedule::Schedule;
use super::sink::Sink;
use super::state::StateChannel;
use super::true_pose::TruePoseChannel;
use super::tuning::Tuning;
use super::{RigOptions, Scheduled, Stage, fixed_rate};
use crate::description::Severity;
use crate::description::housing::housings;
use crate::description::model::{Drive, ModelPlugin, Sensor};
use crate::description::sensor_frames::{SensorFrame, sensor_frames};
use crate::entities::{Entity, EntityId, Origin};
use crate::robot::Robot;
use crate::world::physics::Physics;

/// Rate of transforms and joint states of a robot without a base, and of a Kobuki's sensors.
const STATE_HZ: f64 = 50.0;

/// Knowledge about the streams of all models while further ones are opened. It is collected once for all of them,
/// because that reads each stream.
pub(super) struct Mounting {
    pub(super) names: Names,
    pub(super) numbers: Numbers,
    pub(super) census: Census,
}

impl Mounting {
    /// Opens all streams of a model, in the order in which its channels are published.
    pub(super) fn open(
        &mut self,
        sink: &dyn Sink,
        stage: Stage<'_>,
        id: EntityId,
        options: &RigOptions,
    ) -> Result<Vec<Scheduled>, RigError> {
        let Some(entity) = stage.entities.get(id) else { return Ok(Vec::new()) };
        let frames =
            if options.gazebo_compat { Vec::new() } else { sensor_frames(&entity.model, &entity.namespace) };
        let Self { names, numbers, census } = self;
        let mut model = Mounted {
            sink,
            stage,
            id,
            entity,
            options,
            names,
            numbers,
            census: *census,
            frames,
            channels: Vec::new(),
        };
        if let Some(robot) = &entity.robot {
            model.open_state(robot)?;
            model.open_plugins()?;
        }
        model.open_sensors()?;
        // After all streams of the model's own, which have priority.
        model.open_true_pose()?;
        Ok(model.channels)
    }
}

/// A model whose streams are opened.
struct Mounted<'a> {
    sink: &'a dyn Sink,
    stage: Stage<'a>,
    id: EntityId,
    entity: &'a Entity,
    options: &'a RigOptions,
    names: &'a Names,
    numbers: &'a mut Numbers,
    census: Census,
    frames: Vec<SensorFrame>,
    /// The channels that have been opened.
    channels: Vec<Scheduled>,
}

impl Mounted<'_> {
    /// Opens the state of a robot, and the sensors of its base.
    fn open_state(&mut self, robot: &Robot) -> Result<(), RigError> {
        let Self { id, entity, .. } = *self;
        let physics = self.stage.physics;
        let base = entity.model.base().filter(|_| robot.base().is_some());
        let rate = plugin_rate(base.map_or(Some(STATE_HZ), |base| base.odometry.rate_hz), physics);
        let state = StateChannel::open(robot, &self.opening(rate, 0, Owner::robot(id, entity)))?;
        self.channels.push(self.scheduled(rate, Box::new(state)));
        if let Some(base) = base.filter(|base| matches!(base.drive, Drive::Kobuki(_))) {
            let rate = fixed_rate(STATE_HZ, physics);
            let base = BaseChannel::open(&self.opening(rate, 0, Owner::base(id, entity, base)))?;
            self.channels.push(self.scheduled(rate, Box::new(base)));
        }
        Ok(())
    }

    /// Opens the streams of a robot's other plugins.
    fn open_plugins(&mut self) -> Result<(), RigError> {
        let Self { id, entity, .. } = *self;
        let physics = self.stage.physics;
        for (index, plugin) in entity.model.plugins.iter().enumerate() {
            let owner = Owner::plugin(id, entity, index, plugin);
            match plugin {
                ModelPlugin::Base(_) => {}
                ModelPlugin::Pose(pose) => {
                    let rate = plugin_rate(pose.rate_hz, physics);
                    let number = self.numbers.take([&entity.noise_name, "", &pose.topic]);
                    let channel = TruePoseChannel::open(pose, &self.opening(rate, number, owner))?;
                    let scheduled = self.scheduled(rate, Box::new(channel));
                    self.channels.push(Scheduled { number, ..scheduled });
                }
                ModelPlugin::JointStates(states) => {
                    let rate = plugin_rate(states.rate_hz, physics);
                    let channel = JointStatesChannel::open(states, &self.opening(rate, 0, owner))?;
                    self.channels.push(self.scheduled(rate, Box::new(channel)));
                }
            }
        }
        Ok(())
    }

    fn open_sensors(&mut self) -> Result<(), RigError> {
        let Self { id, entity, .. } = *self;
        for (index, sensor) in entity.sensors().iter().enumerate() {
            let rate = sensor_rate(sensor, self.stage.physics);
            // A sensor's name is unique on its link.
            let link = &entity.model.links[sensor.link].name;
            let number = self.numbers.take([&entity.noise_name, link, &sensor.name]);
            let owner = Owner::sensor(id, entity, index, sensor);
            let Some(channel) = behaviour(sensor).open(sensor, &self.opening(rate, number, owner))? else {
                let what = format!(
                    "sensor '{}' publishes nothing: it has neither a plugin that is simulated nor a <topic>",
                    sensor.name
                );
                let remedy = "give it a <plugin> of gazebo_ros, or a <topic> as in gz-sim";
                self.names.note(Severity::Warning, &sensor.source, what, remedy);
                continue;
            };
            let described = behaviour(sensor).settings(rate.hz());
            let housing = (!self.options.gazebo_compat).then(|| housings(&entity.model, sensor));
            let tuning = Tuning { sensor: entity.scoped(&sensor.name), described, now: described };
            self.channels.push(Scheduled {
                number,
                tuning: Some(tuning),
                housing: housing.unwrap_or_default(),
                ..self.scheduled(rate, channel)
            });
        }
        Ok(())
    }

    /// Opens the pose of a robot, if ground truth is published.
    fn open_true_pose(&mut self) -> Result<(), RigError> {
        let Self { id, entity, .. } = *self;
        if self.options.truth && entity.robot.is_some() && entity.origin != Origin::World {
            let rate = fixed_rate(STATE_HZ, self.stage.physics);
            if let Some(pose) = RobotPoseChannel::open(&self.opening(rate, 0, Owner::robot(id, entity)))? {
                self.channels.push(self.scheduled(rate, Box::new(pose)));
            }
        }
        Ok(())
    }

    fn opening(&self, rate: Rate, sensor: u32, owner: Owner) -> Opening<'_> {
        Opening {
            sink: self.sink,
            physics: self.stage.physics,
            earth: self.stage.earth,
            entity: self.entity,
            id: self.id,
            rate,
            seed: self.options.seed,
            sensor,
            gazebo_compat: self.options.gazebo_compat,
            truth: self.options.truth,
            census: self.census,
            hashed: self.options.hashed,
            owner,
            names: self.names,
            frames: &self.frames,
        }
    }

    /// Returns a channel without noise, settings and a housing.
    fn scheduled(&self, rate: Rate, channel: Box<dyn Channel>) -> Scheduled {
        Scheduled {
            entity: Some(self.id),
            number: 0,
            rate,
            schedule: Schedule::starting(rate, self.stage.physics.time_ns()),
            channel,
            tuning: None,
            cost: Cost::default(),
            housing: Vec::new(),
        }
    }
}

/// Returns a plugin's rate, or one frame per physics step if it has none.
fn plugin_rate(hz: Option<f64>, physics: &Physics) -> Rate {
    fixed_rate(hz.unwrap_or(0.0), physics)
}

/// Returns the lower of the sensor's rate and its plugin's, or one frame per physics step if neither has one.
fn sensor_rate(sensor: &Sensor, physics: &Physics) -> Rate {
    sensor.effective_rate_hz().and_then(Rate::from_hz).unwrap_or(Rate::from_period_ns(physics.step_ns()))
}
