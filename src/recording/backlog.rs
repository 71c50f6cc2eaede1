//! [`Backlog`]: the memory of frames that wait to be written.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, PoisonError};
use std::time::Duration;

/// Number of large buffers that are kept for reuse.
const MOST_SPARE: usize = 16;
const LARGE: usize = 1 << 16;
/// Most bytes of frames that may wait for the disk. Beyond it no frames are read, and streams that are not lossless
/// lose frames.
const MOST_WAITING: u64 = 1 << 29;
/// Longest sleep between two checks whether the file can still be written.
const NAP: Duration = Duration::from_millis(50);

/// The memory of frames between the threads that read streams and the one that writes the file.
#[derive(Default)]
pub(super) struct Backlog {
    /// Set when the file cannot be written any more.
    failed: AtomicBool,
    /// Buffers of frames that were written, for reuse: memory that is allocated and freed for each image would be
    /// cleared page by page.
    spare: Mutex<Vec<Vec<u8>>>,
    /// Number of bytes that wait to be written.
    waiting: Mutex<u64>,
    room: Condvar,
}

impl Backlog {
    /// Says that the file cannot be written any more, so nothing waits for it.
    pub(super) fn fail(&self) {
        self.failed.store(true, Ordering::Relaxed);
        self.room.notify_all();
    }

    /// Returns true if the file cannot be written any more.
    pub(super) fn has_failed(&self) -> bool {
        self.failed.load(Ordering::Relaxed)
    }

    /// Returns a copy of a payload, in a buffer that is reused if there is one.
    pub(super) fn copied(&self, bytes: &[u8]) -> Vec<u8> {
        let mut spare = self.spare.lock().unwrap_or_else(PoisonError::into_inner);
        let fits =
            (bytes.len() > LARGE).then(|| spare.iter().position(|memory| memory.capacity() >= bytes.len()));
        let mut copy = fits.flatten().map_or_else(Vec::new, |at| spare.swap_remove(at));
        drop(spare);
        copy.clear();
        copy.extend_from_slice(bytes);
        copy
    }

    /// Keeps the buffer of a frame that was written.
    pub(super) fn keep(&self, memory: Vec<u8>) {
        let mut spare = self.spare.lock().unwrap_or_else(PoisonError::into_inner);
        if spare.len() < MOST_SPARE && memory.capacity() > LARGE {
            spare.push(memory);
        }
    }

    /// Waits while too many bytes wait to be written, and counts this many more.
    pub(super) fn wait_for_room(&self, bytes: u64) {
        let mut waiting = self.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        while *waiting > MOST_WAITING && !self.has_failed() {
            waiting = self.room.wait_timeout(waiting, NAP).unwrap_or_else(PoisonError::into_inner).0;
        }
        *waiting += bytes;
    }

    /// Says that this many bytes were written.
    pub(super) fn give_room(&self, bytes: u64) {
        let mut waiting = self.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        *waiting = waiting.saturating_sub(bytes);
        self.room.notify_all();
    }
}
