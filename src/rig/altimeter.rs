//! An altimeter with its stream.

use super::behaviour::Behaviour;
use super::channel::Channel;
use super::instrument::Running;
use super::mount::Mount;
use super::outlet::Outlet;
use super::report::{Say, instrument};
use super::{Opening, RigContext, RigError, Settings};
use crate::description::model::{self, InstrumentPlugin, Sensor};
use crate::description::text::number;
use belvedere_bridge::payload::Altimeter;
use belvedere_bridge::{Kind, StreamSpec};

impl Behaviour for model::Altimeter {
    fn name(&self) -> &'static str {
        "altimeter"
    }

    fn open(&self, sensor: &Sensor, opening: &Opening<'_>) -> Result<Option<Box<dyn Channel>>, RigError> {
        let Some(plugin) = &self.plugin else { return Ok(None) };
        Ok(Some(Box::new(AltimeterChannel::open(sensor, self, plugin, opening)?)))
    }

    fn settings(&self, rate_hz: f64) -> Settings {
        Settings::new(rate_hz)
    }

    fn report(&self, _gazebo_compat: bool, say: Say<'_>) {
        say("height", instrument(&self.position, "m"));
        say("velocity", instrument(&self.velocity, "m/s"));
        let from = self.reference_m.map(|height| format!("{} m in the world", number(height)));
        say("above", from.unwrap_or_else(|| "its height at the start".into()));
    }
}

/// A running altimeter.
struct AltimeterChannel {
    mount: Mount,
    /// The reference in the description; `None` for the height at the first frame.
    reference_m: Option<f64>,
    first_m: Option<f64>,
    position: Running<1>,
    velocity: Running<1>,
    altimeter: Outlet,
}

impl AltimeterChannel {
    fn open(
        sensor: &Sensor,
        altimeter: &model::Altimeter,
        plugin: &InstrumentPlugin,
        opening: &Opening<'_>,
    ) -> Result<Self, RigError> {
        let (topic, frame) = opening.names(sensor, plugin);
        let spec = StreamSpec::structs(&topic, Kind::Altimeter, 1).frame_id(&frame);
        Ok(Self {
            mount: Mount::new(sensor, opening),
            reference_m: altimeter.reference_m,
            first_m: None,
            position: Running::new(sensor, &altimeter.position, 0, opening)?,
            velocity: Running::new(sensor, &altimeter.velocity, 1, opening)?,
            altimeter: opening.open(&spec.rate_hz(opening.rate.hz()))?,
        })
    }
}

impl Channel for AltimeterChannel {
    fn outlets(&self) -> Vec<&Outlet> {
        vec![&self.altimeter]
    }

    fn publish(&mut self, context: &mut RigContext<'_>, frame: u64) {
        let stamp_ns = context.stamp_ns;
        let height = self.mount.pose(context).translation().z;
        let first_m = *self.first_m.get_or_insert(height);
        let reference_m = self.reference_m.unwrap_or(first_m);
        let [variance] = self.position.variance(stamp_ns);
        let [position] = self.position.read([height - reference_m], frame, stamp_ns);
        let [velocity] = self.velocity.read([self.mount.velocity(context.physics).z], frame, stamp_ns);
        self.altimeter.send_structs(
            stamp_ns,
            &[Altimeter {
                vertical_position: position,
                vertical_velocity: velocity,
                vertical_reference: reference_m,
                variance,
            }],
        );
    }

    fn restart(&mut self) {
        self.first_m = None;
        self.position.restart();
        self.velocity.restart();
    }
}
