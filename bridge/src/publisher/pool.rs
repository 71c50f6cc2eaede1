//! Room in `/dev/shm`: asked for before anything is made, and taken before it is written to.
//!
//! A page of shared memory is taken when it is first written. When none is free then, the writer gets SIGBUS, in the
//! middle of a frame, and a simulation of hours is gone. So a publisher books its whole pool against what is free
//! ([`book`]), and takes the pages that frames can come to lie in ([`Pool`]) by `fallocate`, which fails politely.

use std::{
    fs::File,
    os::unix::fs::MetadataExt as _,
    path::PathBuf,
    sync::atomic::{AtomicU64, Ordering},
};

use rustix::fs::FallocateFlags;

use crate::{
    Error, Node, StreamSpec,
    domain::room::{BOOKS, free, too_small},
};

/// Books `bytes` of pool, if they and what was promised to all pools before, and is not taken yet, fit into what is free
/// of `/dev/shm`.
///
/// # Errors
/// [`Error::SharedMemoryTooSmall`].
pub(crate) fn book(node: &Node, topic: &str, bytes: u64) -> Result<Booking, Error> {
    let promised = node.promised_bytes().fetch_add(bytes, Ordering::Relaxed) + bytes;
    let booking = Booking { node: node.clone(), bytes, taken: AtomicU64::new(0) };
    let (needed, free) = (promised + BOOKS, free()?);
    if free < needed { Err(too_small(topic, needed, free)) } else { Ok(booking) }
}

/// Bytes promised to a publisher's pool. What is not taken when it is dropped is promised no more.
#[derive(Debug)]
pub(crate) struct Booking {
    node: Node,
    bytes: u64,
    taken: AtomicU64,
}

impl Booking {
    /// So much of the pool is taken now, which is missing from what is free.
    fn take(&self, bytes: u64) {
        let bytes = bytes.min(self.bytes);
        let before = self.taken.fetch_max(bytes, Ordering::Relaxed);
        self.node.promised_bytes().fetch_sub(bytes.saturating_sub(before), Ordering::Relaxed);
    }
}

impl Drop for Booking {
    fn drop(&mut self) {
        self.take(self.bytes);
    }
}

/// Whether a pool of so many bytes can be mapped: iceoryx2 does not say that it could not.
pub(crate) fn has_address_space(bytes: u64) -> bool {
    // Reserved like a mapping, and not touched.
    usize::try_from(bytes).is_ok_and(|bytes| Vec::<u8>::new().try_reserve_exact(bytes).is_ok())
}

/// A publisher's pool of frames, and how much of it has been taken.
///
/// iceoryx2 hands out the frame that came back last, so that a frame never used before is touched only when all others
/// are out: with `n` subscribers no more than `n · (buffer + borrowed) + history + loaned` frames ever are, the
/// foremost of the pool. Only these are taken, for one subscriber at first, and more when others come: a pool for eight
/// subscribers with one of them takes a sixth of its size.
#[derive(Debug)]
pub(crate) struct Pool {
    /// Opened when pages are taken, and not kept open: a robot has many streams, and descriptors are few.
    path: PathBuf,
    len: u64,
    frames: u64,
    per_subscriber: u64,
    /// Frames of history, and loaned ones.
    others: u64,
    topic: String,
    booking: Booking,
    /// Subscribers that it has been taken for.
    subscribers: AtomicU64,
}

impl Pool {
    /// The pool of a port, with the room that one subscriber needs.
    ///
    /// # Errors
    /// [`Error::SharedMemoryTooSmall`]; [`Error::Transport`] when the pool's file is not where it should be.
    pub(crate) fn take(
        node: &Node,
        spec: &StreamSpec,
        topic: &str,
        port: u128,
        booking: Booking,
    ) -> Result<Self, Error> {
        let ending = format!("_{port}.data");
        let failed = |error| Error::transport(format!("reserving the pool of {topic}"), error);
        let path = node
            .keeper()
            .in_shared_memory()
            .find(|path| path.as_os_str().as_encoded_bytes().ends_with(ending.as_bytes()))
            .ok_or_else(|| failed(std::io::ErrorKind::NotFound.into()))?;
        let pool = Self {
            len: path.metadata().map_err(failed)?.len(),
            path,
            frames: spec.pool_frames().max(1),
            per_subscriber: (spec.buffer + spec.borrowed) as u64,
            others: (spec.history + spec.loaned) as u64,
            topic: topic.to_owned(),
            booking,
            subscribers: AtomicU64::new(0),
        };
        pool.take_for(1)?;
        Ok(pool)
    }

    /// Takes what so many subscribers need, if it has not been taken before.
    ///
    /// # Errors
    /// [`Error::SharedMemoryTooSmall`].
    pub(crate) fn take_for(&self, subscribers: usize) -> Result<(), Error> {
        let subscribers = subscribers as u64;
        if subscribers <= self.subscribers.load(Ordering::Relaxed) {
            return Ok(());
        }
        let bytes = self.bytes_for(subscribers);
        let failed = |error| Error::transport(format!("reserving the pool of {}", self.topic), error);
        let file = File::options().write(true).open(&self.path).map_err(failed)?;
        // What is taken already stays as it is.
        match rustix::fs::fallocate(&file, FallocateFlags::empty(), 0, bytes) {
            Ok(()) => {
                self.subscribers.fetch_max(subscribers, Ordering::Relaxed);
                self.booking.take(bytes);
                Ok(())
            }
            Err(rustix::io::Errno::NOSPC) => {
                let taken = file.metadata().map_or(0, |metadata| metadata.blocks() * 512);
                Err(too_small(&self.topic, bytes.saturating_sub(taken), free()?))
            }
            Err(error) => Err(failed(error.into())),
        }
    }

    /// A subscriber that comes after this was asked has no more than the frame that is sent next and the one before,
    /// which are on loan or history; the frame after that is loaned when its coming is known.
    fn bytes_for(&self, subscribers: u64) -> u64 {
        /// More than what iceoryx2 writes before the first frame.
        const BEFORE: u64 = 64 << 10;
        let frames = subscribers * self.per_subscriber + self.others;
        (frames * self.len.div_ceil(self.frames) + BEFORE).min(self.len)
    }
}
