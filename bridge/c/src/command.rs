//! Commands to the robot. Velocity commands also have functions of their own, which are older.

use std::ffi::{c_char, c_void};

use belvedere_bridge::{
    Kind, Publisher, StreamSpec,
    payload::{self, Message, VelocityCommand},
};

use crate::{
    node::Node,
    status::{Failure, Status, close, give, guard, handle_arg, null, str_arg},
};

/// The sending end of a stream of commands to the robot.
pub struct CommandPublisher {
    publisher: Publisher,
    send: SendBytes,
}

/// A function that sends the bytes of one command.
type SendBytes = fn(&Publisher, &[u8]) -> Result<(), Failure>;

impl CommandPublisher {
    fn open(node: &Node, topic: &str, kind: u16) -> Result<Self, Failure> {
        let kind = Kind::from_wire(kind);
        let (kind, send): (_, SendBytes) = match kind {
            Some(kind @ Kind::VelocityCommand) => (kind, send::<payload::VelocityCommand>),
            Some(kind @ Kind::ResetOdometry) => (kind, send::<payload::ResetOdometry>),
            Some(kind @ Kind::MotorPower) => (kind, send::<payload::MotorPower>),
            _ => {
                return Err(Failure::invalid_argument(
                    "kind must be that of a command to a robot: BV_KIND_VELOCITY_COMMAND, \
                     BV_KIND_RESET_ODOMETRY or BV_KIND_MOTOR_POWER"
                        .to_owned(),
                ));
            }
        };
        Ok(Self { publisher: node.0.publisher(&StreamSpec::command(topic, kind))?, send })
    }

    fn send(&self, command: &[u8]) -> Result<Status, Failure> {
        (self.send)(&self.publisher, command)?;
        Ok(Status::Ok)
    }
}

fn send<T: Message>(publisher: &Publisher, bytes: &[u8]) -> Result<(), Failure> {
    let command: T = bytemuck::try_pod_read_unaligned(bytes).map_err(|_| {
        let (given, right) = (bytes.len(), size_of::<T>());
        Failure::invalid_argument(format!(
            "size is {given}, but a command of {} has {right} bytes",
            publisher.topic()
        ))
    })?;
    publisher.send_structs(0, &[command])?;
    Ok(())
}

/// Opens a stream of commands of one bv_kind for sending; several processes may. The topics of a TurtleBot are
/// "cmd_vel" for BV_KIND_VELOCITY_COMMAND, "mobile_base/commands/reset_odometry" for BV_KIND_RESET_ODOMETRY and
/// "mobile_base/commands/motor_power" for BV_KIND_MOTOR_POWER.
///
/// # Safety
/// `node` is open; `topic` is NUL-terminated; `out` can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_command_open(
    node: *mut Node,
    topic: *const c_char,
    kind: u16,
    out: *mut *mut CommandPublisher,
) -> Status {
    guard(|| {
        // SAFETY: an open node and a NUL-terminated text by this function's contract.
        let (node, topic) = unsafe { (handle_arg(node, "node")?, str_arg(topic, "topic")?) };
        // SAFETY: `out` can be written by this function's contract.
        unsafe { give(out, CommandPublisher::open(node, topic, kind)?) }
    })
}

/// Sends a command: the struct of the publisher's kind, and its size. The robot uses the newest command that has
/// arrived since its last step.
///
/// # Safety
/// `publisher` is open; `size` bytes of `command` can be read.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_command_send(
    publisher: *mut CommandPublisher,
    command: *const c_void,
    size: usize,
) -> Status {
    guard(|| {
        // SAFETY: an open publisher by this function's contract.
        let publisher = unsafe { handle_arg(publisher, "publisher") }?;
        if command.is_null() {
            return Err(null("command"));
        }
        // SAFETY: not null; so many bytes are readable by this function's contract.
        let bytes = unsafe { std::slice::from_raw_parts(command.cast::<u8>(), size) };
        publisher.send(bytes)
    })
}

/// Closes the publisher; NULL is ignored. If the receiver has not polled since the publisher was opened, it misses its
/// commands: give the robot one or two steps of simulation before closing.
///
/// # Safety
/// `publisher` came from bv_command_open and is not used afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_command_close(publisher: *mut CommandPublisher) {
    // SAFETY: this function's contract.
    unsafe { close(publisher) };
}

/// The sending end of a velocity command stream.
pub struct VelocityPublisher(CommandPublisher);

/// Opens a velocity command stream ("cmd_vel") for sending; several processes may. Equivalent to bv_command_open with
/// BV_KIND_VELOCITY_COMMAND.
///
/// # Safety
/// `node` is open; `topic` is NUL-terminated; `out` can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_velocity_open(
    node: *mut Node,
    topic: *const c_char,
    out: *mut *mut VelocityPublisher,
) -> Status {
    guard(|| {
        // SAFETY: an open node and a NUL-terminated text by this function's contract.
        let (node, topic) = unsafe { (handle_arg(node, "node")?, str_arg(topic, "topic")?) };
        let publisher = CommandPublisher::open(node, topic, Kind::VelocityCommand.to_wire())?;
        // SAFETY: `out` can be written by this function's contract.
        unsafe { give(out, VelocityPublisher(publisher)) }
    })
}

/// Sends a velocity command. The robot stops if no command arrives within its timeout.
///
/// # Safety
/// `publisher` is open; `command` can be read.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_velocity_send(
    publisher: *mut VelocityPublisher,
    command: *const VelocityCommand,
) -> Status {
    guard(|| {
        // SAFETY: an open publisher by this function's contract.
        let VelocityPublisher(publisher) = unsafe { handle_arg(publisher, "publisher") }?;
        // SAFETY: readable or null by this function's contract.
        let command = unsafe { command.as_ref() }.ok_or_else(|| null("command"))?;
        publisher.send(bytemuck::bytes_of(command))
    })
}

/// Closes the publisher; NULL is ignored. See bv_command_close.
///
/// # Safety
/// `publisher` came from bv_velocity_open and is not used afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_velocity_close(publisher: *mut VelocityPublisher) {
    // SAFETY: this function's contract.
    unsafe { close(publisher) };
}
