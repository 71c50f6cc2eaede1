//! [`Refusal`]: why a request is not fulfilled, as a code and a message.

use crate::ros2::cdr::Unreadable;
use belvedere_bridge::RosBytes;

/// The codes of `simulation_interfaces/msg/Result`.
pub(super) mod code {
    pub(in super::super) const UNSUPPORTED: u8 = 0;
    pub(in super::super) const OK: u8 = 1;
    pub(in super::super) const NOT_FOUND: u8 = 2;
    pub(in super::super) const FAILED: u8 = 4;
}

/// A code other than "OK", and the reason in words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Refusal {
    pub(super) code: u8,
    pub(super) message: String,
}

impl Refusal {
    /// A refusal with any code; those of single services are above 100.
    pub(super) fn new(code: u8, message: impl Into<String>) -> Self {
        Self { code, message: message.into() }
    }

    pub(super) fn unsupported(message: impl Into<String>) -> Self {
        Self::new(code::UNSUPPORTED, message)
    }

    pub(super) fn not_found(message: impl Into<String>) -> Self {
        Self::new(code::NOT_FOUND, message)
    }

    pub(super) fn failed(message: impl Into<String>) -> Self {
        Self::new(code::FAILED, message)
    }

    /// Writes a `simulation_interfaces/msg/Result`.
    pub(super) fn write(&self, reply: &mut RosBytes<'_>) {
        reply.u8(self.code);
        reply.text(&self.message);
    }
}

impl From<Unreadable> for Refusal {
    fn from(reason: Unreadable) -> Self {
        Self::failed(format!("the request cannot be read: {reason}"))
    }
}

impl From<belvedere_bridge::Error> for Refusal {
    fn from(error: belvedere_bridge::Error) -> Self {
        Self::failed(error.to_string())
    }
}

/// Writes the `simulation_interfaces/msg/Result` of an outcome, and returns the value of a success.
pub(super) fn result<T>(reply: &mut RosBytes<'_>, outcome: Result<T, Refusal>) -> Option<T> {
    match outcome {
        Ok(value) => {
            Refusal::new(code::OK, "").write(reply);
            Some(value)
        }
        Err(refusal) => {
            refusal.write(reply);
            None
        }
    }
}
