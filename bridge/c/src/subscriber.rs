//! Subscribing to a stream.

use std::{
    ffi::{c_char, c_int},
    os::fd::AsRawFd as _,
    time::Duration,
};

use crate::{
    frame::Frame,
    node::Node,
    status::{Failure, Status, close, give, guard, guard_value, handle_arg, str_arg},
};

/// The reading end of a stream. It may exist before its publisher and after it.
pub struct Subscriber(belvedere_bridge::Subscriber);

/// Subscribes to a stream, which may be created later. A leading slash of the topic is ignored. If the publisher ends
/// or is killed, and starts again, the subscriber continues with the new one.
///
/// # Safety
/// `node` is open; `topic` is NUL-terminated; `out` can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_subscribe(
    node: *mut Node,
    topic: *const c_char,
    out: *mut *mut Subscriber,
) -> Status {
    guard(|| {
        // SAFETY: an open node and a NUL-terminated text by this function's contract.
        let (node, topic) = unsafe { (handle_arg(node, "node")?, str_arg(topic, "topic")?) };
        let subscriber = Subscriber(node.0.subscriber(topic)?);
        // SAFETY: `out` can be written by this function's contract.
        unsafe { give(out, subscriber) }
    })
}

/// Closes the subscription; NULL is ignored. Frames that are held remain valid.
///
/// # Safety
/// `subscriber` came from bv_subscribe and is not used afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_subscriber_close(subscriber: *mut Subscriber) {
    // SAFETY: this function's contract.
    unsafe { close(subscriber) };
}

/// Sleeps until a frame is available. Returns BV_STATUS_OK, or BV_STATUS_NOTHING if the timeout passes, or a signal
/// arrives, without one.
///
/// # Safety
/// `subscriber` is open.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_subscriber_wait(subscriber: *mut Subscriber, timeout_ms: u32) -> Status {
    guard(|| {
        // SAFETY: an open subscriber by this function's contract.
        let subscriber = unsafe { handle_arg(subscriber, "subscriber") }?;
        let ready = subscriber.0.wait(Duration::from_millis(timeout_ms.into()))?;
        Ok(if ready { Status::Ok } else { Status::Nothing })
    })
}

/// Enables busy polling: when a frame is due, the subscriber polls for it without sleeping, for at most `limit_us` per
/// frame. 0, the default, disables it.
///
/// The system takes 30 to 100 us to wake a process, which is most of the latency of a frame. With busy polling, a
/// process that sleeps in bv_subscriber_wait, or calls bv_subscriber_take in a loop that polls bv_subscriber_fd, begins
/// to poll shortly before the next frame of a periodic stream is due, as predicted from the previous send times. It has
/// the frame a few microseconds after it was sent. Frames that arrive much earlier or later, or without a period, wake
/// the process as usual.
///
/// The cost is processor time for each frame: three mean deviations of the send times, at least 0.15 ms and at most
/// half of `limit_us`. On a single core it does nothing.
///
/// # Safety
/// `subscriber` is open.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_subscriber_set_busy_poll(subscriber: *mut Subscriber, limit_us: u32) -> Status {
    guard(|| {
        // SAFETY: an open subscriber by this function's contract.
        let subscriber = unsafe { handle_arg(subscriber, "subscriber") }?;
        subscriber.0.set_busy_poll(Duration::from_micros(limit_us.into()));
        Ok(Status::Ok)
    })
}

/// Writes a descriptor for the poll, select or epoll of another event loop. It is the same over the subscriber's whole
/// life, and only bv_subscriber_close closes it. It is readable if frames may be queued or the publisher must be
/// checked: then call bv_subscriber_take until it returns BV_STATUS_NOTHING. Do not read from it.
///
/// # Safety
/// `subscriber` is open; `fd` can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_subscriber_fd(subscriber: *mut Subscriber, fd: *mut c_int) -> Status {
    guard(|| {
        if fd.is_null() {
            return Err(crate::status::null("fd"));
        }
        // SAFETY: an open subscriber by this function's contract.
        let subscriber = unsafe { handle_arg(subscriber, "subscriber") }?;
        let readiness = subscriber.0.readiness()?.as_raw_fd();
        // SAFETY: not null, writable by this function's contract.
        unsafe { fd.write(readiness) };
        Ok(Status::Ok)
    })
}

/// Takes the oldest queued frame; BV_STATUS_NOTHING if there is none (`*out` is NULL then). Never sleeps. Two frames
/// may be held at a time, or as many as the publisher allows.
///
/// # Safety
/// `subscriber` is open; `out` can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_subscriber_take(subscriber: *mut Subscriber, out: *mut *mut Frame) -> Status {
    // SAFETY: this function's contract.
    unsafe { take(subscriber, out, belvedere_bridge::Subscriber::take) }
}

/// Takes the newest queued frame and drops older ones; otherwise like bv_subscriber_take.
///
/// # Safety
/// `subscriber` is open; `out` can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_subscriber_take_newest(
    subscriber: *mut Subscriber,
    out: *mut *mut Frame,
) -> Status {
    // SAFETY: this function's contract.
    unsafe { take(subscriber, out, belvedere_bridge::Subscriber::take_newest) }
}

type Take =
    fn(&mut belvedere_bridge::Subscriber) -> Result<Option<belvedere_bridge::Frame>, belvedere_bridge::Error>;

/// # Safety
/// `subscriber` is open; `out` can be written.
unsafe fn take(subscriber: *mut Subscriber, out: *mut *mut Frame, take: Take) -> Status {
    guard(|| {
        if out.is_null() {
            return Err(crate::status::null("out"));
        }
        // SAFETY: not null, writable by this function's contract.
        unsafe { out.write(std::ptr::null_mut()) };
        // SAFETY: an open subscriber by this function's contract.
        let subscriber = unsafe { handle_arg(subscriber, "subscriber") }?;
        match take(&mut subscriber.0)? {
            // SAFETY: `out` can be written by this function's contract.
            Some(frame) => unsafe { give(out, Frame(frame)) },
            None => Ok(Status::Nothing),
        }
    })
}

/// Returns the number of frames that were sent and never taken, over this subscriber's life.
///
/// # Safety
/// `subscriber` is open or NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_subscriber_missed_total(subscriber: *mut Subscriber) -> u64 {
    // SAFETY: this function's contract.
    unsafe { value(subscriber, belvedere_bridge::Subscriber::missed_total) }
}

/// Returns the number of publishers now: 0 before the first, and after the last has ended or was found dead.
///
/// # Safety
/// `subscriber` is open or NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_subscriber_publishers(subscriber: *mut Subscriber) -> usize {
    // SAFETY: this function's contract.
    unsafe { value(subscriber, belvedere_bridge::Subscriber::publishers) }
}

/// Returns the nanoseconds since the last frame: a long silence is the only reliable sign that a stream has stopped.
///
/// # Safety
/// `subscriber` is open or NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_subscriber_silence_ns(subscriber: *mut Subscriber) -> u64 {
    // SAFETY: this function's contract.
    unsafe { value(subscriber, |subscriber| subscriber.silence().as_nanos() as u64) }
}

/// # Safety
/// `subscriber` is open or null.
unsafe fn value<T: Default + Copy>(
    subscriber: *mut Subscriber,
    get: impl FnOnce(&belvedere_bridge::Subscriber) -> T,
) -> T {
    // SAFETY: an open subscriber or null by this function's contract.
    let subscriber: Result<_, Failure> = unsafe { handle_arg(subscriber, "subscriber") };
    match subscriber {
        Ok(subscriber) => guard_value(T::default(), || get(&subscriber.0)),
        Err(_) => T::default(),
    }
}
