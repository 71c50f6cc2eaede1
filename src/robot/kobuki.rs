//! The Kobuki base: two driven wheels, two casters, encoders and a gyro.
//!
//! **How it is driven.** The wheels are not bodies of their own: one of 10 g would have to carry the whole base,
//! and an iterative solver cannot balance 1 : 240 — with hinged, motorised wheels the base sank 1 mm into the
//! ground and turned 9 % short at a step of 1 ms, and threw itself over at 10 ms; stiffer contacts made it worse.
//! Instead the base is one rigid body on frictionless wheels and casters, and the wheels' grip is computed here:
//! in each step the base gets the force that gives its axle the velocity that the wheels command, forward,
//! sideways (none) and in yaw, at most what friction (μ of the wheels × weight) and the motors (1 N·m each, as in
//! Kobuki's Gazebo plugin) can give, and only while wheels touch something. So it drives exactly at any step,
//! stands on a slope, is stopped by walls and pushes what is light enough, slips beyond its grip, and does nothing
//! in the air. The force goes through the centre of mass: the base does not nod when it brakes. The wheels'
//! joints turn at the commanded rate (a motor is stronger than the grip), or with the ground where the motors are
//! the weaker part; encoders count that, so a base that pushes against a wall loses its odometry as a real one does.
//!
//! Commands are followed with [`MAX_ACCELERATION_M_S2`] and [`MAX_ANGULAR_ACCELERATION_RAD_S2`], as the base's own
//! controller and the velocity smoothers in front of it do; the plugin lets the torque alone limit it.

use super::command::Command;
use super::contact::{Contact, ContactSensors};
use super::imu::{Imu, ImuReading};
use super::odometry::{ODOMETRY_PERIOD_NS, Odometer, Odometry, encoder_count, gyro_reading};
use super::transforms::base_link;
use crate::description::diagnostics::{Problem, Severity, Source};
use crate::description::model::{Collision, Geometry, JointKind, LinkIndex, Model};
use crate::world::physics::{JointIndex, ModelIndex, Physics};
use belvedere_sensors::Pose;
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
/// The wheel's radius where the model gives its wheel no shape, in m.
const DEFAULT_WHEEL_RADIUS_M: f64 = 0.035;
const WHEEL_JOINTS: [&str; 2] = ["wheel_left_joint", "wheel_right_joint"];
/// Reports within one step of physics of at most 0.1 s, both ends included, and a few before.
const REPORTS_KEPT: usize = 8;

/// What the base reports 50 times a second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Report {
    /// With the stamp of them all.
    pub odometry: Odometry,
    /// What the gyro and the accelerometer measured.
    pub imu: ImuReading,
    /// Ticks of the left and the right wheel.
    pub encoders: [u16; 2],
    /// What the bumpers, cliff sensors and wheels felt.
    pub contact: Contact,
}

/// A Kobuki in the world.
#[derive(Debug)]
pub struct Kobuki {
    model: ModelIndex,
    base: LinkIndex,
    wheels: Wheels,
    command: Command,
    command_ns: u64,
    /// What the motors are told, on its way to the command.
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

#[derive(Debug, Clone, Copy)]
struct Wheel {
    joint: JointIndex,
    link: LinkIndex,
    /// +1 if a positive turn of the joint rolls the base forward, −1 if backward.
    sign: f64,
}

impl Kobuki {
    /// Takes the base of a robot that is in `physics`, and makes its wheels slide: their grip is computed here.
    ///
    /// # Errors
    /// As [`Wheels::of`]; the robot is a passive one then.
    pub fn new(model: &Model, index: ModelIndex, physics: &mut Physics) -> Result<Self, Problem> {
        let wheels = Wheels::of(model)?;
        for wheel in &wheels.sides {
            physics.set_link_friction(index, wheel.link, 0.0);
        }
        let mut odometer = Odometer::new(wheels.radius_m);
        let mut imu = Imu::new(model, index, physics);
        let contact =
            ContactSensors::new(model, index, wheels.sides.map(|wheel| wheel.link), wheels.radius_m);
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
            wheels,
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

    /// Distance between the wheels in m.
    pub fn separation_m(&self) -> f64 {
        self.wheels.separation_m
    }

    /// Radius of the wheels in m.
    pub fn radius_m(&self) -> f64 {
        self.wheels.radius_m
    }

    /// Gives a command at a time in ns. One that is not finite means stop. Without motor power it is lost.
    pub fn command(&mut self, command: Command, stamp_ns: u64) {
        if !self.powered {
            return;
        }
        self.command = command.limited(MAX_SPEED_M_S, MAX_TURN_RAD_S, self.wheels.separation_m);
        self.command_ns = stamp_ns;
    }

    /// Turns the motors' power on or off. As the base's driver and Kobuki's plugin do it, off is a stop that no command
    /// ends: the wheels hold. On again it waits for the next command.
    pub fn set_motor_power(&mut self, on: bool) {
        if on != self.powered {
            self.powered = on;
            self.command = Command::STOP;
        }
    }

    /// Lets odometry begin at zero here and now, the heading of the IMU with it, as the base's driver does. Encoders
    /// count on.
    pub fn reset_odometry(&mut self, physics: &Physics) {
        self.gyro_heading_rad = 0.0;
        self.odometer.reset(physics.time_ns(), self.encoders_at(physics, physics.time_ns()));
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
        self.grip(physics);
    }

    /// Lets the wheels grip the ground for one step; see the head of this file.
    fn grip(&self, physics: &mut Physics) {
        let wheels = &self.wheels;
        let (step_s, command) = (physics.step_s(), self.followed);
        let world_from_base = physics.world_from_link(self.model, self.base);
        let [base_ahead, base_up] = [DVec3::X, DVec3::Z].map(|axis| world_from_base.transform_vector(axis));
        // The ground's own axes: gravity has no part along a level floor, however the base leans on its casters.
        let mut normals = DVec3::ZERO;
        let mut touching = 0.0;
        for wheel in &wheels.sides {
            if let Some(normal) = physics.ground_normal(self.model, wheel.link, base_up) {
                normals += normal;
                touching += 1.0;
            }
        }
        let up = normals.try_normalize().unwrap_or(base_up);
        let ahead = base_ahead.reject_from_normalized(up).normalize_or(base_ahead);
        let left = up.cross(ahead);
        let Some((mass_kg, centre, inertia)) = physics.body_mass(self.model, self.base, up) else { return };
        // What one wheel can take: half of the weight rests on it.
        let gravity = physics.gravity();
        let friction_n = wheels.friction * 0.5 * mass_kg * (-gravity.dot(up)).max(0.0);
        let motor_n = WHEEL_TORQUE_N_M / wheels.radius_m;

        // The force and torque that would give the base the commanded motion within this step, at its centre of
        // mass and about it, its weight held.
        let axle = world_from_base.transform_point(wheels.axle);
        let (origin_m_s, turn) = physics.link_velocity(self.model, self.base);
        let velocity = |point: DVec3| origin_m_s + turn.cross(point - world_from_base.translation());
        let wanted = ahead * command.linear_m_s + (up * command.angular_rad_s).cross(centre - axle);
        let force = ((wanted - velocity(centre)) / step_s - gravity) * mass_kg;
        let torque = (command.angular_rad_s - turn.dot(up)) / step_s * inertia;

        // Forward the motors push, sideways the tyres hold.
        let grip_n = friction_n * touching;
        let push_n = motor_n.min(friction_n) * touching;
        let forward_n = force.dot(ahead).clamp(-push_n, push_n);
        let sideways_n = force.dot(left).clamp(-grip_n, grip_n);
        let most_n_m = 0.5 * wheels.separation_m * push_n;
        let torque_n_m = torque.clamp(-most_n_m, most_n_m);
        physics.push(self.model, self.base, ahead * forward_n + left * sideways_n, up * torque_n_m);

        for (wheel, side) in wheels.sides.iter().zip([-0.5, 0.5]) {
            let arm_m = side * wheels.separation_m;
            let force_n = 0.5 * forward_n + torque_n_m / (2.0 * arm_m);
            let commanded_m_s = command.linear_m_s + arm_m * command.angular_rad_s;
            let stalled = touching > 0.0 && motor_n < friction_n && force_n.abs() >= 0.999 * motor_n;
            let rim_m_s = if stalled { velocity(axle + left * arm_m).dot(ahead) } else { commanded_m_s };
            let (rate, effort) = (rim_m_s / wheels.radius_m, force_n * wheels.radius_m);
            physics.roll_joint(self.model, wheel.joint, wheel.sign * rate, wheel.sign * effort);
        }
    }

    /// Notices that the base was moved by hand from where it was: what changed by that was no motion.
    pub fn carried(&mut self, physics: &Physics, world_from_before: &Pose) {
        let moved = physics.world_from_link(self.model, self.base) * world_from_before.inverse();
        self.imu.carried(physics, &moved);
    }

    /// Reads the sensors after a step, and reports as often as the base does.
    pub fn observe(&mut self, physics: &Physics) {
        self.contact.notice(physics);
        let (_, turn_in_world) = physics.link_velocity(self.model, self.base);
        let base_from_world = physics.world_from_link(self.model, self.base).inverse();
        let rate = gyro_reading(base_from_world.transform_vector(turn_in_world).z);
        let (before_ns, before_rad) = (physics.time_ns() - physics.step_ns(), self.gyro_heading_rad);
        self.gyro_heading_rad += rate * physics.step_s();
        let mut stamp_ns = (before_ns / ODOMETRY_PERIOD_NS + 1) * ODOMETRY_PERIOD_NS;
        // Where one step takes in several reports, they all feel what there is at its end.
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

    /// The counts of the left and the right encoder at a time between the last two steps.
    fn encoders_at(&self, physics: &Physics, stamp_ns: u64) -> [u16; 2] {
        self.wheels.sides.map(|wheel| {
            let state = physics.joint_state_at(self.model, wheel.joint, stamp_ns).unwrap_or_default();
            encoder_count(wheel.sign * state.position)
        })
    }

    /// The newest odometry at or before a time between the last two steps.
    pub fn odometry_at(&self, stamp_ns: u64) -> &Odometry {
        &self.report_at(stamp_ns).odometry
    }

    /// The newest report at or before a time between the last two steps.
    pub fn report_at(&self, stamp_ns: u64) -> &Report {
        (0..REPORTS_KEPT)
            .map(|age| &self.reports[(self.newest + REPORTS_KEPT - age) % REPORTS_KEPT])
            .find(|report| report.odometry.stamp_ns <= stamp_ns)
            .unwrap_or(&self.reports[self.newest])
    }
}

/// The wheels of a Kobuki, as a model has them.
#[derive(Debug, Clone, Copy)]
pub struct Wheels {
    /// Left and right.
    sides: [Wheel; 2],
    separation_m: f64,
    radius_m: f64,
    friction: f64,
    /// The point between the wheels in the base's frame.
    axle: DVec3,
}

impl Wheels {
    /// Finds the wheels in a model: `wheel_left_joint` and `wheel_right_joint`.
    ///
    /// # Errors
    /// If the model has no such wheels: a note if there are none, a warning if there are joints of these names
    /// that cannot drive.
    pub fn of(model: &Model) -> Result<Self, Problem> {
        let problem = |severity, source: &Source, what: String, remedy: &str| Problem {
            severity,
            source: source.clone(),
            what: format!("robot '{}' cannot drive: {what}", model.name),
            remedy: remedy.into(),
        };
        let rest = model.rest_poses();
        let base_from_model = rest.get(base_link(model)).copied().unwrap_or_default().inverse();
        let mut centres = [DVec3::ZERO; 2];
        let mut wheels = [Wheel { joint: 0, link: 0, sign: 1.0 }; 2];
        for (side, name) in WHEEL_JOINTS.into_iter().enumerate() {
            let number = model.joints.iter().position(|joint| joint.name == name).ok_or_else(|| {
                problem(
                    Severity::Note,
                    &model.source,
                    format!("it has no joint '{name}'"),
                    "give it the wheels of a Kobuki, wheel_left_joint and wheel_right_joint, if it is to drive",
                )
            })?;
            let joint = &model.joints[number];
            let base_from_wheel = base_from_model * rest[joint.child];
            let across = base_from_wheel.transform_vector(joint.axis).y;
            if joint.kind != JointKind::Continuous || across.abs() < 0.99 {
                return Err(problem(
                    Severity::Warning,
                    &joint.source,
                    format!("joint '{name}' does not turn about the base's y axis"),
                    "make it continuous, with its axis across the base",
                ));
            }
            centres[side] = base_from_wheel.translation();
            wheels[side] = Wheel { joint: number, link: joint.child, sign: across.signum() };
        }
        let separation_m = centres[0].y - centres[1].y;
        if separation_m < 0.01 {
            return Err(problem(
                Severity::Warning,
                &model.source,
                format!("its left wheel is {separation_m} m to the left of its right one"),
                "put them on their sides of the base, for a Kobuki at y = 0.115 and -0.115",
            ));
        }
        let shapes = &model.links[wheels[0].link].collisions;
        let axis = model.joints[wheels[0].joint].axis;
        let radius_m =
            shapes.iter().find_map(|shape| radius_about(axis, shape)).filter(|radius| *radius > 0.0);
        Ok(Self {
            sides: wheels,
            separation_m,
            radius_m: radius_m.unwrap_or(DEFAULT_WHEEL_RADIUS_M),
            friction: shapes.iter().find_map(|shape| shape.friction).unwrap_or(1.0).max(0.0),
            axle: (centres[0] + centres[1]) * 0.5,
        })
    }

    /// The joints of the left and the right wheel.
    pub fn joints(&self) -> [JointIndex; 2] {
        self.sides.map(|wheel| wheel.joint)
    }
}

/// How far the shape of a wheel reaches from the wheel's axis; none for a shape that is no wheel.
fn radius_about(axis: DVec3, shape: &Collision) -> Option<f64> {
    match &shape.geometry {
        Geometry::Cylinder { radius, .. } | Geometry::Sphere { radius } => Some(*radius),
        Geometry::Mesh(mesh) => mesh
            .positions
            .iter()
            .map(|point| shape.link_from_collision.transform_point(DVec3::from(point.map(f64::from))))
            .map(|point| point.reject_from_normalized(axis).length())
            .filter(|radius| radius.is_finite())
            .reduce(f64::max),
        _ => None,
    }
}
