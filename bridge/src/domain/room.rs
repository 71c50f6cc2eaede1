//! Free space in `/dev/shm`.

use super::places::SHM;
use crate::Error;

pub(crate) const MIB: u64 = 1 << 20;
/// An upper bound on the memory that connections, queues and bookkeeping take in addition to the pools.
pub(crate) const BOOKS: u64 = MIB;

/// Returns the free bytes of `/dev/shm`.
pub(crate) fn free() -> Result<u64, Error> {
    let stat = rustix::fs::statvfs(SHM)
        .map_err(|error| Error::transport(format!("reading the free space of {SHM}"), error))?;
    Ok(stat.f_bavail * stat.f_frsize)
}

pub(crate) fn too_small(topic: &str, needed: u64, free: u64) -> Error {
    Error::SharedMemoryTooSmall {
        topic: topic.to_owned(),
        needed_mib: needed.div_ceil(MIB),
        free_mib: free / MIB,
    }
}

/// Checks that there is room for what a new port or connection writes.
///
/// # Errors
/// [`Error::SharedMemoryTooSmall`].
pub(crate) fn check_room_for_books(topic: &str) -> Result<(), Error> {
    match free()? {
        free if free < BOOKS => Err(too_small(topic, BOOKS, free)),
        _ => Ok(()),
    }
}
