//! A received frame.

use belvedere_bridge::FrameHeader;

use crate::status::{close, guard_value};

/// A received frame in shared memory, which does not change until it is released. Its header has been checked: rows and
/// structs lie within the payload.
pub struct Frame(pub(crate) belvedere_bridge::Frame);

/// Returns the header of a frame.
///
/// # Safety
/// `frame` is held, or NULL, for which NULL is returned.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_frame_get_header(frame: *const Frame) -> *const FrameHeader {
    // SAFETY: a held frame or null by this function's contract.
    let frame = unsafe { frame.as_ref() };
    frame.map_or(std::ptr::null(), |frame| std::ptr::from_ref(frame.0.header()))
}

/// Returns the payload of a frame: payload_len bytes, aligned to 64.
///
/// # Safety
/// `frame` is held, or NULL, for which NULL is returned.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_frame_get_payload(frame: *const Frame) -> *const u8 {
    // SAFETY: a held frame or null by this function's contract.
    let frame = unsafe { frame.as_ref() };
    frame.map_or(std::ptr::null(), |frame| frame.0.payload().as_ptr())
}

/// Returns the number of frames that were sent between the previously taken frame and this one.
///
/// # Safety
/// `frame` is held or NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_frame_missed(frame: *const Frame) -> u64 {
    // SAFETY: a held frame or null by this function's contract.
    unsafe { frame.as_ref() }.map_or(0, |frame| frame.0.missed())
}

/// Returns true if the frame comes from another life of the publisher than the previous one: the simulator was
/// restarted.
///
/// # Safety
/// `frame` is held or NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_frame_restarted(frame: *const Frame) -> bool {
    // SAFETY: a held frame or null by this function's contract.
    unsafe { frame.as_ref() }.is_some_and(|frame| frame.0.restarted())
}

/// Returns true if the frame was sent before this subscriber connected, and was kept for it: its age then does not show
/// the latency.
///
/// # Safety
/// `frame` is held or NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_frame_is_from_history(frame: *const Frame) -> bool {
    // SAFETY: a held frame or null by this function's contract.
    unsafe { frame.as_ref() }.is_some_and(|frame| frame.0.is_from_history())
}

/// Returns the nanoseconds since the frame was sent.
///
/// # Safety
/// `frame` is held or NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_frame_age_ns(frame: *const Frame) -> u64 {
    // SAFETY: a held frame or null by this function's contract.
    unsafe { frame.as_ref() }.map_or(0, |frame| guard_value(0, || frame.0.age_ns()))
}

/// Releases the frame; NULL is ignored.
///
/// # Safety
/// `frame` came from a take; it, its header and its payload are not used afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_frame_release(frame: *mut Frame) {
    // SAFETY: this function's contract.
    unsafe { close(frame) };
}
