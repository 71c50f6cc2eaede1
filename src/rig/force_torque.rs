//! A force-torque sensor with its stream.

use super::behaviour::Behaviour;
use super::channel::Channel;
use super::instrument::Running;
use super::outlet::Outlet;
use super::report::{Say, instrument};
use super::{Opening, RigContext, RigError, Settings};
use crate::description::model::{self, InstrumentPlugin, MeasureFrame, Sensor, SensorKind};
use crate::entities::EntityId;
use crate::world::physics;
use belvedere_bridge::payload::Wrench;
use belvedere_bridge::{Kind, StreamSpec};

impl Behaviour for model::ForceTorque {
    fn name(&self) -> &'static str {
        "force-torque sensor"
    }

    fn open(&self, sensor: &Sensor, opening: &Opening<'_>) -> Result<Option<Box<dyn Channel>>, RigError> {
        let Some(plugin) = &self.plugin else { return Ok(None) };
        let channel = ForceTorqueChannel::open(sensor, self, plugin, opening)?;
        Ok(channel.map(|channel| Box::new(channel) as Box<dyn Channel>))
    }

    fn settings(&self, rate_hz: f64) -> Settings {
        Settings::new(rate_hz)
    }

    fn report(&self, _gazebo_compat: bool, say: Say<'_>) {
        say("force", instrument(&self.force, "N"));
        say("torque", instrument(&self.torque, "N·m"));
        let direction = if self.parent_to_child {
            "of the joint's parent on its child"
        } else {
            "of the joint's child on its parent"
        };
        say("direction", direction.into());
        let axes = match self.frame {
            MeasureFrame::Child => "of the joint's child link",
            MeasureFrame::Parent => "of the joint's parent link",
            MeasureFrame::Sensor => "of the sensor",
        };
        say("axes", axes.into());
    }
}

/// A running sensor.
struct ForceTorqueChannel {
    id: EntityId,
    /// Its index among the model's force-torque sensors.
    number: usize,
    /// 1 for what the parent does to the child, −1 for the opposite.
    sign: f64,
    force: Running<3>,
    torque: Running<3>,
    /// Time of the last frame, and the impulse that the joint had transmitted by then.
    last: (u64, physics::Wrench),
    wrench: Outlet,
}

impl ForceTorqueChannel {
    /// Creates the sensor. Returns `None` for a joint that physics cannot measure, which it has reported.
    fn open(
        sensor: &Sensor,
        described: &model::ForceTorque,
        plugin: &InstrumentPlugin,
        opening: &Opening<'_>,
    ) -> Result<Option<Self>, RigError> {
        let all = opening.entity.sensors().iter();
        let all = all.filter(|sensor| matches!(sensor.kind, SensorKind::ForceTorque(_)));
        let number = all.take_while(|other| !std::ptr::eq(*other, sensor)).count();
        let now_ns = opening.physics.time_ns();
        let Some(passed) = opening.physics.passed_at(opening.id.index(), number, now_ns) else {
            return Ok(None);
        };
        let (topic, frame) = opening.names(sensor, plugin);
        let spec = StreamSpec::structs(&topic, Kind::Wrench, 1).frame_id(&frame);
        Ok(Some(Self {
            id: opening.id,
            number,
            sign: if described.parent_to_child { 1.0 } else { -1.0 },
            force: Running::new(sensor, &described.force, 0, opening)?,
            torque: Running::new(sensor, &described.torque, 1, opening)?,
            last: (now_ns, passed),
            wrench: opening.open(&spec.rate_hz(opening.rate.hz()))?,
        }))
    }
}

impl Channel for ForceTorqueChannel {
    fn outlets(&self) -> Vec<&Outlet> {
        vec![&self.wrench]
    }

    fn publish(&mut self, context: &mut RigContext<'_>, frame: u64) {
        let RigContext { physics, stamp_ns, .. } = *context;
        let Some(passed) = physics.passed_at(self.id.index(), self.number, stamp_ns) else { return };
        let (last_ns, last) = std::mem::replace(&mut self.last, (stamp_ns, passed));
        // The mean since the last frame, so that no impact between two frames is lost. The first frame has the mean of the
        // last step. Before the first step there is no value.
        let period_s = stamp_ns.saturating_sub(last_ns) as f64 * 1e-9;
        let mean = if period_s > 0.0 {
            Some(passed.mean_since(&last, period_s))
        } else {
            physics.wrench(self.id.index(), self.number)
        };
        let Some(mean) = mean else { return };
        let [force, torque] = [mean.force, mean.torque].map(|part| (part * self.sign).to_array());
        let message = Wrench {
            force: self.force.read(force, frame, stamp_ns),
            torque: self.torque.read(torque, frame, stamp_ns),
        };
        self.wrench.send_structs(stamp_ns, &[message]);
    }

    fn restart(&mut self) {
        self.last = (0, physics::Wrench::default());
        self.force.restart();
        self.torque.restart();
    }
}
