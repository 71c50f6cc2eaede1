//! What can go wrong, said so that the reader knows what to do.

use std::path::PathBuf;

#[cfg(feature = "shared-memory")]
use crate::open_files::{Reached, limit_reached};
use crate::{Consumer, FrameError};

/// The version of iceoryx2 that this build speaks; 0.10 peers must agree in all three numbers.
pub const ICEORYX2_VERSION: &str = "0.10.0";

/// A failure of the bridge.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A domain name that cannot be one.
    #[error("domain \"{0}\" is not usable: 1 to 24 of the characters a-z A-Z 0-9 _ and -")]
    InvalidDomain(String),
    /// A topic that cannot be one.
    #[error("topic \"{topic}\" is not usable: {reason}")]
    InvalidTopic {
        /// As given.
        topic: String,
        /// Why not.
        reason: &'static str,
    },
    /// A name too long for the wire.
    #[error(transparent)]
    Text(#[from] crate::TextError),
    /// Somebody publishes this stream already.
    #[error(
        "domain \"{domain}\" is in use: {holder} publishes {topic}; stop it, or choose another domain (--domain, BELVEDERE_DOMAIN)"
    )]
    DomainInUse {
        /// The stream.
        topic: String,
        /// The domain.
        domain: String,
        /// Who publishes it.
        holder: Consumer,
    },
    /// All places for publishers of a stream that has several are taken.
    #[error(
        "{topic} has all the publishers that it may have at a time ({max}); close one, such as that of {holder}"
    )]
    TooManyPublishers {
        /// The stream.
        topic: String,
        /// How many it allows.
        max: usize,
        /// One of them.
        holder: Consumer,
    },
    /// All places for subscribers are taken.
    #[error(
        "{topic} has all the subscribers that it was made for ({max}); close one, or publish it with room for more (a simulator makes it for fewer than 8 when /dev/shm is small, and says so)"
    )]
    TooManySubscribers {
        /// The stream.
        topic: String,
        /// How many it allows.
        max: usize,
    },
    /// So many processes have the stream open as may.
    #[error("{topic} is open in {max} processes, which is the most; end one of them")]
    TooManyProcesses {
        /// The stream.
        topic: String,
        /// How many may have it open.
        max: usize,
    },
    /// Consumers keep the stream open as an earlier publisher made it, which does not do for this one.
    #[error(
        "{topic} in domain \"{domain}\" cannot be opened again yet: {difference}, and {holders} still has it open; end that process, or let it go on, as a consumer closes the stream of a publisher that has ended as soon as it looks for a frame"
    )]
    KeptOpen {
        /// The stream.
        topic: String,
        /// The domain.
        domain: String,
        /// How the earlier publisher made it, and how this one would.
        difference: String,
        /// Who has it open.
        holders: String,
    },
    /// The stream exists but is not one of ours, or of another version.
    #[error(
        "{topic} in domain \"{domain}\" is not compatible with this build (iceoryx2 {ICEORYX2_VERSION}, frame schema {schema}): {detail}; every process must use the same version of Belvedere",
        schema = crate::FrameHeader::SCHEMA
    )]
    Incompatible {
        /// The stream.
        topic: String,
        /// The domain.
        domain: String,
        /// What was found.
        detail: String,
    },
    /// A file or directory belongs to another user.
    #[error("no permission: {} belongs to {owner}: {remedy}", path.display())]
    Permission {
        /// What is in the way.
        path: PathBuf,
        /// Whose it is.
        owner: String,
        /// What to do.
        remedy: String,
    },
    /// Something lies where a directory belongs.
    #[error("{} is in the way: it is not a directory; remove it", .0.display())]
    NotADirectory(PathBuf),
    /// A group that a domain cannot be shared with.
    #[error("group \"{group}\" cannot share the domain: {reason}")]
    InvalidGroup {
        /// As given.
        group: String,
        /// Why not, and what to do.
        reason: String,
    },
    /// The pool would not fit into shared memory.
    #[error(
        "/dev/shm is too small: {topic} needs {needed_mib} MiB more with what is already published, {free_mib} MiB are free; enlarge it (docker run --shm-size, mount -o remount,size=...) or allow fewer subscribers"
    )]
    SharedMemoryTooSmall {
        /// The stream.
        topic: String,
        /// Mebibytes that must be free.
        needed_mib: u64,
        /// Mebibytes that are.
        free_mib: u64,
    },
    /// A frame larger than the stream was made for.
    #[error("a frame of {len} bytes does not fit into {topic}, made for at most {max}")]
    FrameTooLarge {
        /// The stream.
        topic: String,
        /// Asked for.
        len: usize,
        /// Possible.
        max: usize,
    },
    /// More frames are loaned and unsent than the stream was made for.
    #[error("no free frame in {topic}: send or drop a loaned frame first (at most {max} at a time)")]
    NoFreeFrame {
        /// The stream.
        topic: String,
        /// How many may be out at once.
        max: usize,
    },
    /// A consumer that a lossless stream waits for has not made room for a frame, which is lost to it.
    #[error(
        "consumer {consumer} held {topic} up for {seconds} s and has now lost a frame; make it faster, raise the patience, or do not wait for it",
        seconds = patience.as_secs_f64()
    )]
    HeldUp {
        /// The stream.
        topic: String,
        /// Who was waited for.
        consumer: Consumer,
        /// For how long.
        patience: std::time::Duration,
    },
    /// More frames are held by this subscriber than it may hold.
    #[error("{topic}: this subscriber holds {max} frames already, release one first")]
    TooManyHeld {
        /// The stream.
        topic: String,
        /// How many may be held at once.
        max: usize,
    },
    /// A frame whose header is wrong.
    #[error("{topic}: {error}")]
    Frame {
        /// The stream.
        topic: String,
        /// What is wrong.
        error: FrameError,
    },
    /// This process has as many files open as it may.
    #[error(
        "{what}: this process may have no more files open than the {limit} of its limit, and a stream takes several; {remedy}"
    )]
    TooManyOpenFiles {
        /// What was tried.
        what: String,
        /// The soft limit of this process.
        limit: u64,
        /// How to raise it.
        remedy: String,
    },
    /// The pool would not fit into the address space of this process.
    #[error(
        "{topic} needs {needed_mib} MiB of address space more than this process may have; allow more in the shell that starts it: ulimit -v unlimited"
    )]
    AddressSpaceTooSmall {
        /// The stream.
        topic: String,
        /// Mebibytes of its pool.
        needed_mib: u64,
    },
    /// A failure below that has no remedy of its own.
    #[error("{what}: iceoryx2 {ICEORYX2_VERSION} reports {detail}")]
    Transport {
        /// What was tried.
        what: String,
        /// What came back.
        detail: String,
    },
}

#[cfg(feature = "shared-memory")]
impl Error {
    /// A failure of iceoryx2 or the system, or the limit that is behind it: iceoryx2 does not tell it from others.
    pub(crate) fn transport(what: impl Into<String>, detail: impl std::fmt::Debug) -> Self {
        let what = what.into();
        match limit_reached() {
            Some(Reached { limit, remedy }) => Self::TooManyOpenFiles { what, limit, remedy },
            None => Self::Transport { what, detail: format!("{detail:?}") },
        }
    }

    /// Whether this process may still open the files that a step needs, before it begins.
    pub(crate) fn check_open_files(what: impl FnOnce() -> String) -> Result<(), Self> {
        match limit_reached() {
            Some(Reached { limit, remedy }) => Err(Self::TooManyOpenFiles { what: what(), limit, remedy }),
            None => Ok(()),
        }
    }
}
