//! The IMU of a model's plugin and its stream: true orientation, rate of turn and specific force (a − g, which is +g
//! upwards at rest: REP-145), with white noise.

use super::channel::Channel;
use super::outlet::Outlet;
use super::{Opening, RigContext, RigError};
use crate::description::model::ImuPlugin;
use crate::entities::EntityId;
use belvedere_bridge::payload::Imu;
use belvedere_bridge::{Kind, StreamSpec};
use belvedere_sensors::noise::{Stream, standard_normal};
use glam::DVec3;

/// Noise channel of inertial measurements.
const IMU_CHANNEL: u16 = 16;

/// A running unit.
pub(super) struct ImuChannel {
    id: EntityId,
    /// Which of its model's units it is.
    number: usize,
    /// Of rates of turn and of accelerations.
    stddev: [f64; 2],
    seed: u64,
    sensor: u32,
    imu: Outlet,
    /// Time of the last frame, and what the unit had felt until then.
    last: (u64, DVec3),
}

impl ImuChannel {
    pub(super) fn open(plugin: &ImuPlugin, number: usize, opening: &Opening<'_>) -> Result<Self, RigError> {
        let spec = StreamSpec::structs(&plugin.topic, Kind::Imu, 1);
        let unit = opening.entity.robot.as_ref().and_then(|robot| robot.units().get(number));
        let now_ns = opening.physics.time_ns();
        Ok(Self {
            id: opening.id,
            number,
            stddev: [plugin.turn_stddev, plugin.acceleration_stddev],
            seed: opening.seed,
            sensor: opening.sensor,
            imu: opening.open(&spec.frame_id(&plugin.frame).rate_hz(opening.rate.hz()))?,
            last: (now_ns, unit.map(|unit| unit.felt_at(opening.physics, now_ns)).unwrap_or_default()),
        })
    }
}

impl Channel for ImuChannel {
    fn outlets(&self) -> Vec<&Outlet> {
        vec![&self.imu]
    }

    fn publish(&mut self, context: &mut RigContext<'_>, frame: u64) {
        let RigContext { physics, stamp_ns, .. } = *context;
        let robot = context.entities.robot(self.id);
        let Some(unit) = robot.and_then(|robot| robot.units().get(self.number)) else { return };
        let felt_m_s = unit.felt_at(physics, stamp_ns);
        let (last_ns, last_m_s) = self.last;
        let period_s = stamp_ns.saturating_sub(last_ns) as f64 * 1e-9;
        // The mean since the last frame: no bump falls between two.
        let acceleration = if period_s > 0.0 { (felt_m_s - last_m_s) / period_s } else { DVec3::ZERO };
        self.last = (stamp_ns, felt_m_s);
        let world_from_unit = unit.world_from_unit_at(physics, stamp_ns);
        let force = world_from_unit.inverse().transform_vector(acceleration - physics.gravity());
        let stream = Stream { seed: self.seed, sensor: self.sensor, frame, channel: IMU_CHANNEL };
        let noise = |kind: u32| {
            let axes = [0, 1, 2].map(|axis| f64::from(standard_normal(&stream, 3 * kind + axis)));
            DVec3::from_array(axes) * self.stddev[kind as usize]
        };
        let covariance = self.stddev.map(|stddev| {
            let variance = stddev * stddev;
            [variance, 0.0, 0.0, 0.0, variance, 0.0, 0.0, 0.0, variance]
        });
        self.imu.send_structs(
            stamp_ns,
            &[Imu {
                orientation: world_from_unit.rotation().to_array(),
                angular_velocity: (unit.turn_at(physics, stamp_ns) + noise(0)).to_array(),
                linear_acceleration: (force + noise(1)).to_array(),
                orientation_covariance: [0.0; 9],
                angular_velocity_covariance: covariance[0],
                linear_acceleration_covariance: covariance[1],
            }],
        );
    }

    fn restart(&mut self) {
        self.last = (0, DVec3::ZERO);
    }
}
