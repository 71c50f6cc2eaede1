//! [`Listing`]: the streams of the domain, which a thread of its own looks up: that takes longer than frames may wait.

use belvedere_bridge::{Error, Node, StreamInfo};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;
use std::time::Duration;

/// Interval at which streams are looked up.
const LOOK: Duration = Duration::from_millis(500);

/// The streams that there are now.
#[derive(Debug)]
pub(super) struct Listing {
    /// `None` only while it is dropped, which ends the thread.
    found: Option<Receiver<Result<Vec<StreamInfo>, Error>>>,
    thread: Option<JoinHandle<()>>,
}

impl Listing {
    /// Starts the thread.
    ///
    /// # Errors
    /// If a thread cannot be started.
    pub(super) fn start(node: Node) -> std::io::Result<Self> {
        let (to, found) = sync_channel(1);
        let thread =
            std::thread::Builder::new().name("streams".to_owned()).spawn(move || look_up(&node, &to))?;
        Ok(Self { found: Some(found), thread: Some(thread) })
    }

    /// Returns the streams if they were looked up since the last call.
    ///
    /// # Errors
    /// If they cannot be listed any more.
    pub(super) fn take(&self) -> Result<Option<Vec<StreamInfo>>, Error> {
        self.found.as_ref().and_then(|found| found.try_recv().ok()).transpose()
    }
}

impl Drop for Listing {
    fn drop(&mut self) {
        self.found = None;
        if let Some(thread) = self.thread.take() {
            thread.thread().unpark();
            // A thread that panicked has reported it.
            let _ = thread.join();
        }
    }
}

/// Looks up the streams until nothing receives them.
fn look_up(node: &Node, to: &SyncSender<Result<Vec<StreamInfo>, Error>>) {
    while to.send(node.streams()).is_ok() {
        std::thread::park_timeout(LOOK);
    }
}
