//! A barometer with its stream.

use super::behaviour::Behaviour;
use super::channel::Channel;
use super::instrument::Running;
use super::mount::Mount;
use super::outlet::Outlet;
use super::report::{Say, instrument};
use super::{Opening, RigContext, RigError, Settings};
use crate::description::model::{self, InstrumentPlugin, Sensor};
use crate::description::text::number;
use crate::world::earth::air_pressure_pa;
use belvedere_bridge::payload::FluidPressure;
use belvedere_bridge::{Kind, StreamSpec};

impl Behaviour for model::AirPressure {
    fn name(&self) -> &'static str {
        "air pressure"
    }

    fn open(&self, sensor: &Sensor, opening: &Opening<'_>) -> Result<Option<Box<dyn Channel>>, RigError> {
        let Some(plugin) = &self.plugin else { return Ok(None) };
        Ok(Some(Box::new(AirPressureChannel::open(sensor, self, plugin, opening)?)))
    }

    fn settings(&self, rate_hz: f64) -> Settings {
        Settings::new(rate_hz)
    }

    fn report(&self, _gazebo_compat: bool, say: Say<'_>) {
        say("pressure", instrument(&self.pressure, "Pa"));
        say("origin at", format!("{} m above sea level", number(self.reference_altitude_m)));
    }
}

/// A running barometer.
struct AirPressureChannel {
    mount: Mount,
    reference_m: f64,
    pressure: Running<1>,
    outlet: Outlet,
}

impl AirPressureChannel {
    fn open(
        sensor: &Sensor,
        barometer: &model::AirPressure,
        plugin: &InstrumentPlugin,
        opening: &Opening<'_>,
    ) -> Result<Self, RigError> {
        let (topic, frame) = opening.names(sensor, plugin);
        let spec = StreamSpec::structs(&topic, Kind::FluidPressure, 1).frame_id(&frame);
        Ok(Self {
            mount: Mount::new(sensor, opening),
            reference_m: barometer.reference_altitude_m,
            pressure: Running::new(sensor, &barometer.pressure, 0, opening)?,
            outlet: opening.open(&spec.rate_hz(opening.rate.hz()))?,
        })
    }
}

impl Channel for AirPressureChannel {
    fn outlets(&self) -> Vec<&Outlet> {
        vec![&self.outlet]
    }

    fn publish(&mut self, context: &mut RigContext<'_>, frame: u64) {
        let stamp_ns = context.stamp_ns;
        let truth = air_pressure_pa(self.reference_m + self.mount.pose(context).translation().z);
        let [variance] = self.pressure.variance(stamp_ns);
        let [fluid_pressure] = self.pressure.read([truth], frame, stamp_ns);
        self.outlet.send_structs(stamp_ns, &[FluidPressure { fluid_pressure, variance }]);
    }

    fn restart(&mut self) {
        self.pressure.restart();
    }
}
