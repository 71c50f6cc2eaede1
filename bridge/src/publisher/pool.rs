//! Reservation of `/dev/shm`: space is reserved before a pool is created, and allocated before it is written.
//!
//! A page of shared memory is allocated when it is first written. If none is free then, the writer gets SIGBUS in the
//! middle of a frame, and hours of simulation are lost. So a publisher first reserves its whole pool against the free
//! space ([`book`]), and then allocates the pages that frames can occupy ([`Pool`]) with `fallocate`, which reports an
//! error instead.

use std::{
    fs::File,
    os::unix::fs::MetadataExt as _,
    path::PathBuf,
    sync::atomic::{AtomicU64, Ordering},
};

use rustix::fs::FallocateFlags;

use crate::{
    Error, Node, StreamSpec,
    domain::room::{BOOKS, MIB, free, too_small},
};

/// Reserves `bytes` for a pool, if the free space of `/dev/shm` covers them and what earlier reservations have not yet
/// allocated.
///
/// # Errors
/// [`Error::SharedMemoryTooSmall`].
pub(crate) fn book(node: &Node, topic: &str, bytes: u64) -> Result<Booking, Error> {
    let promised = node.promised_bytes().fetch_add(bytes, Ordering::Relaxed) + bytes;
    let booking = Booking { node: node.clone(), bytes, taken: AtomicU64::new(0) };
    let (needed, free) = (promised + BOOKS, free()?);
    if free < needed { Err(too_small(topic, needed, free)) } else { Ok(booking) }
}

/// A reservation for a publisher's pool. Dropping it releases the part that was not allocated.
#[derive(Debug)]
pub(crate) struct Booking {
    node: Node,
    bytes: u64,
    taken: AtomicU64,
}

impl Booking {
    /// Records that `bytes` of the pool are allocated now, and so no longer count as free.
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

/// Checks that a pool of this size can be mapped. iceoryx2 would create the pool's file first, fail to map it, not say
/// why, and leave the file.
///
/// # Errors
/// [`Error::AddressSpaceTooSmall`].
pub(crate) fn check_address_space(topic: &str, bytes: u64) -> Result<(), Error> {
    // This reserves address space as a mapping does, and does not touch it.
    if usize::try_from(bytes).is_ok_and(|bytes| Vec::<u8>::new().try_reserve_exact(bytes).is_ok()) {
        return Ok(());
    }
    Err(Error::AddressSpaceTooSmall { topic: topic.to_owned(), needed_mib: bytes.div_ceil(MIB) })
}

/// A publisher's pool of frames, and how much of it is allocated.
///
/// iceoryx2 reuses the frame that was returned last, so it touches an unused frame only if all others are in use. With
/// `n` subscribers at most `n · (buffer + borrowed) + history + loaned` frames are in use, the first ones of the pool.
/// Only these are allocated: for one subscriber at first, and more as others come. A pool for eight subscribers with
/// one of them takes a sixth of its full size.
#[derive(Debug)]
pub(crate) struct Pool {
    /// The file of the pool. It is opened to allocate pages and not kept open, since a robot has many streams and
    /// descriptors are scarce.
    path: PathBuf,
    len: u64,
    frames: u64,
    per_subscriber: u64,
    /// Frames of history and loaned frames.
    others: u64,
    topic: String,
    booking: Booking,
    /// The number of subscribers that pages are allocated for.
    subscribers: AtomicU64,
}

impl Pool {
    /// Opens the pool of a port and allocates the pages that one subscriber needs.
    ///
    /// # Errors
    /// [`Error::SharedMemoryTooSmall`]; [`Error::Transport`] if the pool's file is not found.
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

    /// Allocates the pages that this many subscribers need, unless they are allocated already.
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
        // Pages that are allocated already stay as they are.
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

    /// Returns the bytes that this many subscribers need. A subscriber that connects after the count was read holds at
    /// most the next frame and the one before it, which count as loaned and as history; the frame after that is loaned
    /// when the subscriber is known.
    fn bytes_for(&self, subscribers: u64) -> u64 {
        /// An upper bound on what iceoryx2 writes before the first frame.
        const BEFORE: u64 = 64 << 10;
        let frames = subscribers * self.per_subscriber + self.others;
        (frames * self.len.div_ceil(self.frames) + BEFORE).min(self.len)
    }
}
