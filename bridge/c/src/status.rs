//! Errors as codes with messages; panics are caught at the language boundary.

use std::{
    cell::RefCell,
    ffi::{CStr, CString, c_char},
    panic::{AssertUnwindSafe, catch_unwind},
};

use belvedere_bridge::{Error, FrameError};

/// The result of a call. Negative values are errors, which bv_last_error() describes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Status {
    /// Success.
    Ok = 0,
    /// Nothing is available: the timeout passed without a frame, or no frame is queued.
    Nothing = 1,
    /// A pointer is null, a text is not UTF-8, or a number is out of range.
    InvalidArgument = -1,
    /// The name of a domain or topic is unusable.
    InvalidName = -2,
    /// Another process publishes this stream already.
    DomainInUse = -3,
    /// The stream is of another version, is not a Belvedere stream, or is kept open with the settings of an earlier
    /// publisher.
    Incompatible = -4,
    /// The shared memory belongs to another user.
    Permission = -5,
    /// /dev/shm is too small.
    SharedMemoryTooSmall = -6,
    /// A limit is reached: publishers or subscribers of the stream, frames held at a time, or open files of the
    /// process.
    Limit = -7,
    /// The header of a frame is invalid; the frame was dropped.
    BadFrame = -8,
    /// The transport (iceoryx2 or the system) failed.
    Transport = -9,
    /// A defect in Belvedere; please report it.
    Internal = -10,
}

thread_local! {
    static LAST_ERROR: RefCell<CString> = RefCell::default();
}

pub(crate) fn set_last_error(text: &str) {
    let text = CString::new(text.replace('\0', " ")).unwrap_or_default();
    LAST_ERROR.with_borrow_mut(|last| *last = text);
}

/// The status and message of a failed call.
pub(crate) struct Failure(Status, String);

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        let status = match &error {
            Error::InvalidDomain(_)
            | Error::InvalidTopic { .. }
            | Error::InvalidGroup { .. }
            | Error::Text(_) => Status::InvalidName,
            Error::DomainInUse { .. } => Status::DomainInUse,
            Error::Incompatible { .. } | Error::KeptOpen { .. } => Status::Incompatible,
            Error::Permission { .. } | Error::NotADirectory(_) => Status::Permission,
            Error::SharedMemoryTooSmall { .. } => Status::SharedMemoryTooSmall,
            Error::TooManySubscribers { .. }
            | Error::TooManyProcesses { .. }
            | Error::TooManyHeld { .. }
            | Error::NoFreeFrame { .. }
            | Error::TooManyPublishers { .. }
            | Error::TooManyOpenFiles { .. }
            | Error::AddressSpaceTooSmall { .. }
            | Error::FrameTooLarge { .. } => Status::Limit,
            Error::Frame { .. } => Status::BadFrame,
            _ => Status::Transport,
        };
        Self(status, error.to_string())
    }
}

impl Failure {
    pub(crate) fn invalid_argument(text: String) -> Self {
        Self(Status::InvalidArgument, text)
    }

    pub(crate) fn bad_frame(error: &FrameError) -> Self {
        Self(Status::BadFrame, error.to_string())
    }
}

pub(crate) fn null(what: &str) -> Failure {
    Failure::invalid_argument(format!("{what} is a null pointer"))
}

/// Runs the body of a call; turns errors and panics into a status and a message.
pub(crate) fn guard(body: impl FnOnce() -> Result<Status, Failure>) -> Status {
    match catch_unwind(AssertUnwindSafe(body)) {
        Ok(Ok(status)) => status,
        Ok(Err(Failure(status, text))) => {
            set_last_error(&text);
            status
        }
        Err(_) => {
            set_last_error("a defect in Belvedere (see standard error); please report it");
            Status::Internal
        }
    }
}

/// Runs the body of a call that cannot fail; returns `fallback` if it panics.
pub(crate) fn guard_value<T>(fallback: T, body: impl FnOnce() -> T) -> T {
    catch_unwind(AssertUnwindSafe(body)).unwrap_or(fallback)
}

/// Converts a C string to text.
///
/// # Safety
/// `text` is null or points to a NUL-terminated string that outlives `'a`.
pub(crate) unsafe fn str_arg<'a>(text: *const c_char, what: &str) -> Result<&'a str, Failure> {
    if text.is_null() {
        return Err(null(what));
    }
    // SAFETY: not null; NUL-terminated and alive by the contract of this function.
    let text = unsafe { CStr::from_ptr(text) };
    text.to_str().map_err(|_| Failure::invalid_argument(format!("{what} is not UTF-8")))
}

/// Returns the handle behind a pointer from C.
///
/// # Safety
/// `handle` is null, or was created by the function for such handles and not closed, and is not used elsewhere during
/// `'a`.
pub(crate) unsafe fn handle_arg<'a, T>(handle: *mut T, what: &str) -> Result<&'a mut T, Failure> {
    // SAFETY: valid, aligned and exclusive by the contract of this function.
    unsafe { handle.as_mut() }.ok_or_else(|| null(what))
}

/// Passes `value` to C as a new handle.
///
/// # Safety
/// `out` is null or can be written.
pub(crate) unsafe fn give<T>(out: *mut *mut T, value: T) -> Result<Status, Failure> {
    if out.is_null() {
        return Err(null("out"));
    }
    // SAFETY: not null; writable by the contract of this function.
    unsafe { out.write(Box::into_raw(Box::new(value))) };
    Ok(Status::Ok)
}

/// Closes a handle.
///
/// # Safety
/// `handle` is null or came from [`give`] and was not closed.
pub(crate) unsafe fn close<T>(handle: *mut T) {
    if !handle.is_null() {
        // SAFETY: it came from `Box::into_raw` in `give` and is given back once, by the contract of this function.
        let owned = unsafe { Box::from_raw(handle) };
        guard_value((), || drop(owned));
    }
}

/// Returns a description of the last error in this thread; empty if there was none. Valid until the next failing call
/// in this thread.
#[unsafe(no_mangle)]
pub extern "C" fn bv_last_error() -> *const c_char {
    LAST_ERROR.with_borrow(|last| last.as_ptr())
}

/// Returns Belvedere's version, such as "0.1.0".
#[unsafe(no_mangle)]
pub extern "C" fn bv_version() -> *const c_char {
    const VERSION: &CStr =
        match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
            Ok(version) => version,
            Err(_) => panic!("the version has no NUL"),
        };
    VERSION.as_ptr()
}

/// Returns CLOCK_MONOTONIC in nanoseconds, to compare with publish_mono_ns of a header.
#[unsafe(no_mangle)]
pub extern "C" fn bv_mono_ns() -> u64 {
    belvedere_bridge::clock::mono_ns()
}

#[cfg(test)]
mod tests {
    use belvedere_bridge::Consumer;

    use super::*;

    #[test]
    fn one_sender_too_many_is_no_other_simulator() {
        let (topic, domain) = ("cmd_vel".to_owned(), "default".to_owned());
        let holder = Consumer { name: "driver".to_owned(), pid: 1 };
        let too_many = Error::TooManyPublishers { topic: topic.clone(), max: 8, holder: holder.clone() };
        assert_eq!(Failure::from(too_many).0, Status::Limit);
        assert_eq!(Failure::from(Error::DomainInUse { topic, domain, holder }).0, Status::DomainInUse);
    }
}
