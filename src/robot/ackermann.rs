//! Cars: the rear wheels drive, the front wheels steer.
//!
//! The middle of the rear axle moves along the car, and the car turns about a point on the line of the rear axle. The
//! lines of both steered wheels, each at its own angle, meet in that point (Ackermann's condition).

use super::base::Base;
use super::command::Command;
use super::grip::Axle;
use super::odometry::Odometry;
use super::tracker::Tracker;
use super::transforms::base_link;
use crate::description::diagnostics::{Problem, Severity};
use crate::description::model::{AckermannDrive, BasePlugin, JointIndex, LinkIndex, Model, OdometryOrigin};
use crate::world::physics::{ModelIndex, Physics};
use glam::DVec3;

/// The steering of a car.
#[derive(Debug, Clone)]
pub(super) struct Steering {
    rear: Axle,
    front: Option<Axle>,
    /// A steering joint; +1 if a positive angle turns it to the left, −1 if to the right; its distance to the left of
    /// the middle, in m.
    joints: [(JointIndex, f64, f64); 2],
    wheel_base_m: f64,
}

impl Steering {
    /// Finds the steering in a model.
    ///
    /// # Errors
    /// A warning if the car cannot drive.
    pub(super) fn of(model: &Model, plugin: &BasePlugin, drive: &AckermannDrive) -> Result<Self, Problem> {
        let mut rear = Axle::of(model, plugin, &drive.rear)?;
        let front = drive.front.as_ref().map(|wheels| Axle::of(model, plugin, wheels)).transpose()?;
        let problem = |what: String, remedy: &str| Problem {
            severity: Severity::Warning,
            source: plugin.source.clone(),
            what: format!("robot '{}' cannot drive: {what}", model.name),
            remedy: remedy.into(),
        };
        let rest = model.rest_poses();
        let base_from_model = rest.get(base_link(model)).copied().unwrap_or_default().inverse();
        let mut joints = [(0, 1.0, 0.0); 2];
        let mut ahead_m = 0.0;
        for (place, number) in joints.iter_mut().zip(drive.steering) {
            let joint = &model.joints[number];
            let base_from_steered = base_from_model * rest[joint.child];
            let up = base_from_steered.transform_vector(joint.axis).z;
            if up.abs() < 0.9 {
                return Err(problem(
                    format!("the joint '{}' does not steer: its axis is not upright", joint.name),
                    "turn its axis to z",
                ));
            }
            let at = base_from_steered.transform_point(joint.pivot) - rear.centre;
            *place = (number, up.signum(), at.y);
            ahead_m += 0.5 * at.x;
        }
        let wheel_base_m = drive.wheel_base_m.unwrap_or(ahead_m);
        if wheel_base_m.is_nan() || wheel_base_m < 0.01 {
            return Err(problem(
                format!("its steered wheels are {wheel_base_m} m in front of its rear ones"),
                "put them at a greater x",
            ));
        }
        // The front wheels hold the car's heading.
        rear.yaw_arm_m = wheel_base_m;
        Ok(Self { rear, front, joints, wheel_base_m })
    }
}

/// A car.
#[derive(Debug)]
pub(super) struct Ackermann {
    model: ModelIndex,
    base: LinkIndex,
    steering: Steering,
    drive: AckermannDrive,
    timeout_ns: u64,
    command: Command,
    command_ns: u64,
    /// The mean steering angle.
    angle_rad: f64,
    tracker: Tracker,
}

impl Ackermann {
    pub(super) fn new(
        model: &Model,
        plugin: &BasePlugin,
        drive: &AckermannDrive,
        index: ModelIndex,
        physics: &mut Physics,
    ) -> Result<Self, Problem> {
        let steering = Steering::of(model, plugin, drive)?;
        steering.rear.release(physics, index);
        if let Some(front) = &steering.front {
            front.release(physics, index);
        }
        let rear = &steering.rear;
        let radius_m = drive.rear.radius_m.unwrap_or(rear.radius_m);
        let tracker = match plugin.odometry.origin {
            OdometryOrigin::World => Tracker::of_truth(index, &plugin.odometry),
            OdometryOrigin::Encoders => {
                Tracker::of_axle(index, &plugin.odometry, rear, radius_m, rear.separation_m)
            }
        };
        Ok(Self {
            model: index,
            base: base_link(model),
            drive: drive.clone(),
            timeout_ns: plugin.command_timeout_s.map_or(u64::MAX, |time_s| (time_s * 1e9) as u64),
            command: Command::STOP,
            command_ns: 0,
            angle_rad: 0.0,
            tracker,
            steering,
        })
    }

    /// Returns the mean steering angle for a command.
    fn wanted_angle_rad(&self, command: Command) -> f64 {
        let limit = self.drive.steering_limit_rad;
        let angle = if self.drive.is_told_angle {
            // As in Gazebo's plugin, the sign is that of the turn, so in reverse the wheels steer the other way.
            command.angular_rad_s * 1.0_f64.copysign(command.linear_m_s)
        } else if command.linear_m_s == 0.0 {
            // A car does not turn on the spot.
            0.0
        } else {
            libm::atan(self.steering.wheel_base_m * command.angular_rad_s / command.linear_m_s)
        };
        angle.clamp(-limit, limit)
    }
}

impl Base for Ackermann {
    fn command(&mut self, command: Command, stamp_ns: u64) {
        (self.command, self.command_ns) = (command.or_stop(), stamp_ns);
    }

    fn control(&mut self, physics: &mut Physics) {
        let expired = physics.time_ns().saturating_sub(self.command_ns) >= self.timeout_ns;
        let command = if expired { Command::STOP } else { self.command };
        let step_s = physics.step_s();
        let error_rad = self.wanted_angle_rad(command) - self.angle_rad;
        self.angle_rad += error_rad * (self.drive.steering_gain * step_s).min(1.0);
        let speed_m_s = command.linear_m_s.clamp(-self.drive.max_speed_m_s, self.drive.max_speed_m_s);
        let Steering { rear, front, joints, wheel_base_m } = &self.steering;
        let curvature = libm::tan(self.angle_rad) / wheel_base_m;
        let turn_rad_s = speed_m_s * curvature;
        let rims = [-0.5, 0.5].map(|side| speed_m_s + side * rear.separation_m * turn_rad_s);
        rear.grip(physics, self.model, self.base, Command::new(speed_m_s, turn_rad_s), rims);
        // A wheel's line goes through the point that the car turns about, even if that is between the wheels.
        let steered_rad = |left_m: f64| libm::atan2(wheel_base_m * curvature, 1.0 - left_m * curvature);
        for (joint, sign, left_m) in *joints {
            let wanted_rad = steered_rad(left_m);
            let now_rad = physics.joint_state(self.model, joint).unwrap_or_default().position;
            physics.roll_joint(self.model, joint, (sign * wanted_rad - now_rad) / step_s, 0.0);
        }
        let world_from_base = physics.world_from_link(self.model, self.base);
        let (origin_m_s, turn) = physics.link_velocity(self.model, self.base);
        for wheel in front.iter().flat_map(|front| &front.wheels) {
            // A steered wheel rolls with the ground.
            let world_from_wheel = physics.world_from_link(self.model, wheel.link);
            let arm = world_from_wheel.translation() - world_from_base.translation();
            let velocity = origin_m_s + turn.cross(arm);
            let left_m = [0.5, -0.5][wheel.side] * front.as_ref().map_or(0.0, |front| front.separation_m);
            let angle_rad = steered_rad(left_m);
            let (sin, cos) = libm::sincos(angle_rad);
            let along = world_from_base.transform_vector(DVec3::new(cos, sin, 0.0));
            let radius_m = front.as_ref().map_or(1.0, |front| front.radius_m);
            let rate = wheel.sign * velocity.dot(along) / radius_m;
            physics.roll_joint(self.model, wheel.joint, rate, 0.0);
        }
    }

    fn observe(&mut self, physics: &Physics) {
        self.tracker.observe(physics);
    }

    fn odometry_at(&self, physics: &Physics, stamp_ns: u64) -> Odometry {
        self.tracker.odometry_at(physics, stamp_ns)
    }

    fn reset_odometry(&mut self, physics: &Physics) {
        self.tracker.reset(physics);
    }
}
