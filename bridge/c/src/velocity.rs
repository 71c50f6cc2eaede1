//! Commands to the robot.

use std::ffi::c_char;

use belvedere_bridge::{Publisher, StreamSpec, payload};

use crate::{
    layout::VelocityCommand,
    node::Node,
    status::{Status, close, give, guard, handle_arg, null, str_arg},
};

/// The sending end of a velocity command stream.
pub struct VelocityPublisher(Publisher);

/// Opens a velocity command stream ("cmd_vel") for sending; several processes may.
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
        let publisher = VelocityPublisher(node.0.publisher(&StreamSpec::velocity_command(topic))?);
        // SAFETY: `out` can be written by this function's contract.
        unsafe { give(out, publisher) }
    })
}

/// Sends a command; the robot stops when none comes for its time-out.
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
        let publisher = unsafe { handle_arg(publisher, "publisher") }?;
        // SAFETY: readable or null by this function's contract.
        let command = unsafe { command.as_ref() }.ok_or_else(|| null("command"))?;
        let command = payload::VelocityCommand { linear: command.linear, angular: command.angular };
        publisher.0.send_structs(0, &[command])?;
        Ok(Status::Ok)
    })
}

/// Closes it; NULL is ignored. A receiver that has not looked since this was opened misses what was sent: leave the
/// robot a step or two of its simulation.
///
/// # Safety
/// `publisher` came from bv_velocity_open and is not used afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_velocity_close(publisher: *mut VelocityPublisher) {
    // SAFETY: this function's contract.
    unsafe { close(publisher) };
}
