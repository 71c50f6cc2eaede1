//! A satellite navigation receiver with its streams.

use super::behaviour::Behaviour;
use super::channel::Channel;
use super::instrument::{Running, covariance};
use super::mount::Mount;
use super::outlet::Outlet;
use super::report::{Say, instrument};
use super::{Opening, RigContext, RigError, Settings};
use crate::description::diagnostics::Severity;
use crate::description::model::{self, Earth, InstrumentPlugin, Sensor};
use crate::description::text::{angle, number};
use crate::world::earth::{enu_from_world, geodetic};
use belvedere_bridge::payload::{NavSatFix, Vector3};
use belvedere_bridge::{Kind, StreamSpec};
use glam::{DMat3, DQuat, DVec3};

impl Behaviour for model::NavSat {
    fn name(&self) -> &'static str {
        "navsat"
    }

    fn open(&self, sensor: &Sensor, opening: &Opening<'_>) -> Result<Option<Box<dyn Channel>>, RigError> {
        let Some(plugin) = &self.plugin else { return Ok(None) };
        Ok(Some(Box::new(NavSatChannel::open(sensor, self, plugin, opening)?)))
    }

    fn settings(&self, rate_hz: f64) -> Settings {
        Settings::new(rate_hz)
    }

    fn report(&self, _gazebo_compat: bool, say: Say<'_>) {
        say("position", instrument(&self.position, "m"));
        say("velocity", instrument(&self.velocity, "m/s"));
        say(
            "origin",
            match self.origin {
                None => "the world's <spherical_coordinates>".into(),
                Some([latitude, longitude, altitude, heading]) => format!(
                    "latitude {}°, longitude {}°, {} m, x is {} left of east",
                    number(latitude),
                    number(longitude),
                    number(altitude),
                    angle(heading)
                ),
            },
        );
    }
}

/// A running receiver.
struct NavSatChannel {
    mount: Mount,
    earth: Earth,
    enu_from_world: DQuat,
    position: Running<3>,
    velocity: Running<3>,
    fix: Outlet,
    velocity_alone: Option<Outlet>,
}

impl NavSatChannel {
    fn open(
        sensor: &Sensor,
        receiver: &model::NavSat,
        plugin: &InstrumentPlugin,
        opening: &Opening<'_>,
    ) -> Result<Self, RigError> {
        let (topic, frame) = opening.names(sensor, plugin);
        let rate_hz = opening.rate.hz();
        let open = |topic: &str, kind| {
            opening.open(&StreamSpec::structs(topic, kind, 1).frame_id(&frame).rate_hz(rate_hz))
        };
        let (earth, enu_from_world) = match receiver.origin {
            // The plugin's own origin, whose axes are never rotated by half a turn.
            Some([latitude_deg, longitude_deg, elevation_m, heading_rad]) => {
                let own = Earth { latitude_deg, longitude_deg, elevation_m, heading_rad, ..Earth::default() };
                (own, enu_from_world(&own, false))
            }
            None => (*opening.earth, enu_from_world(opening.earth, opening.gazebo_compat)),
        };
        if receiver.origin.is_none() && !earth.is_given {
            let what = format!(
                "the world has no <spherical_coordinates>: sensor '{}' assumes latitude 0, longitude 0",
                sensor.name
            );
            let remedy = "give the world <spherical_coordinates>, or the sensor's plugin its reference";
            opening.names.note(Severity::Warning, &sensor.source, what, remedy);
        }
        Ok(Self {
            mount: Mount::new(sensor, opening),
            earth,
            enu_from_world,
            position: Running::new(sensor, &receiver.position, 0, opening)?,
            velocity: Running::new(sensor, &receiver.velocity, 1, opening)?,
            fix: open(&topic, Kind::NavSatFix)?,
            velocity_alone: match &receiver.velocity_topic {
                Some(topic) => Some(open(topic, Kind::Vector3)?),
                None => None,
            },
        })
    }
}

impl Channel for NavSatChannel {
    fn outlets(&self) -> Vec<&Outlet> {
        std::iter::once(&self.fix).chain(&self.velocity_alone).collect()
    }

    fn publish(&mut self, context: &mut RigContext<'_>, frame: u64) {
        let stamp_ns = context.stamp_ns;
        // Errors are along the world's axes, as in Gazebo's plugins and Team Hector's.
        let position = self.mount.pose(context).translation();
        let velocity = self.mount.velocity(context.physics);
        let position_covariance = turned(self.enu_from_world, self.position.variance(stamp_ns));
        let position = DVec3::from(self.position.read(position.to_array(), frame, stamp_ns));
        let velocity = DVec3::from(self.velocity.read(velocity.to_array(), frame, stamp_ns));
        let place = geodetic(&self.earth, self.enu_from_world * position);
        let velocity = (self.enu_from_world * velocity).to_array();
        let [east, north, up] = velocity;
        self.fix.send_structs(
            stamp_ns,
            &[NavSatFix {
                latitude: place.latitude_deg,
                longitude: place.longitude_deg,
                altitude: place.altitude_m,
                velocity,
                position_covariance,
            }],
        );
        if let Some(outlet) = &mut self.velocity_alone {
            outlet.send_structs(stamp_ns, &[Vector3 { vector: [north, -east, up] }]);
        }
    }

    fn restart(&mut self) {
        self.position.restart();
        self.velocity.restart();
    }
}

/// Converts variances along the world's axes to a covariance along east, north and up.
fn turned(enu_from_world: DQuat, variances: [f64; 3]) -> [f64; 9] {
    let rotation = DMat3::from_quat(enu_from_world);
    let squares = [rotation.x_axis, rotation.y_axis, rotation.z_axis].map(|axis| axis * axis);
    covariance((DMat3::from_cols_array_2d(&squares.map(Into::into)) * DVec3::from(variances)).to_array())
}
