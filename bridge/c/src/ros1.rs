//! Frames as messages of ROS 1.

use std::{
    ffi::{CString, c_char},
    ptr, slice,
};

use belvedere_bridge::{FrameHeader, FrameView, Kind, Ros, RosMessage};

use crate::status::{Failure, Status, close, give, guard, handle_arg, null, str_arg};

/// The conversion of a stream's frames to messages of ROS 1.
pub struct Ros1Message {
    message: RosMessage,
    name: CString,
    md5: CString,
    definition: CString,
    bytes: Vec<u8>,
}

/// Opens the conversion of a stream of structs. A kind may have several types of ROS, which the last word of its topic
/// distinguishes. Returns BV_STATUS_NOTHING if ROS has no type for the stream, and for images, scans and clouds.
///
/// # Safety
/// `topic` is NUL-terminated; `out` can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_ros1_open(kind: u16, topic: *const c_char, out: *mut *mut Ros1Message) -> Status {
    guard(|| {
        // SAFETY: NUL-terminated by this function's contract.
        let topic = unsafe { str_arg(topic, "topic") }?;
        let found = Kind::from_wire(kind).and_then(|kind| RosMessage::of(kind, topic));
        let Some(message) = found else { return Ok(Status::Nothing) };
        let text = |text: &str| CString::new(text).unwrap_or_default();
        let (name, md5) = (text(message.ros.name), text(message.ros.md5));
        let definition = text(&message.definition(Ros::One));
        // SAFETY: this function's contract.
        unsafe { give(out, Ros1Message { message, name, md5, definition, bytes: Vec::new() }) }
    })
}

/// Returns the type of the messages, such as "sensor_msgs/Imu".
///
/// # Safety
/// `message` is open, or NULL, for which NULL is returned.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_ros1_name(message: *const Ros1Message) -> *const c_char {
    // SAFETY: an open conversion or null by this function's contract.
    unsafe { message.as_ref() }.map_or(ptr::null(), |message| message.name.as_ptr())
}

/// Returns the MD5 sum of the type, as text.
///
/// # Safety
/// `message` is open, or NULL, for which NULL is returned.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_ros1_md5(message: *const Ros1Message) -> *const c_char {
    // SAFETY: an open conversion or null by this function's contract.
    unsafe { message.as_ref() }.map_or(ptr::null(), |message| message.md5.as_ptr())
}

/// Returns the definition of the type, followed by those of its parts.
///
/// # Safety
/// `message` is open, or NULL, for which NULL is returned.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_ros1_definition(message: *const Ros1Message) -> *const c_char {
    // SAFETY: an open conversion or null by this function's contract.
    unsafe { message.as_ref() }.map_or(ptr::null(), |message| message.definition.as_ptr())
}

/// Converts a frame: `bytes` is its serialized message of `len` bytes, valid until the next call with this conversion.
/// Returns BV_STATUS_BAD_FRAME for an invalid header, BV_STATUS_INVALID_ARGUMENT if the message cannot hold the frame.
///
/// # Safety
/// `message` is open; `header` points to a header, `payload` to `payload_len` bytes; `bytes` and `len` can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_ros1_write(
    message: *mut Ros1Message,
    header: *const FrameHeader,
    payload: *const u8,
    payload_len: usize,
    bytes: *mut *const u8,
    len: *mut usize,
) -> Status {
    guard(|| {
        // SAFETY: open by this function's contract.
        let message = unsafe { handle_arg(message, "message") }?;
        // SAFETY: a header or null by this function's contract.
        let header = unsafe { header.as_ref() }.ok_or_else(|| null("header"))?;
        if bytes.is_null() || len.is_null() || (payload.is_null() && payload_len > 0) {
            return Err(null("payload, bytes or len"));
        }
        let payload = if payload_len == 0 {
            &[]
        } else {
            // SAFETY: not null; as long as that by this function's contract.
            unsafe { slice::from_raw_parts(payload, payload_len) }
        };
        let frame = FrameView::new(header, payload).map_err(|error| Failure::bad_frame(&error))?;
        message.bytes.clear();
        message.message.write(Ros::One, &frame, &mut message.bytes).ok_or_else(|| {
            Failure::invalid_argument(format!(
                "a {} cannot hold the frame: it has other structs, a value that the type does not have, or a time \
                 beyond 2^32 s",
                message.message.ros.name
            ))
        })?;
        // SAFETY: not null; writable by this function's contract.
        unsafe {
            bytes.write(message.bytes.as_ptr());
            len.write(message.bytes.len());
        }
        Ok(Status::Ok)
    })
}

/// Closes the conversion; NULL is ignored.
///
/// # Safety
/// `message` came from bv_ros1_open and is not used afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_ros1_close(message: *mut Ros1Message) {
    // SAFETY: this function's contract.
    unsafe { close(message) };
}

#[cfg(test)]
mod tests {
    use std::ffi::CStr;

    use belvedere_bridge::{Encoding, payload::FluidPressure};

    use super::*;

    #[test]
    fn a_frame_becomes_a_message() {
        let pressure = FluidPressure { fluid_pressure: 101_325.0, variance: 4.0 };
        let payload = bytemuck::bytes_of(&pressure);
        let mut header = FrameHeader::new(Kind::FluidPressure, Encoding::Struct);
        header.payload_len = header.set_packed(1, 1) as u64;
        let (mut message, mut bytes, mut len) = (ptr::null_mut(), ptr::null(), 0);
        // SAFETY: the conversion is used between its opening and its closing; texts are NUL-terminated; pointers lead to
        // local variables, which are as long as is said.
        unsafe {
            let mut open = |kind: u16| bv_ros1_open(kind, c"pressure".as_ptr(), &raw mut message);
            assert_eq!(open(Kind::Image.to_wire()), Status::Nothing);
            assert_eq!(open(999), Status::Nothing);
            assert_eq!(open(Kind::FluidPressure.to_wire()), Status::Ok);
            assert_eq!(CStr::from_ptr(bv_ros1_name(message)), c"sensor_msgs/FluidPressure");
            assert_eq!(CStr::from_ptr(bv_ros1_md5(message)), c"804dc5cea1c5306d6a2eb80b9833befe");
            let definition = CStr::from_ptr(bv_ros1_definition(message)).to_str().unwrap();
            assert!(definition.starts_with("Header header\nfloat64 fluid_pressure\n"), "{definition}");

            let mut write = |header: *const FrameHeader, payload: &[u8]| {
                let (start, length) = (payload.as_ptr(), payload.len());
                bv_ros1_write(message, header, start, length, &raw mut bytes, &raw mut len)
            };
            assert_eq!(write(&raw const header, payload), Status::Ok);
            assert_eq!(write(&raw const header, &payload[..15]), Status::BadFrame);
            assert_eq!(write(ptr::null(), payload), Status::InvalidArgument);
            let other = FrameHeader { kind: Kind::MotorPower.to_wire(), ..header };
            assert_eq!(write(&raw const other, payload), Status::InvalidArgument);
            assert_eq!(write(&raw const header, payload), Status::Ok);
            // Header: sequence number, stamp, an empty name.
            assert_eq!(&slice::from_raw_parts(bytes, len)[16..], payload);
            bv_ros1_close(message);
        }
    }
}
