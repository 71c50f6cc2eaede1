//! Frames that are made ahead of their time, and a thread that sends each when it is due: pictures arrive in the rhythm
//! of their stamps, whatever each of them took to render.

use belvedere_bridge::{Error, LoanedFrame};
use std::collections::VecDeque;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Instant;

/// Takes frames in the order of their times. Dropped, it sends what is left at once.
pub struct Post {
    counter: Arc<Counter>,
    thread: Option<JoinHandle<()>>,
}

/// Where frames are handed in and fetched.
struct Counter {
    inside: Mutex<Inside>,
    /// The first frame came, one was sent, or all are to be sent at once.
    changed: Condvar,
}

struct Inside {
    letters: VecDeque<Letter>,
    /// When what is handed in now is due.
    due: Instant,
    /// Whether frames go before their time.
    hurry: bool,
    closed: bool,
}

/// A frame on its way.
struct Letter {
    due: Instant,
    frame: LoanedFrame,
    sender: Arc<Sender>,
}

/// What a stream knows of its frames that are on their way.
#[derive(Debug, Default)]
pub struct Sender {
    waiting: AtomicUsize,
    failed: AtomicU64,
}

impl Sender {
    /// Frames that could not be sent when their time came.
    pub fn failed(&self) -> u64 {
        self.failed.load(Ordering::Relaxed)
    }
}

impl Post {
    /// Starts the thread.
    ///
    /// # Errors
    /// When the system gives none.
    pub fn open() -> std::io::Result<Self> {
        let inside = Inside { letters: VecDeque::new(), due: Instant::now(), hurry: false, closed: false };
        let counter = Arc::new(Counter { inside: Mutex::new(inside), changed: Condvar::new() });
        let theirs = counter.clone();
        let thread = std::thread::Builder::new().name("post".into()).spawn(move || theirs.serve())?;
        Ok(Self { counter, thread: Some(thread) })
    }

    /// From now on frames that are handed in are to be sent at this time.
    pub fn set_due(&self, due: Instant) {
        self.counter.lock().due = due;
    }

    /// Takes a frame that is to be sent when its time comes.
    pub fn send(&self, frame: LoanedFrame, sender: &Arc<Sender>) {
        let mut inside = self.counter.lock();
        sender.waiting.fetch_add(1, Ordering::Relaxed);
        let due = inside.due;
        inside.letters.push_back(Letter { due, frame, sender: sender.clone() });
        if inside.letters.len() == 1 {
            self.counter.changed.notify_all();
        }
    }

    /// Waits until fewer than `room` frames of a stream are on their way.
    pub fn wait_for_room(&self, sender: &Sender, room: usize) {
        let inside = self.counter.lock();
        let is_full = |_: &mut Inside| sender.waiting.load(Ordering::Relaxed) >= room;
        drop(self.counter.changed.wait_while(inside, is_full));
    }

    /// Sends all that waits now, before its time, so that what is told next comes after it.
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
            // Sent under the lock: it takes microseconds, and no frames in the counter means that all are out.
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
