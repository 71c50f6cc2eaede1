//! [`InertialUnit`]: the accelerations of a link, without changes of velocity by hand.

use crate::description::model::{Model, Sensor, SensorKind};
use crate::world::physics::{ModelIndex, Physics};
use belvedere_sensors::Pose;
use glam::DVec3;

/// An inertial measurement unit on its link.
#[derive(Debug, Clone, Copy)]
pub struct InertialUnit {
    model: ModelIndex,
    link: usize,
    link_from_unit: Pose,
    /// Velocity in the world after the last step.
    velocity_m_s: DVec3,
    /// Velocity without changes by hand, after the last step but one and after the last.
    felt_m_s: [DVec3; 2],
}

impl InertialUnit {
    /// Returns the units of a model, in the order of its sensors.
    pub(crate) fn all(model: &Model, index: ModelIndex) -> Vec<Self> {
        let is_unit = |sensor: &&Sensor| matches!(sensor.kind, SensorKind::Imu(_));
        let unit = |sensor: &Sensor| Self {
            model: index,
            link: sensor.link,
            link_from_unit: sensor.link_from_sensor,
            velocity_m_s: DVec3::ZERO,
            felt_m_s: [DVec3::ZERO; 2],
        };
        model.sensors.iter().filter(is_unit).map(unit).collect()
    }

    fn velocity(&self, physics: &Physics) -> DVec3 {
        let (linear, turn) = physics.link_velocity(self.model, self.link);
        let world_from_link = physics.world_from_link(self.model, self.link);
        linear + turn.cross(world_from_link.transform_vector(self.link_from_unit.translation()))
    }

    pub(crate) fn observe(&mut self, physics: &Physics) {
        let velocity_m_s = self.velocity(physics);
        let felt_m_s = self.felt_m_s[1] + velocity_m_s - self.velocity_m_s;
        self.felt_m_s = [self.felt_m_s[1], felt_m_s];
        self.velocity_m_s = velocity_m_s;
    }

    pub(crate) fn carried(&mut self, physics: &Physics) {
        self.velocity_m_s = self.velocity(physics);
    }

    /// Returns the integral of all accelerations until a time between the last two steps, in m/s along the world's
    /// axes.
    pub fn felt_at(&self, physics: &Physics, stamp_ns: u64) -> DVec3 {
        let left = physics.time_ns().saturating_sub(stamp_ns) as f64 / physics.step_ns() as f64;
        self.felt_m_s[1] + (self.felt_m_s[0] - self.felt_m_s[1]) * left.min(1.0)
    }

    /// Returns its pose in the world at a time between the last two steps.
    pub fn world_from_unit_at(&self, physics: &Physics, stamp_ns: u64) -> Pose {
        physics.world_from_link_at(self.model, self.link, stamp_ns) * self.link_from_unit
    }

    /// Returns the angular velocity in rad/s along its own axes.
    pub fn turn_at(&self, physics: &Physics, stamp_ns: u64) -> DVec3 {
        let (_, turn) = physics.link_velocity(self.model, self.link);
        self.world_from_unit_at(physics, stamp_ns).inverse().transform_vector(turn)
    }
}
