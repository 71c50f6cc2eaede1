//! The Kobuki base: two driven wheels, two casters, encoders and a gyro.
//!
//! The grip of its wheels (`grip.rs`) is limited by their motors and by friction.
//!
//! Commands are followed with [`MAX_ACCELERATION_M_S2`] and [`MAX_ANGULAR_ACCELERATION_RAD_S2`], like the base's own
//! controller and the velocity smoothers in front of it; in Gazebo's plugin only the torque limits the acceleration.

use super::base::Base;
use super::command::Command;
use super::contact::{Contact, ContactSensors};
use super::grip::Axle;
use super::imu::{Imu, ImuReading};
use super::odometry::{ODOMETRY_PERIOD_NS, Odometer, Odometry, encoder_count, gyro_reading};
use super::transforms::base_link;
use crate::description::diagnostics::Problem;
use crate::description::model::{BasePlugin, LinkIndex, Model, Wheels};
use crate::world::physics::{ModelIndex, Physics};
use belvedere_sensors::Pose;

/// Default time for which a command is followed, in ns; then the base stops.
pub const COMMAND_TIMEOUT_NS: u64 = 600_000_000;
/// Top speed in the data sheet, for the base and for each wheel on the ground, in m/s.
pub const MAX_SPEED_M_S: f64 = 0.7;
/// Top rate of turn in the data sheet, in rad/s: 180 °/s.
pub const MAX_TURN_RAD_S: f64 = std::f64::consts::PI;
/// Acceleration, in m/s².
pub const MAX_ACCELERATION_M_S2: f64 = 1.0;
/// Angular acceleration, in rad/s².
pub const MAX_ANGULAR_ACCELERATION_RAD_S2: f64 = 4.0;
/// Number of reports that are kept: those within one physics step of at most 0.1 s, including both ends, and a few
/// earlier ones.
const REPORTS_KEPT: usize = 8;

/// The base's report, 50 times a second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Report {
    /// Odometry, with the timestamp of the whole report.
    pub odometry: Odometry,
    /// Readings of the gyro and the accelerometer.
    pub imu: ImuReading,
    /// Encoder ticks of the left and the right wheel.
    pub encoders: [u16; 2],
    /// State of the bumpers, cliff sensors and wheel-drop sensors.
    pub contact: Contact,
}

/// A Kobuki in the world.
#[derive(Debug)]
pub struct Kobuki {
    model: ModelIndex,
    base: LinkIndex,
    axle: Axle,
    timeout_ns: u64,
    command: Command,
    command_ns: u64,
    /// The velocity set for the motors, which approaches the command.
    followed: Command,
    gyro_heading_rad: f64,
    /// Whether commands are followed.
    powered: bool,
    odometer: Odometer,
    imu: Imu,
    contact: ContactSensors,
    /// The latest reports, the oldest overwritten first; `reports[newest]` is the last.
    reports: [Report; REPORTS_KEPT],
    newest: usize,
}

impl Kobuki {
    /// Creates the base of a robot that is in `physics`.
    ///
    /// # Errors
    /// If its wheels cannot drive.
    pub(super) fn new(
        model: &Model,
        plugin: &BasePlugin,
        wheels: &Wheels,
        index: ModelIndex,
        physics: &mut Physics,
    ) -> Result<Self, Problem> {
        let axle = Axle::of(model, plugin, wheels)?;
        axle.release(physics, index);
        let mut odometer = Odometer::new(axle.radius_m);
        let mut imu = Imu::new(model, index, physics);
        let contact =
            ContactSensors::new(model, index, [0, 1].map(|side| axle.wheels[side].link), axle.radius_m);
        let odometry = odometer.update(physics.time_ns(), [0; 2], 0.0);
        let start = Report {
            odometry,
            imu: imu.report(physics, &odometry),
            encoders: [0; 2],
            contact: ContactSensors::at_start(),
        };
        Ok(Self {
            model: index,
            base: base_link(model),
            axle,
            timeout_ns: plugin.command_timeout_s.map_or(COMMAND_TIMEOUT_NS, |time_s| (time_s * 1e9) as u64),
            command: Command::STOP,
            command_ns: 0,
            followed: Command::STOP,
            gyro_heading_rad: 0.0,
            powered: true,
            odometer,
            imu,
            contact,
            reports: [start; REPORTS_KEPT],
            newest: 0,
        })
    }

    /// Returns the distance between the wheels in m.
    pub fn separation_m(&self) -> f64 {
        self.axle.separation_m
    }

    /// Returns the radius of the wheels in m.
    pub fn radius_m(&self) -> f64 {
        self.axle.radius_m
    }

    /// Returns the counts of the left and right encoder at a time between the last two steps.
    fn encoders_at(&self, physics: &Physics, stamp_ns: u64) -> [u16; 2] {
        self.axle.turned_rad(physics, self.model, stamp_ns).map(encoder_count)
    }

    /// Returns the newest report at or before a time between the last two steps.
    pub fn report_at(&self, stamp_ns: u64) -> &Report {
        (0..REPORTS_KEPT)
            .map(|age| &self.reports[(self.newest + REPORTS_KEPT - age) % REPORTS_KEPT])
            .find(|report| report.odometry.stamp_ns <= stamp_ns)
            .unwrap_or(&self.reports[self.newest])
    }
}

impl Base for Kobuki {
    /// Ignores commands while the motors have no power.
    fn command(&mut self, command: Command, stamp_ns: u64) {
        if !self.powered {
            return;
        }
        self.command = command.limited(MAX_SPEED_M_S, MAX_TURN_RAD_S, self.axle.separation_m);
        self.command_ns = stamp_ns;
    }

    /// Turns the motors' power on or off. While it is off, the wheels hold and commands are ignored. When it is on
    /// again, the base waits for the next command. The base's driver and Kobuki's plugin do the same.
    fn set_motor_power(&mut self, on: bool) {
        if on != self.powered {
            self.powered = on;
            self.command = Command::STOP;
        }
    }

    /// Resets odometry and the heading of the IMU to zero at the current pose, as the base's driver does. Encoders
    /// continue to count.
    fn reset_odometry(&mut self, physics: &Physics) {
        self.gyro_heading_rad = 0.0;
        self.odometer.reset(physics.time_ns(), self.encoders_at(physics, physics.time_ns()));
    }

    /// Sets the motors for the next step.
    fn control(&mut self, physics: &mut Physics) {
        let expired = physics.time_ns().saturating_sub(self.command_ns) >= self.timeout_ns;
        let wanted = if expired { Command::STOP } else { self.command };
        let step_s = physics.step_s();
        let approach =
            |from: f64, to: f64, rate: f64| from + (to - from).clamp(-rate * step_s, rate * step_s);
        self.followed = Command {
            lateral_m_s: 0.0,
            linear_m_s: approach(self.followed.linear_m_s, wanted.linear_m_s, MAX_ACCELERATION_M_S2),
            angular_rad_s: approach(
                self.followed.angular_rad_s,
                wanted.angular_rad_s,
                MAX_ANGULAR_ACCELERATION_RAD_S2,
            ),
        };
        let Command { linear_m_s, angular_rad_s, .. } = self.followed;
        let rims_m_s = [-0.5, 0.5].map(|side| linear_m_s + side * self.axle.separation_m * angular_rad_s);
        self.axle.grip(physics, self.model, self.base, self.followed, rims_m_s);
    }

    /// Handles a move by hand, which does not count as motion.
    fn carried(&mut self, physics: &Physics, world_from_before: &Pose) {
        let moved = physics.world_from_link(self.model, self.base) * world_from_before.inverse();
        self.imu.carried(physics, &moved);
    }

    /// Reads the sensors after a step, and makes reports at the base's rate.
    fn observe(&mut self, physics: &Physics) {
        self.contact.notice(physics);
        let (_, turn_in_world) = physics.link_velocity(self.model, self.base);
        let base_from_world = physics.world_from_link(self.model, self.base).inverse();
        let rate = gyro_reading(base_from_world.transform_vector(turn_in_world).z);
        let (before_ns, before_rad) = (physics.time_ns() - physics.step_ns(), self.gyro_heading_rad);
        self.gyro_heading_rad += rate * physics.step_s();
        let mut stamp_ns = (before_ns / ODOMETRY_PERIOD_NS + 1) * ODOMETRY_PERIOD_NS;
        // If one step includes several reports, they all have the contacts at its end.
        let mut felt = None;
        while stamp_ns <= physics.time_ns() {
            let heading_rad = before_rad + rate * (stamp_ns - before_ns) as f64 * 1e-9;
            let encoders = self.encoders_at(physics, stamp_ns);
            self.newest = (self.newest + 1) % REPORTS_KEPT;
            let odometry = self.odometer.update(stamp_ns, encoders, heading_rad);
            self.reports[self.newest] = Report {
                odometry,
                imu: self.imu.report(physics, &odometry),
                encoders,
                contact: *felt.get_or_insert_with(|| self.contact.report(physics)),
            };
            stamp_ns += ODOMETRY_PERIOD_NS;
        }
        self.imu.end_step(physics);
    }

    fn odometry_at(&self, _physics: &Physics, stamp_ns: u64) -> Odometry {
        self.report_at(stamp_ns).odometry
    }
}
