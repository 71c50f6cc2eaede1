//! The commands that a robot receives: velocities, and those of a Kobuki's driver.

use crate::entities::{Entity, EntityId};
use crate::robot::{Command, Kobuki, Robot};
use crate::world::physics::Physics;
use belvedere_bridge::payload::{Message, MotorPower, ResetOdometry, VelocityCommand};
use belvedere_bridge::{Error, Kind, Node, StreamSpec, Subscriber};

/// Topic of the command that sets odometry to zero.
pub const RESET_ODOMETRY_TOPIC: &str = "/mobile_base/commands/reset_odometry";
/// Topic of the command that switches the motors on or off.
pub const MOTOR_POWER_TOPIC: &str = "/mobile_base/commands/motor_power";

/// The subscribers for one robot's commands.
pub(super) struct RobotCommands {
    id: EntityId,
    /// `None` if the robot has no base.
    velocity: Option<Subscriber>,
    base: Option<BaseCommands>,
}

/// The subscribers for a Kobuki's other commands.
struct BaseCommands {
    reset_odometry: Subscriber,
    motor_power: Subscriber,
}

impl RobotCommands {
    /// Opens the streams of a robot, in its namespace.
    pub(super) fn open(node: &Node, id: EntityId, entity: &Entity) -> Result<Self, Error> {
        let base = entity.robot.as_ref().and_then(Robot::base);
        let plugin = entity.model.base().filter(|_| base.is_some());
        let velocity = plugin.map(|plugin| StreamSpec::velocity_command(entity.topic(&plugin.command_topic)));
        let velocity = velocity.map(|spec| node.command_subscriber(&spec)).transpose()?;
        let command = |topic, kind| node.command_subscriber(&StreamSpec::command(entity.topic(topic), kind));
        let is_kobuki = base.is_some_and(|base| base.downcast_ref::<Kobuki>().is_some());
        let base = is_kobuki.then(|| -> Result<_, Error> {
            Ok(BaseCommands {
                reset_odometry: command(RESET_ODOMETRY_TOPIC, Kind::ResetOdometry)?,
                motor_power: command(MOTOR_POWER_TOPIC, Kind::MotorPower)?,
            })
        });
        Ok(Self { id, velocity, base: base.transpose()? })
    }

    /// Returns the robot.
    pub(super) fn id(&self) -> EntityId {
        self.id
    }

    /// Passes the newest command of each kind on to the robot.
    pub(super) fn apply(&mut self, robot: &mut Robot, physics: &Physics) {
        if let Some(base) = &mut self.base {
            if let Some(MotorPower { state }) = newest(&mut base.motor_power) {
                robot.set_motor_power(state != 0);
            }
            if newest::<ResetOdometry>(&mut base.reset_odometry).is_some() {
                robot.reset_odometry(physics);
            }
        }
        if let Some(VelocityCommand { linear, angular, .. }) = self.velocity.as_mut().and_then(newest) {
            let command =
                Command { linear_m_s: linear[0], lateral_m_s: linear[1], angular_rad_s: angular[2] };
            robot.command(command, physics.time_ns());
        }
    }
}

fn newest<T: Message>(commands: &mut Subscriber) -> Option<T> {
    let frame = match commands.take_newest() {
        Ok(frame) => frame?,
        Err(error) => {
            tracing::warn!(topic = commands.topic(), %error, "commands cannot be read");
            return None;
        }
    };
    frame
        .message()
        .inspect_err(|error| tracing::warn!(topic = commands.topic(), %error, "a command was refused"))
        .ok()
}
