//! Commands to a simulator.

use std::{ffi::c_char, time::Duration};

use belvedere_bridge::{
    Operation, SimulationControl,
    payload::{SimulationCommand, SimulationResult},
};

use crate::{
    node::Node,
    status::{Status, close, give, guard, handle_arg, null, str_arg},
};

/// The commanding end of a simulation.
pub struct Control(SimulationControl);

/// Gets ready to control the simulation of a domain, whether it runs already or not.
///
/// # Safety
/// `node` is open; `out` can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_control_open(node: *mut Node, out: *mut *mut Control) -> Status {
    guard(|| {
        // SAFETY: an open node by this function's contract.
        let node = unsafe { handle_arg(node, "node") }?;
        let control = Control(SimulationControl::open(&node.0)?);
        // SAFETY: `out` can be written by this function's contract.
        unsafe { give(out, control) }
    })
}

/// Sends a command, with a text (NULL: none), and waits for its result; 1 when none came in time, or the simulator
/// ended. An id of 0 is replaced by one that no other has; text_len is that of the text. A command that was refused is
/// a success of this function: look at result->done.
///
/// # Safety
/// `control` is open; `command` can be read; `text` is NUL-terminated or NULL; `result` can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_control_call(
    control: *mut Control,
    command: *const SimulationCommand,
    text: *const c_char,
    timeout_ms: u32,
    result: *mut SimulationResult,
) -> Status {
    guard(|| {
        // SAFETY: an open handle by this function's contract.
        let control = unsafe { handle_arg(control, "control") }?;
        // SAFETY: readable or null by this function's contract.
        let command = unsafe { command.as_ref() }.ok_or_else(|| null("command"))?;
        // SAFETY: a NUL-terminated text by this function's contract.
        let text = if text.is_null() { "" } else { unsafe { str_arg(text, "text") }? };
        if result.is_null() {
            return Err(null("result"));
        }
        let timeout = Duration::from_millis(timeout_ms.into());
        let Some(answer) = control.0.call(&with_id(command), text, timeout)? else {
            return Ok(Status::Nothing);
        };
        // SAFETY: it can be written by this function's contract.
        unsafe { result.write(answer) };
        Ok(Status::Ok)
    })
}

/// Whether there is a simulator that listens now; never sleeps.
///
/// # Safety
/// `control` is open; `connected` can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_control_is_connected(control: *mut Control, connected: *mut bool) -> Status {
    guard(|| {
        // SAFETY: an open handle by this function's contract.
        let control = unsafe { handle_arg(control, "control") }?;
        if connected.is_null() {
            return Err(null("connected"));
        }
        let answer = control.0.is_connected()?;
        // SAFETY: it can be written by this function's contract.
        unsafe { connected.write(answer) };
        Ok(Status::Ok)
    })
}

/// When the last result was sent, on the clock of bv_mono_ns; 0 before the first. Frames with a later publish_mono_ns
/// show what the command has changed.
///
/// # Safety
/// `control` is open or NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_control_answered_ns(control: *const Control) -> u64 {
    // SAFETY: an open handle, or null, by this function's contract.
    unsafe { control.as_ref() }.map_or(0, |control| control.0.answered_ns())
}

/// Closes it; NULL is ignored.
///
/// # Safety
/// `control` came from bv_control_open and is not used afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_control_close(control: *mut Control) {
    // SAFETY: this function's contract.
    unsafe { close(control) };
}

/// What is sent: the command with an id, and nothing of which the rest is made here.
fn with_id(command: &SimulationCommand) -> SimulationCommand {
    let fresh = SimulationCommand::new(Operation::Pause);
    let id = if command.id == 0 { fresh.id } else { command.id };
    SimulationCommand { id, reserved: fresh.reserved, text_len: fresh.text_len, ..*command }
}
