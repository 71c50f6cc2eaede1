//! [`Error`]: the failures of the bridge, with messages that say what to do.

use std::path::PathBuf;

#[cfg(feature = "shared-memory")]
use crate::open_files::{Reached, limit_reached};
use crate::{Consumer, FrameError};

/// The version of iceoryx2 in this build. Peers of 0.10 must agree in all three numbers.
pub const ICEORYX2_VERSION: &str = "0.10.0";

/// A failure of the bridge.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The domain name is unusable.
    #[error("domain \"{0}\" is not usable: 1 to 24 of the characters a-z A-Z 0-9 _ and -")]
    InvalidDomain(String),
    /// The topic is unusable.
    #[error("topic \"{topic}\" is not usable: {reason}")]
    InvalidTopic {
        /// The topic, as given.
        topic: String,
        /// Why it is unusable.
        reason: &'static str,
    },
    /// A name is too long for the wire format.
    #[error(transparent)]
    Text(#[from] crate::TextError),
    /// Another process already publishes this stream.
    #[error(
        "domain \"{domain}\" is in use: {holder} publishes {topic}; stop it, or choose another domain (--domain, BELVEDERE_DOMAIN)"
    )]
    DomainInUse {
        /// The stream.
        topic: String,
        /// The domain.
        domain: String,
        /// The process that publishes it.
        holder: Consumer,
    },
    /// All publisher slots of a stream for several publishers are taken.
    #[error("{topic} already has its maximum of {max} publishers; close one, such as that of {holder}")]
    TooManyPublishers {
        /// The stream.
        topic: String,
        /// The number of slots.
        max: usize,
        /// The process that holds one of them.
        holder: Consumer,
    },
    /// All subscriber slots are taken.
    #[error(
        "{topic} already has its maximum of {max} subscribers; close one, or publish the stream with more slots (a simulator allows fewer than 8 if /dev/shm is small, and logs it)"
    )]
    TooManySubscribers {
        /// The stream.
        topic: String,
        /// The number of slots.
        max: usize,
    },
    /// The maximum number of processes has the stream open.
    #[error("{topic} is open in {max} processes, which is the maximum; end one of them")]
    TooManyProcesses {
        /// The stream.
        topic: String,
        /// The maximum number.
        max: usize,
    },
    /// Consumers keep the stream open with the settings of an earlier publisher, which do not fit this one.
    #[error(
        "{topic} in domain \"{domain}\" cannot be opened again yet: {difference}, and {holders} still has it open; end that process, or let it continue: a consumer closes the stream of an ended publisher when it next waits for a frame"
    )]
    KeptOpen {
        /// The stream.
        topic: String,
        /// The domain.
        domain: String,
        /// The difference between the existing stream and the one requested.
        difference: String,
        /// The processes that have it open.
        holders: String,
    },
    /// The stream exists but is not a Belvedere stream, or is of another version.
    #[error(
        "{topic} in domain \"{domain}\" is not compatible with this build (iceoryx2 {ICEORYX2_VERSION}, frame schema {schema}): {detail}; every process must use the same version of Belvedere",
        schema = crate::FrameHeader::SCHEMA
    )]
    Incompatible {
        /// The stream.
        topic: String,
        /// The domain.
        domain: String,
        /// The types or version that were found.
        detail: String,
    },
    /// A file or directory belongs to another user.
    #[error("no permission: {} belongs to {owner}: {remedy}", path.display())]
    Permission {
        /// The file or directory.
        path: PathBuf,
        /// Its owner.
        owner: String,
        /// How to resolve it.
        remedy: String,
    },
    /// Something other than a directory is in the place of one.
    #[error("{} is in the way: it is not a directory; remove it", .0.display())]
    NotADirectory(PathBuf),
    /// The domain cannot be shared with this group.
    #[error("group \"{group}\" cannot share the domain: {reason}")]
    InvalidGroup {
        /// The group, as given.
        group: String,
        /// Why it cannot, and what to do.
        reason: String,
    },
    /// The pool does not fit into shared memory.
    #[error(
        "/dev/shm is too small: {topic} needs {needed_mib} MiB more, including what other streams have reserved, but {free_mib} MiB are free; enlarge it (docker run --shm-size, mount -o remount,size=...) or allow fewer subscribers"
    )]
    SharedMemoryTooSmall {
        /// The stream.
        topic: String,
        /// Mebibytes that are needed.
        needed_mib: u64,
        /// Mebibytes that are free.
        free_mib: u64,
    },
    /// The frame is larger than the stream's maximum.
    #[error("a frame of {len} bytes does not fit into {topic}, whose maximum is {max}")]
    FrameTooLarge {
        /// The stream.
        topic: String,
        /// The requested size.
        len: usize,
        /// The largest possible size.
        max: usize,
    },
    /// All frames that may be on loan at a time are loaned and unsent.
    #[error("no free frame in {topic}: send or drop a loaned frame first (at most {max} at a time)")]
    NoFreeFrame {
        /// The stream.
        topic: String,
        /// The maximum number of loaned frames.
        max: usize,
    },
    /// A consumer that a lossless stream waits for did not make room in time, and has lost the frame.
    #[error(
        "consumer {consumer} held {topic} up for {seconds} s and has lost a frame; make it faster, increase the patience, or do not wait for it",
        seconds = patience.as_secs_f64()
    )]
    HeldUp {
        /// The stream.
        topic: String,
        /// The consumer that was waited for.
        consumer: Consumer,
        /// How long the publisher waited.
        patience: std::time::Duration,
    },
    /// This subscriber already holds the maximum number of frames.
    #[error("{topic}: this subscriber already holds {max} frames; release one first")]
    TooManyHeld {
        /// The stream.
        topic: String,
        /// The maximum number of held frames.
        max: usize,
    },
    /// A frame has an invalid header.
    #[error("{topic}: {error}")]
    Frame {
        /// The stream.
        topic: String,
        /// The fault in the header.
        error: FrameError,
    },
    /// This process has reached its limit of open files.
    #[error(
        "{what}: this process may have no more files open than the {limit} of its limit, and a stream takes several; {remedy}"
    )]
    TooManyOpenFiles {
        /// The operation that failed.
        what: String,
        /// The soft limit of this process.
        limit: u64,
        /// How to raise the limit.
        remedy: String,
    },
    /// The pool does not fit into the address space of this process.
    #[error(
        "{topic} needs {needed_mib} MiB of address space more than this process may have; allow more in the shell that starts it: ulimit -v unlimited"
    )]
    AddressSpaceTooSmall {
        /// The stream.
        topic: String,
        /// Size of the pool in mebibytes.
        needed_mib: u64,
    },
    /// A failure of iceoryx2 or the system without a specific remedy.
    #[error("{what}: iceoryx2 {ICEORYX2_VERSION} reports {detail}")]
    Transport {
        /// The operation that failed.
        what: String,
        /// The error that was reported.
        detail: String,
    },
}

#[cfg(feature = "shared-memory")]
impl Error {
    /// Returns the error for a failure of iceoryx2 or the system. If the limit of open files is behind it, returns that
    /// error instead: iceoryx2 does not distinguish it.
    pub(crate) fn transport(what: impl Into<String>, detail: impl std::fmt::Debug) -> Self {
        let what = what.into();
        match limit_reached() {
            Some(Reached { limit, remedy }) => Self::TooManyOpenFiles { what, limit, remedy },
            None => Self::Transport { what, detail: format!("{detail:?}") },
        }
    }

    /// Checks, before a step begins, that this process may open the files that the step needs.
    pub(crate) fn check_open_files(what: impl FnOnce() -> String) -> Result<(), Self> {
        match limit_reached() {
            Some(Reached { limit, remedy }) => Err(Self::TooManyOpenFiles { what: what(), limit, remedy }),
            None => Ok(()),
        }
    }
}
