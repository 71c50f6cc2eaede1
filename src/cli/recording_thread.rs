//! The recorder beside a simulator in one process.

use super::error::CliError;
use super::follow::NAP;
use super::record::{RECORDER, finish, start};
use crate::recording::{Attachment, Recorder, RecorderOptions, RecordingError, about};
use belvedere_bridge::{Domain, Node};
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// How often new streams are looked for.
const LOOK: Duration = Duration::from_millis(500);

/// A recording that goes on beside this thread. Dropped, as by an error or a panic of the run, it is finished as well.
pub(super) struct RecordingThread {
    path: PathBuf,
    stop: Arc<AtomicBool>,
    /// None once it is finished.
    thread: Option<JoinHandle<Recorder>>,
}

impl RecordingThread {
    /// Begins to record all that is published in the domain now; `words` are added to those on how it came about, and files are kept in it.
    pub(super) fn start(
        domain: &Domain,
        path: &Path,
        replace: bool,
        words: BTreeMap<String, String>,
        attachments: Vec<Attachment>,
    ) -> Result<Self, CliError> {
        // A node of its own: by its name the simulation waits for it.
        let node = Node::open(domain, RECORDER)?;
        let about = about(domain).into_iter().chain(words).collect();
        let options = RecorderOptions { replace, about, attachments, ..RecorderOptions::default() };
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
                        // What is recorded already is not lost with it.
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

    /// Takes what still waits, and ends the file.
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
