//! A received frame.

use belvedere_bridge::FrameHeader;

use crate::status::{close, guard_value};

/// A frame where it lies in shared memory; unchanged until it is released. Its header was checked: rows and structs
/// lie within the payload.
pub struct Frame(pub(crate) belvedere_bridge::Frame);

/// Its header.
///
/// # Safety
/// `frame` is held or NULL (then NULL is given).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_frame_get_header(frame: *const Frame) -> *const FrameHeader {
    // SAFETY: a held frame or null by this function's contract.
    let frame = unsafe { frame.as_ref() };
    frame.map_or(std::ptr::null(), |frame| std::ptr::from_ref(frame.0.header()))
}

/// Its payload of payload_len bytes, aligned to 64.
///
/// # Safety
/// `frame` is held or NULL (then NULL is given).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_frame_get_payload(frame: *const Frame) -> *const u8 {
    // SAFETY: a held frame or null by this function's contract.
    let frame = unsafe { frame.as_ref() };
    frame.map_or(std::ptr::null(), |frame| frame.0.payload().as_ptr())
}

/// Frames that were sent between the last one taken and this one.
///
/// # Safety
/// `frame` is held or NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_frame_missed(frame: *const Frame) -> u64 {
    // SAFETY: a held frame or null by this function's contract.
    unsafe { frame.as_ref() }.map_or(0, |frame| frame.0.missed())
}

/// Whether it comes from another publisher life than the one before: the simulator was started again.
///
/// # Safety
/// `frame` is held or NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_frame_restarted(frame: *const Frame) -> bool {
    // SAFETY: a held frame or null by this function's contract.
    unsafe { frame.as_ref() }.is_some_and(|frame| frame.0.restarted())
}

/// Whether it was sent before this subscriber was connected, and kept for it: its age says nothing then.
///
/// # Safety
/// `frame` is held or NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_frame_is_from_history(frame: *const Frame) -> bool {
    // SAFETY: a held frame or null by this function's contract.
    unsafe { frame.as_ref() }.is_some_and(|frame| frame.0.is_from_history())
}

/// Nanoseconds since it was sent.
///
/// # Safety
/// `frame` is held or NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_frame_age_ns(frame: *const Frame) -> u64 {
    // SAFETY: a held frame or null by this function's contract.
    unsafe { frame.as_ref() }.map_or(0, |frame| guard_value(0, || frame.0.age_ns()))
}

/// Releases it; NULL is ignored.
///
/// # Safety
/// `frame` came from a take, and neither it nor its header and payload are used afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_frame_release(frame: *mut Frame) {
    // SAFETY: this function's contract.
    unsafe { close(frame) };
}
