//! [`Post`]: holds frames that were made ahead of time, and sends each from a thread when it is due, so that images
//! arrive in the rhythm of their timestamps, however long each took to render.

use belvedere_bridge::{Error, LoanedFrame};
use std::collections::VecDeque;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Instant;

/// Accepts frames in the order of their times. Dropping it sends the remaining frames at once.
pub struct Post {
    counter: Arc<Counter>,
    thread: Option<JoinHandle<()>>,
}

/// The state shared between the callers and the thread.
struct Counter {
    inside: Mutex<Inside>,
    /// Signalled when the first frame is added, when one is sent, and when all must be sent at once.
    changed: Condvar,
}

struct Inside {
    letters: VecDeque<Letter>,
    /// The time at which frames that are added now are due.
    due: Instant,
    /// True if frames are sent before they are due.
    hurry: bool,
    closed: bool,
}

/// A frame that waits to be sent.
struct Letter {
    due: Instant,
    frame: LoanedFrame,
    sender: Arc<Sender>,
}

/// The state of one stream's frames in the post.
#[derive(Debug, Default)]
pub struct Sender {
    waiting: AtomicUsize,
    failed: AtomicU64,
}

impl Sender {
    /// Returns the number of frames that could not be sent when they were due.
    pub fn failed(&self) -> u64 {
        self.failed.load(Ordering::Relaxed)
    }
}

impl Post {
    /// Starts the thread of a post.
    ///
    /// # Errors
    /// If the system cannot start a thread.
    pub fn open() -> std::io::Result<Self> {
        let inside = Inside { letters: VecDeque::new(), due: Instant::now(), hurry: false, closed: false };
        let counter = Arc::new(Counter { inside: Mutex::new(inside), changed: Condvar::new() });
        let theirs = counter.clone();
        let thread = std::thread::Builder::new().name("post".into()).spawn(move || theirs.serve())?;
        Ok(Self { counter, thread: Some(thread) })
    }

    /// Sets the time at which frames added from now on are sent.
    pub fn set_due(&self, due: Instant) {
        self.counter.lock().due = due;
    }

    /// Adds a frame, which is sent when it is due.
    pub fn send(&self, frame: LoanedFrame, sender: &Arc<Sender>) {
        let mut inside = self.counter.lock();
        sender.waiting.fetch_add(1, Ordering::Relaxed);
        let due = inside.due;
        inside.letters.push_back(Letter { due, frame, sender: sender.clone() });
        if inside.letters.len() == 1 {
            self.counter.changed.notify_all();
        }
    }

    /// Waits until fewer than `room` frames of a stream are in the post.
    pub fn wait_for_room(&self, sender: &Sender, room: usize) {
        let inside = self.counter.lock();
        let is_full = |_: &mut Inside| sender.waiting.load(Ordering::Relaxed) >= room;
        drop(self.counter.changed.wait_while(inside, is_full));
    }

    /// Sends all waiting frames before they are due, so that later messages arrive after them.
    pub fn flush(&self) {
        let mut inside = self.counter.lock();
        inside.hurry = true;
        self.counter.changed.notify_all();
        let inside = self.counter.changed.wait_while(inside, |inside| !inside.letters.is_empty());
        inside.unwrap_or_else(PoisonError::into_inner).hurry = false;
    }
}

impl std::fmt::Debug for Post {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Post").field("waiting", &self.counter.lock().letters.len()).finish_non_exhaustive()
    }
}

impl Drop for Post {
    fn drop(&mut self) {
        self.counter.lock().closed = true;
        self.counter.changed.notify_all();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

impl Counter {
    fn lock(&self) -> MutexGuard<'_, Inside> {
        self.inside.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Sends frames until the post is closed and none is left.
    fn serve(&self) {
        let mut inside = self.lock();
        loop {
            let Some(first) = inside.letters.front() else {
                if inside.closed {
                    return;
                }
                inside = self.changed.wait(inside).unwrap_or_else(PoisonError::into_inner);
                continue;
            };
            let wait = first.due.saturating_duration_since(Instant::now());
            if !wait.is_zero() && !inside.hurry && !inside.closed {
                inside = self.changed.wait_timeout(inside, wait).unwrap_or_else(PoisonError::into_inner).0;
                continue;
            }
            let Some(Letter { frame, sender, .. }) = inside.letters.pop_front() else { continue };
            // Sent under the lock, which takes microseconds: an empty counter then means that all frames are sent.
            if let Err(error) = frame.send() {
                sender.failed.fetch_add(1, Ordering::Relaxed);
                report(&error);
            }
            sender.waiting.fetch_sub(1, Ordering::Relaxed);
            self.changed.notify_all();
        }
    }
}

fn report(error: &Error) {
    tracing::warn!(%error, "frame dropped");
}
