//! [`RecordingThread`]: a recorder in the simulator's process.

use super::error::CliError;
use super::follow::NAP;
use super::record::{RECORDER, finish, start};
use crate::recording::{Attachment, Profile, Recorder, RecorderOptions, RecordingError, about};
use belvedere_bridge::{Domain, Node};
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Interval at which new streams are looked for.
const LOOK: Duration = Duration::from_millis(500);

/// A recorder in a thread of its own. Dropping it finishes the file as well, for example after an error or a panic of
/// the run.
pub(super) struct RecordingThread {
    path: PathBuf,
    stop: Arc<AtomicBool>,
    /// `None` once it is finished.
    thread: Option<JoinHandle<Recorder>>,
}

impl RecordingThread {
    /// Starts to record all streams in the domain. `words` are added to the description of the recording, and
    /// `attachments` are stored in the file.
    pub(super) fn start(
        domain: &Domain,
        path: &Path,
        profile: Profile,
        replace: bool,
        words: BTreeMap<String, String>,
        attachments: Vec<Attachment>,
    ) -> Result<Self, CliError> {
        // The recorder has its own node because the simulation waits for it by name.
        let node = Node::open(domain, RECORDER)?;
        let about = about(domain).into_iter().chain(words).collect();
        let options = RecorderOptions { profile, replace, about, attachments, ..RecorderOptions::default() };
        let mut recorder = start(node, path, &options)?;
        let stop = Arc::new(AtomicBool::new(false));
        let stopped = stop.clone();
        let thread = std::thread::Builder::new()
            .name("recorder".into())
            .spawn(move || {
                let mut next_look = Instant::now() + LOOK;
                while !stopped.load(Ordering::Relaxed) {
                    std::thread::sleep(NAP);
                    if Instant::now() >= next_look {
                        next_look = Instant::now() + LOOK;
                        // A panic here must not lose what is already recorded.
                        let look = AssertUnwindSafe(|| recorder.look());
                        if let Ok(Err(error)) = catch_unwind(look) {
                            tracing::warn!(%error, "new streams are not recorded");
                        }
                    }
                }
                recorder
            })
            .map_err(CliError::NoThread)?;
        Ok(Self { path: path.to_owned(), stop, thread: Some(thread) })
    }

    /// Records the frames that still wait, and completes the file.
    pub(super) fn finish(mut self) -> Result<(), CliError> {
        self.end()
    }

    fn end(&mut self) -> Result<(), CliError> {
        let Some(thread) = self.thread.take() else { return Ok(()) };
        self.stop.store(true, Ordering::Relaxed);
        let recorder = thread.join().map_err(|_| CliError::Recording {
            action: "write",
            path: self.path.clone(),
            source: Box::new(RecordingError::Broken("the recorder panicked".into())),
        })?;
        finish(recorder, &self.path, false)
    }
}

impl Drop for RecordingThread {
    fn drop(&mut self) {
        if let Err(error) = self.end() {
            tracing::error!("{error}");
        }
    }
}
