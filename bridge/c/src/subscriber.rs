//! Following a stream.

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

/// The reading end of a stream: there before its publisher, and after.
pub struct Subscriber(belvedere_bridge::Subscriber);

/// Follows a stream, whether it exists already or not. A leading slash of the topic is ignored. When the publisher
/// ends, or is killed, and starts again, the subscriber goes on with the new one.
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

/// Ends the subscription; NULL is ignored. Frames that are held stay valid.
///
/// # Safety
/// `subscriber` came from bv_subscribe and is not used afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_subscriber_close(subscriber: *mut Subscriber) {
    // SAFETY: this function's contract.
    unsafe { close(subscriber) };
}

/// Sleeps until there is a frame to take: BV_STATUS_OK; BV_STATUS_NOTHING when the time has passed, or a signal
/// came, without one.
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

/// Looks for frames without sleeping when they are due, for at most `limit_us` a frame; 0, as at first: never.
///
/// It takes the system 30 to 100 us to wake a process, which is most of a frame's age where it arrives. With this,
/// bv_subscriber_wait, and bv_subscriber_take in a loop that waits for bv_subscriber_fd, begin to look shortly before
/// the next frame of a periodic stream is due, by the times of those before, and have it a few microseconds after it
/// was sent. What comes much earlier or later, or without a period, wakes them as ever.
///
/// The price is processor time: three mean deviations of the times of sending, 0.15 ms at least and half of
/// `limit_us` at most, of a core for each frame. On a single core it does nothing.
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

/// A descriptor for the poll, select or epoll of another event loop: the same over the subscriber's whole life, and
/// closed by bv_subscriber_close only. It is readable when frames may wait or it is time to look for the publisher:
/// call bv_subscriber_take then until it gives BV_STATUS_NOTHING. Do not read from it.
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

/// Takes the oldest frame that waits; BV_STATUS_NOTHING when none does (`*out` is NULL then). Never sleeps.
/// Two frames may be held at a time, or as many as the publisher allows.
///
/// # Safety
/// `subscriber` is open; `out` can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_subscriber_take(subscriber: *mut Subscriber, out: *mut *mut Frame) -> Status {
    // SAFETY: this function's contract.
    unsafe { take(subscriber, out, belvedere_bridge::Subscriber::take) }
}

/// Takes the newest frame that waits and drops those before it; otherwise as bv_subscriber_take.
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

/// Frames that were sent and never taken, over this subscriber's life.
///
/// # Safety
/// `subscriber` is open or NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_subscriber_missed_total(subscriber: *mut Subscriber) -> u64 {
    // SAFETY: this function's contract.
    unsafe { value(subscriber, belvedere_bridge::Subscriber::missed_total) }
}

/// Publishers now; 0 before the first, and after the last has ended or was found dead.
///
/// # Safety
/// `subscriber` is open or NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_subscriber_publishers(subscriber: *mut Subscriber) -> usize {
    // SAFETY: this function's contract.
    unsafe { value(subscriber, belvedere_bridge::Subscriber::publishers) }
}

/// Nanoseconds since the last frame: the sign that a stream has stopped.
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
