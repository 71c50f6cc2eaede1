//! Errors as codes with a text; panics stopped at the border.

use std::{
    cell::RefCell,
    ffi::{CStr, CString, c_char},
    panic::{AssertUnwindSafe, catch_unwind},
};

use belvedere_bridge::Error;

/// How a call went. Negative values are errors; bv_last_error() has the words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Status {
    /// Done.
    Ok = 0,
    /// Nothing is there: the time passed without a frame, or none waits.
    Nothing = 1,
    /// A pointer is null, a text is not UTF-8, or a number is out of range.
    InvalidArgument = -1,
    /// The name of a domain or topic cannot be one.
    InvalidName = -2,
    /// Another process publishes this stream already.
    DomainInUse = -3,
    /// The stream is of another version, or not a Belvedere stream, or kept open as an earlier publisher made it.
    Incompatible = -4,
    /// The shared memory belongs to another user.
    Permission = -5,
    /// /dev/shm is too small.
    SharedMemoryTooSmall = -6,
    /// All places are taken: publishers or subscribers of the stream, frames held at a time, or files that the process
    /// may have open.
    Limit = -7,
    /// A frame's header is wrong; the frame was dropped.
    BadFrame = -8,
    /// A failure of the transport below.
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

/// What a failing part of a call ends with.
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
}

pub(crate) fn null(what: &str) -> Failure {
    Failure::invalid_argument(format!("{what} is a null pointer"))
}

/// Runs the body of a call; errors and panics become a status and a text.
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

/// As [`guard`] for calls that cannot fail but might have a defect.
pub(crate) fn guard_value<T>(fallback: T, body: impl FnOnce() -> T) -> T {
    catch_unwind(AssertUnwindSafe(body)).unwrap_or(fallback)
}

/// A C string as text.
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

/// The handle behind a pointer from C.
///
/// # Safety
/// `handle` is null or came from the function that makes such handles, was not closed, and nobody else uses it
/// during `'a`.
pub(crate) unsafe fn handle_arg<'a, T>(handle: *mut T, what: &str) -> Result<&'a mut T, Failure> {
    // SAFETY: valid, aligned and exclusive by the contract of this function.
    unsafe { handle.as_mut() }.ok_or_else(|| null(what))
}

/// Gives `value` to C as a new handle.
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

/// Ends a handle.
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

/// What went wrong last in this thread, in words; empty when nothing has. Valid until the next call that fails in
/// this thread.
#[unsafe(no_mangle)]
pub extern "C" fn bv_last_error() -> *const c_char {
    LAST_ERROR.with_borrow(|last| last.as_ptr())
}

/// Belvedere's version, such as "0.1.0".
#[unsafe(no_mangle)]
pub extern "C" fn bv_version() -> *const c_char {
    const VERSION: &CStr =
        match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
            Ok(version) => version,
            Err(_) => panic!("the version has no NUL"),
        };
    VERSION.as_ptr()
}

/// CLOCK_MONOTONIC in nanoseconds: compare with publish_mono_ns of a header.
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
