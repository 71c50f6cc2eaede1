//! The Kobuki base: two driven wheels, two casters, encoders and a gyro.
//!
//! The wheels are real bodies that roll on the ground by friction; motors in their joints hold the commanded
//! velocity with at most 1 N·m, as Kobuki's Gazebo plugin does. Unlike the plugin, which lets the torque alone
//! limit the acceleration (28 N at each wheel: the base would rear up), commands are followed with
//! [`MAX_ACCELERATION_M_S2`] and [`MAX_ANGULAR_ACCELERATION_RAD_S2`], as the base's own controller and the
//! velocity smoothers in front of it do. The casters slide without friction, as in Kobuki's description.

use super::drive::Command;
use super::odometry::{ODOMETRY_PERIOD_NS, Odometer, Odometry, encoder_count, gyro_reading};
use super::transforms::base_link;
use crate::description::diagnostics::{Problem, Severity};
use crate::description::model::{Geometry, JointKind, LinkIndex, Model};
use crate::world::physics::{JointIndex, ModelIndex, Physics};
use glam::DVec3;

/// A command is followed for so long, in ns; then the base stops.
pub const COMMAND_TIMEOUT_NS: u64 = 600_000_000;
/// Top speed of the data sheet, of the base and of each wheel on the ground, in m/s.
pub const MAX_SPEED_M_S: f64 = 0.7;
/// Top rate of turn of the data sheet, in rad/s: 180 °/s.
pub const MAX_TURN_RAD_S: f64 = std::f64::consts::PI;
/// How fast the speed changes, in m/s².
pub const MAX_ACCELERATION_M_S2: f64 = 1.0;
/// How fast the rate of turn changes, in rad/s².
pub const MAX_ANGULAR_ACCELERATION_RAD_S2: f64 = 4.0;
/// Torque of a wheel's motor, in N·m.
const WHEEL_TORQUE_N_M: f64 = 1.0;
/// The wheel's radius where the model gives its wheel no round shape, in m.
const DEFAULT_WHEEL_RADIUS_M: f64 = 0.035;
const WHEEL_JOINTS: [&str; 2] = ["wheel_left_joint", "wheel_right_joint"];
/// Reports within one step of physics of at most 0.1 s, both ends included, and a few before.
const REPORTS_KEPT: usize = 8;

/// A Kobuki in the world.
#[derive(Debug)]
pub struct Kobuki {
    model: ModelIndex,
    base: LinkIndex,
    /// Left and right.
    wheels: [Wheel; 2],
    separation_m: f64,
    radius_m: f64,
    command: Command,
    command_ns: u64,
    /// What the motors are told, on its way to the command.
    followed: Command,
    gyro_heading_rad: f64,
    odometer: Odometer,
    /// The latest reports, the oldest overwritten first; `reports[newest]` is the last.
    reports: [Odometry; REPORTS_KEPT],
    newest: usize,
}

#[derive(Debug, Clone, Copy)]
struct Wheel {
    joint: JointIndex,
    /// +1 if a positive turn of the joint rolls the base forward, −1 if backward.
    sign: f64,
}

impl Kobuki {
    /// Finds the wheels in a model and makes its casters slippery.
    ///
    /// # Errors
    /// If the model has no such wheels; it is a passive model then. The problem is a note, or a warning if there
    /// are wheel joints that cannot drive.
    pub fn new(model: &Model, index: ModelIndex, physics: &mut Physics) -> Result<Self, Problem> {
        let passive = |severity, what: String, remedy: &str| Problem {
            severity,
            source: model.source.clone(),
            what: format!("robot '{}' cannot drive: {what}", model.name),
            remedy: remedy.into(),
        };
        let mut joints = [0; 2];
        for (joint, name) in joints.iter_mut().zip(WHEEL_JOINTS) {
            *joint = model.joints.iter().position(|joint| joint.name == name).ok_or_else(|| {
                passive(
                    Severity::Note,
                    format!("it has no joint '{name}'"),
                    "give it the wheels of a Kobuki, wheel_left_joint and wheel_right_joint, if it is to drive",
                )
            })?;
        }
        let rest = model.rest_poses();
        let base = base_link(model);
        let base_from_model = rest[base].inverse();
        let mut centres = [DVec3::ZERO; 2];
        let mut wheels = joints.map(|joint| Wheel { joint, sign: 1.0 });
        for (wheel, centre) in wheels.iter_mut().zip(&mut centres) {
            let joint = &model.joints[wheel.joint];
            let base_from_wheel = base_from_model * rest[joint.child];
            *centre = base_from_wheel.translation();
            let across = base_from_wheel.transform_vector(joint.axis).y;
            let turns =
                joint.kind == JointKind::Continuous && physics.joint_state(index, wheel.joint).is_some();
            if !turns || across.abs() < 0.99 {
                return Err(Problem {
                    source: joint.source.clone(),
                    ..passive(
                        Severity::Warning,
                        format!("joint '{}' does not turn about the base's y axis", joint.name),
                        "make it continuous, with its axis across the base and mass on both sides",
                    )
                });
            }
            wheel.sign = across.signum();
        }
        let separation_m = centres[0].y - centres[1].y;
        if separation_m < 0.01 {
            return Err(passive(
                Severity::Warning,
                format!("its left wheel is {separation_m} m to the left of its right one"),
                "put them on their sides of the base, for a Kobuki at y = 0.115 and -0.115",
            ));
        }
        let radius_m = wheel_radius_m(model, model.joints[joints[0]].child).unwrap_or(DEFAULT_WHEEL_RADIUS_M);
        for caster in (0..model.links.len()).filter(|link| model.links[*link].name.contains("caster")) {
            physics.set_link_friction(index, caster, 0.0);
        }
        let mut odometer = Odometer::new(radius_m);
        let start = odometer.update(physics.time_ns(), [0; 2], 0.0);
        Ok(Self {
            model: index,
            base,
            wheels,
            separation_m,
            radius_m,
            command: Command::STOP,
            command_ns: 0,
            followed: Command::STOP,
            gyro_heading_rad: 0.0,
            odometer,
            reports: [start; REPORTS_KEPT],
            newest: 0,
        })
    }

    /// Distance between the wheels in m.
    pub fn separation_m(&self) -> f64 {
        self.separation_m
    }

    /// Radius of the wheels in m.
    pub fn radius_m(&self) -> f64 {
        self.radius_m
    }

    /// Gives a command at a time in ns. One that is not finite means stop.
    pub fn command(&mut self, command: Command, stamp_ns: u64) {
        self.command = command.limited(MAX_SPEED_M_S, MAX_TURN_RAD_S, self.separation_m);
        self.command_ns = stamp_ns;
    }

    /// Sets the motors for the step to come.
    pub fn control(&mut self, physics: &mut Physics) {
        let expired = physics.time_ns().saturating_sub(self.command_ns) >= COMMAND_TIMEOUT_NS;
        let wanted = if expired { Command::STOP } else { self.command };
        let step_s = physics.step_s();
        let approach =
            |from: f64, to: f64, rate: f64| from + (to - from).clamp(-rate * step_s, rate * step_s);
        self.followed = Command {
            linear_m_s: approach(self.followed.linear_m_s, wanted.linear_m_s, MAX_ACCELERATION_M_S2),
            angular_rad_s: approach(
                self.followed.angular_rad_s,
                wanted.angular_rad_s,
                MAX_ANGULAR_ACCELERATION_RAD_S2,
            ),
        };
        for (wheel, side) in self.wheels.iter().zip([-0.5, 0.5]) {
            let ground_m_s =
                self.followed.linear_m_s + side * self.separation_m * self.followed.angular_rad_s;
            let velocity = wheel.sign * ground_m_s / self.radius_m;
            physics.drive_joint(self.model, wheel.joint, velocity, WHEEL_TORQUE_N_M);
        }
    }

    /// Reads encoders and gyro after a step, and reports as often as the base does.
    pub fn observe(&mut self, physics: &Physics) {
        let (_, turn_in_world) = physics.link_velocity(self.model, self.base);
        let base_from_world = physics.world_from_link(self.model, self.base).inverse();
        let rate = gyro_reading(base_from_world.transform_vector(turn_in_world).z);
        let (before_ns, before_rad) = (physics.time_ns() - physics.step_ns(), self.gyro_heading_rad);
        self.gyro_heading_rad += rate * physics.step_s();
        let mut stamp_ns = (before_ns / ODOMETRY_PERIOD_NS + 1) * ODOMETRY_PERIOD_NS;
        while stamp_ns <= physics.time_ns() {
            let heading_rad = before_rad + rate * (stamp_ns - before_ns) as f64 * 1e-9;
            let counts = self.wheels.map(|wheel| {
                let state = physics.joint_state_at(self.model, wheel.joint, stamp_ns).unwrap_or_default();
                encoder_count(wheel.sign * state.position)
            });
            self.newest = (self.newest + 1) % REPORTS_KEPT;
            self.reports[self.newest] = self.odometer.update(stamp_ns, counts, heading_rad);
            stamp_ns += ODOMETRY_PERIOD_NS;
        }
    }

    /// The newest report at or before a time between the last two steps.
    pub fn odometry_at(&self, stamp_ns: u64) -> &Odometry {
        (0..REPORTS_KEPT)
            .map(|age| &self.reports[(self.newest + REPORTS_KEPT - age) % REPORTS_KEPT])
            .find(|report| report.stamp_ns <= stamp_ns)
            .unwrap_or(&self.reports[self.newest])
    }
}

/// Radius of the first round shape of a wheel.
fn wheel_radius_m(model: &Model, wheel: LinkIndex) -> Option<f64> {
    model.links[wheel].collisions.iter().find_map(|collision| match collision.geometry {
        Geometry::Cylinder { radius, .. } | Geometry::Sphere { radius } if radius > 0.0 => Some(radius),
        _ => None,
    })
}
