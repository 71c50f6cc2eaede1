//! The inertial measurement unit of a Kobuki: its gyro chip, and the accelerometer that Gazebo's plugin adds.
//!
//! It measures at the link `gyro_link`: the rate of turn, in steps of the chip, and the specific force, a − g, which is
//! +g upwards at rest (REP-145). The force is the mean since the last report, computed from the change of velocity, so
//! that no bump between two reports is lost. The orientation is the heading of odometry, about z only, as in the base's
//! driver (Gazebo's plugin gives the true orientation, which a Kobuki does not know).

use super::odometry::{Odometry, gyro_reading};
use super::transforms::base_link;
use crate::description::model::{LinkIndex, Model};
use crate::world::physics::{ModelIndex, Physics};
use belvedere_sensors::Pose;
use glam::{DQuat, DVec3};

/// The link that the gyro is mounted on. In a model without it, the gyro is at the base's origin.
const GYRO_LINK: &str = "gyro_link";

/// Variance of the angles that a gyro about z does not measure.
const UNKNOWN: f64 = 1e6;

/// Steps of the acceleration per m/s². The velocities of a base at rest fluctuate with the last digits of its coordinates,
/// which this hides.
const STEPS_PER_M_S2: f64 = 1e5;

/// The unit's report (`sensor_msgs/Imu`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImuReading {
    /// The heading of odometry, as a rotation about z.
    pub orientation: DQuat,
    /// Rate of turn in the unit's frame in rad/s, in steps of the chip.
    pub angular_velocity_rad_s: DVec3,
    /// Specific force in the unit's frame in m/s².
    pub linear_acceleration_m_s2: DVec3,
}

impl ImuReading {
    /// Row-major 3×3 covariance of orientation and of rate of turn, as Kobuki's plugin gives it.
    pub const TURN_COVARIANCE: [f64; 9] = [UNKNOWN, 0.0, 0.0, 0.0, UNKNOWN, 0.0, 0.0, 0.0, 0.05];
    /// Row-major 3×3 covariance of the acceleration: the plugin leaves it unset, which means "not known".
    pub const ACCELERATION_COVARIANCE: [f64; 9] = [0.0; 9];
}

/// The unit of a base.
#[derive(Debug, Clone, Copy)]
pub struct Imu {
    model: ModelIndex,
    link: LinkIndex,
    /// Velocity in the world after the last step.
    velocity_m_s: DVec3,
    /// Velocity and time at the last report.
    reported_m_s: DVec3,
    reported_ns: u64,
}

impl Imu {
    /// Mounts the unit, at rest.
    pub(super) fn new(model: &Model, index: ModelIndex, physics: &Physics) -> Self {
        Self {
            model: index,
            link: Self::mount(model),
            velocity_m_s: DVec3::ZERO,
            reported_m_s: DVec3::ZERO,
            reported_ns: physics.time_ns(),
        }
    }

    /// Returns the link whose frame the readings are in.
    pub fn mount(model: &Model) -> LinkIndex {
        model.link_named(GYRO_LINK).unwrap_or_else(|| base_link(model))
    }

    /// Returns the report for an odometry report, whose timestamp is within the last step or at its ends.
    pub(super) fn report(&mut self, physics: &Physics, odometry: &Odometry) -> ImuReading {
        let stamp_ns = odometry.stamp_ns;
        let (after_m_s, turn) = physics.link_velocity(self.model, self.link);
        let left = physics.time_ns().saturating_sub(stamp_ns) as f64 / physics.step_ns() as f64;
        let now_m_s = after_m_s + (self.velocity_m_s - after_m_s) * left.min(1.0);
        let period_s = stamp_ns.saturating_sub(self.reported_ns) as f64 * 1e-9;
        let acceleration =
            if period_s > 0.0 { (now_m_s - self.reported_m_s) / period_s } else { DVec3::ZERO };
        (self.reported_m_s, self.reported_ns) = (now_m_s, stamp_ns);
        let imu_from_world = physics.world_from_link_at(self.model, self.link, stamp_ns).inverse();
        let rate = imu_from_world.transform_vector(turn);
        ImuReading {
            orientation: odometry.odom_from_base.rotation(),
            angular_velocity_rad_s: DVec3::from_array(rate.to_array().map(gyro_reading)) + DVec3::ZERO,
            linear_acceleration_m_s2: whole_steps(
                imu_from_world.transform_vector(acceleration - physics.gravity()),
            ),
        }
    }

    /// Handles a move by hand, by `moved` in the world. The change of velocity does not count as a force.
    pub(super) fn carried(&mut self, physics: &Physics, moved: &Pose) {
        let (velocity_m_s, _) = physics.link_velocity(self.model, self.link);
        let changed_m_s = moved.transform_vector(self.velocity_m_s - self.reported_m_s);
        (self.velocity_m_s, self.reported_m_s) = (velocity_m_s, velocity_m_s - changed_m_s);
    }

    /// Stores the velocity for the next step's reports.
    pub(super) fn end_step(&mut self, physics: &Physics) {
        (self.velocity_m_s, _) = physics.link_velocity(self.model, self.link);
    }
}

/// Rounds an acceleration to whole steps.
fn whole_steps(acceleration_m_s2: DVec3) -> DVec3 {
    let steps =
        acceleration_m_s2.to_array().map(|value| libm::round(value * STEPS_PER_M_S2) / STEPS_PER_M_S2);
    // Turns −0 into 0.
    DVec3::from_array(steps) + DVec3::ZERO
}
