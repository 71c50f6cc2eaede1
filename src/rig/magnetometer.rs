//! A magnetometer with its stream.

use super::behaviour::Behaviour;
use super::channel::Channel;
use super::instrument::{Running, covariance};
use super::mount::Mount;
use super::outlet::Outlet;
use super::report::{Say, instrument};
use super::{Opening, RigContext, RigError, Settings};
use crate::description::model::{self, InstrumentPlugin, Sensor};
use crate::description::text::vector;
use belvedere_bridge::payload::{MagneticField, Vector3};
use belvedere_bridge::{Kind, StreamSpec};
use glam::DVec3;

impl Behaviour for model::Magnetometer {
    fn name(&self) -> &'static str {
        "magnetometer"
    }

    fn open(&self, sensor: &Sensor, opening: &Opening<'_>) -> Result<Option<Box<dyn Channel>>, RigError> {
        let Some(plugin) = &self.plugin else { return Ok(None) };
        Ok(Some(Box::new(MagnetometerChannel::open(sensor, self, plugin, opening)?)))
    }

    fn settings(&self, rate_hz: f64) -> Settings {
        Settings::new(rate_hz)
    }

    fn report(&self, _gazebo_compat: bool, say: Say<'_>) {
        let unit = if self.field.is_some() { "" } else { "T" };
        say("axes", instrument(&self.axes, unit));
        say(
            "field",
            match self.field {
                None => "the world's <magnetic_field>".into(),
                Some(field) => format!("{} in the world", vector(field.in_world)),
            },
        );
    }
}

/// A running magnetometer.
struct MagnetometerChannel {
    mount: Mount,
    in_world: DVec3,
    axes: Running<3>,
    field: Outlet,
    is_vector: bool,
}

impl MagnetometerChannel {
    fn open(
        sensor: &Sensor,
        magnetometer: &model::Magnetometer,
        plugin: &InstrumentPlugin,
        opening: &Opening<'_>,
    ) -> Result<Self, RigError> {
        let (topic, frame) = opening.names(sensor, plugin);
        let is_vector = magnetometer.field.is_some_and(|field| field.is_vector);
        let kind = if is_vector { Kind::Vector3 } else { Kind::MagneticField };
        let spec = StreamSpec::structs(&topic, kind, 1).frame_id(&frame).rate_hz(opening.rate.hz());
        Ok(Self {
            mount: Mount::new(sensor, opening),
            in_world: magnetometer.field.map_or(opening.earth.magnetic_field_t, |field| field.in_world),
            axes: Running::new(sensor, &magnetometer.axes, 0, opening)?,
            field: opening.open(&spec)?,
            is_vector,
        })
    }
}

impl Channel for MagnetometerChannel {
    fn outlets(&self) -> Vec<&Outlet> {
        vec![&self.field]
    }

    fn publish(&mut self, context: &mut RigContext<'_>, frame: u64) {
        let stamp_ns = context.stamp_ns;
        let truth = self.mount.pose(context).inverse().transform_vector(self.in_world);
        let variances = self.axes.variance(stamp_ns);
        let read = self.axes.read(truth.to_array(), frame, stamp_ns);
        if self.is_vector {
            self.field.send_structs(stamp_ns, &[Vector3 { vector: read }]);
        } else {
            let message = MagneticField { magnetic_field: read, covariance: covariance(variances) };
            self.field.send_structs(stamp_ns, &[message]);
        }
    }

    fn restart(&mut self) {
        self.axes.restart();
    }
}
