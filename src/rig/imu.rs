//! An inertial measurement unit with its stream: angular velocity and specific force (a − g, which is +g upwards at
//! rest: REP-145) with the errors of its gyros and accelerometers, and its orientation.

use super::behaviour::Behaviour;
use super::channel::Channel;
use super::instrument::{Running, covariance};
use super::outlet::Outlet;
use super::packets::{ImuPackets, PacketTarget};
use super::report::{Say, instrument};
use super::{Opening, RigContext, RigError, Settings};
use crate::description::model::{self, InstrumentPlugin, OrientationReference, Sensor, SensorKind};
use crate::entities::EntityId;
use crate::world::earth::enu_from_world;
use belvedere_bridge::payload::Imu;
use belvedere_bridge::{Kind, StreamSpec};
use belvedere_sensors::imu::{self, ImuState, InertialReading};
use belvedere_sensors::noise::{Stream, standard_normal};
use glam::{DQuat, DVec3};
use std::io;

/// Noise channel of orientations.
const ORIENTATION_CHANNEL: u16 = 24;

impl Behaviour for model::Imu {
    fn name(&self) -> &'static str {
        "imu"
    }

    fn open(&self, sensor: &Sensor, opening: &Opening<'_>) -> Result<Option<Box<dyn Channel>>, RigError> {
        let Some(plugin) = &self.plugin else { return Ok(None) };
        Ok(Some(Box::new(ImuChannel::open(sensor, self, plugin, opening)?)))
    }

    fn settings(&self, rate_hz: f64) -> Settings {
        Settings::new(rate_hz)
    }

    fn report(&self, _gazebo_compat: bool, say: Say<'_>) {
        say("gyro", instrument(&self.config.gyro, "rad/s"));
        say("acceleration", instrument(&self.config.accelerometer, "m/s²"));
        let turned = |rotation: DQuat| if rotation == DQuat::IDENTITY { "" } else { "axes turned in " };
        say(
            "orientation",
            match self.reference {
                None => "none".into(),
                Some(OrientationReference::World(rotation)) => format!("in {}the world", turned(rotation)),
                Some(OrientationReference::East(rotation)) => {
                    format!("in {}those of east, north and up", turned(rotation))
                }
                Some(OrientationReference::Start(rotation)) => {
                    format!("in {}the unit's own axes at the start", turned(rotation))
                }
            },
        );
        if !self.heading.is_exact() {
            say("heading", instrument(&self.heading, "rad"));
        }
        if let Some(profile) = self.packets {
            say("packets", format!("Ouster's, {}", profile.name()));
        }
    }
}

/// A running unit.
struct ImuChannel {
    id: EntityId,
    /// Its index among the model's units.
    number: usize,
    unit: imu::Imu,
    state: ImuState,
    reference: Option<OrientationReference>,
    enu_from_world: DQuat,
    offset: DQuat,
    orientation_stddev: f64,
    heading: Running<1>,
    seed: u64,
    sensor: u32,
    imu: Outlet,
    /// Present if it is part of an Ouster.
    packets: Option<ImuPackets>,
    /// Time of the last frame, and the integral of acceleration until then.
    last: (u64, DVec3),
    /// The unit's axes at its first frame.
    world_from_start: Option<DQuat>,
}

impl ImuChannel {
    fn open(
        sensor: &Sensor,
        unit: &model::Imu,
        plugin: &InstrumentPlugin,
        opening: &Opening<'_>,
    ) -> Result<Self, RigError> {
        let entity = opening.entity;
        let units = entity.sensors().iter().filter(|sensor| matches!(sensor.kind, SensorKind::Imu(_)));
        let number = units.take_while(|other| !std::ptr::eq(*other, sensor)).count();
        let (topic, frame) = opening.names(sensor, plugin);
        let spec = StreamSpec::structs(&topic, Kind::Imu, 1).frame_id(&frame);
        let now_ns = opening.physics.time_ns();
        let felt = entity.units.get(number).map(|unit| unit.felt_at(opening.physics, now_ns));
        let made = imu::Imu::new(unit.config, opening.seed, opening.sensor);
        let made = made.map_err(|error| RigError::sensor(sensor, &error))?;
        Ok(Self {
            id: opening.id,
            number,
            state: made.start(),
            unit: made,
            reference: unit.reference,
            enu_from_world: enu_from_world(opening.earth, opening.gazebo_compat && opening.earth.is_given),
            offset: unit.orientation_offset,
            orientation_stddev: unit.orientation_stddev,
            // Gyro and accelerometer have the numbers 0 and 1.
            heading: Running::new(sensor, &unit.heading, 2, opening)?,
            seed: opening.seed,
            sensor: opening.sensor,
            packets: unit.packets.map(ImuPackets::new),
            imu: opening.open(&spec.rate_hz(opening.rate.hz()))?,
            last: (now_ns, felt.unwrap_or_default()),
            world_from_start: None,
        })
    }

    /// Returns the orientation that it reports.
    fn orientation(&mut self, world_from_unit: DQuat, frame: u64, stamp_ns: u64) -> DQuat {
        let [error] = self.heading.read([0.0], frame, stamp_ns);
        let world_from_start = *self.world_from_start.get_or_insert(world_from_unit);
        let world_from_reference = match self.reference {
            Some(OrientationReference::World(turned)) => turned,
            Some(OrientationReference::East(turned)) => self.enu_from_world.inverse() * turned,
            Some(OrientationReference::Start(turned)) => world_from_start * turned,
            None => return DQuat::IDENTITY,
        };
        let turned = DQuat::from_rotation_z(error) * world_from_unit;
        let reported = self.offset * (world_from_reference.inverse() * turned);
        if self.orientation_stddev == 0.0 {
            return reported;
        }
        let stream = Stream { seed: self.seed, sensor: self.sensor, frame, channel: ORIENTATION_CHANNEL };
        let noise = [0, 1, 2, 3].map(|part| f64::from(standard_normal(&stream, part)));
        (reported + DQuat::from_array(noise) * self.orientation_stddev).normalize()
    }
}

impl Channel for ImuChannel {
    fn outlets(&self) -> Vec<&Outlet> {
        vec![&self.imu]
    }

    fn publish(&mut self, context: &mut RigContext<'_>, frame: u64) {
        let RigContext { physics, stamp_ns, .. } = *context;
        let entity = context.entities.get(self.id);
        let Some(unit) = entity.and_then(|entity| entity.units.get(self.number)) else { return };
        let felt_m_s = unit.felt_at(physics, stamp_ns);
        let (last_ns, last_m_s) = self.last;
        let period_s = stamp_ns.saturating_sub(last_ns) as f64 * 1e-9;
        // The mean since the last frame, so that no bump between two frames is lost.
        let acceleration = if period_s > 0.0 { (felt_m_s - last_m_s) / period_s } else { DVec3::ZERO };
        self.last = (stamp_ns, felt_m_s);
        let world_from_unit = unit.world_from_unit_at(physics, stamp_ns);
        let truth = InertialReading {
            angular_velocity: unit.turn_at(physics, stamp_ns),
            specific_force: world_from_unit.inverse().transform_vector(acceleration - physics.gravity()),
        };
        // Measured even without subscribers, because the bias drifts.
        let read = self.unit.measure(&truth, frame, period_s, &mut self.state);
        let covariance = |stddev: [f64; 3]| covariance(stddev.map(|stddev| stddev * stddev));
        let config = self.unit.config();
        let mut orientation_covariance = covariance([self.orientation_stddev; 3]);
        let [heading] = self.heading.variance(stamp_ns);
        orientation_covariance[8] += heading;
        if self.reference.is_none() {
            // In the ROS message, −1 means that there is no orientation.
            orientation_covariance[0] = -1.0;
        }
        let message = Imu {
            orientation: self.orientation(world_from_unit.rotation(), frame, stamp_ns).to_array(),
            angular_velocity: read.angular_velocity.to_array(),
            linear_acceleration: read.specific_force.to_array(),
            orientation_covariance,
            angular_velocity_covariance: covariance(config.gyro.white_stddev(period_s)),
            linear_acceleration_covariance: covariance(config.accelerometer.white_stddev(period_s)),
        };
        if let Some(packets) = &mut self.packets {
            packets.push(stamp_ns, &read);
        }
        self.imu.send_structs(stamp_ns, &[message]);
    }

    fn restart(&mut self) {
        self.last = (0, DVec3::ZERO);
        self.state = self.unit.start();
        self.heading.restart();
        self.world_from_start = None;
        if let Some(packets) = &mut self.packets {
            packets.restart();
        }
    }

    fn check_packets(&self, target: &PacketTarget) -> io::Result<()> {
        match &self.packets {
            Some(_) => ImuPackets::check(target),
            None => Err(io::Error::other(
                "this inertial unit has no packets; only that of an Ouster has, if its sensor has <udp_profile_imu>",
            )),
        }
    }

    fn send_packets(&mut self, target: &PacketTarget) -> io::Result<()> {
        self.packets.as_mut().map_or(Ok(()), |packets| packets.open(target))
    }
}
