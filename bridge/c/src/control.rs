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

/// The client side of simulation control.
pub struct Control(SimulationControl);

/// Opens the control streams of a domain. The simulator may start later.
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

/// Sends a command, with a text (NULL for none), and waits for its result. Returns BV_STATUS_NOTHING if no result
/// arrives in time or the simulator ends. An id of 0 is replaced by a unique one; text_len is set from the text. A
/// refused command is a success of this function: check result->done.
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

/// Writes true if a simulator is listening now; never sleeps.
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

/// Returns when the last result was sent, on the clock of bv_mono_ns; 0 before the first. Frames with a later
/// publish_mono_ns show the effect of the command.
///
/// # Safety
/// `control` is open or NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_control_answered_ns(control: *const Control) -> u64 {
    // SAFETY: an open handle, or null, by this function's contract.
    unsafe { control.as_ref() }.map_or(0, |control| control.0.answered_ns())
}

/// Closes the control; NULL is ignored.
///
/// # Safety
/// `control` came from bv_control_open and is not used afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_control_close(control: *mut Control) {
    // SAFETY: this function's contract.
    unsafe { close(control) };
}

/// Fills in an id if it is 0, and clears the fields that the library sets itself.
fn with_id(command: &SimulationCommand) -> SimulationCommand {
    let fresh = SimulationCommand::new(Operation::Pause);
    let id = if command.id == 0 { fresh.id } else { command.id };
    SimulationCommand { id, reserved: fresh.reserved, text_len: fresh.text_len, ..*command }
}
