//! What can be wrong with a recording.

use belvedere_bridge::FrameError;

/// Why a recording cannot be written or read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// The system's words.
    #[error("{0}")]
    Io(#[from] std::io::Error),
    /// Another process writes it now.
    #[error("another process is writing it; choose another name, or end that one")]
    BeingWritten,
    /// What a process that was killed has left.
    #[error(
        "{} is there, from a recording that was not ended; it can be played under that name: rename it, or replace it \
         with --force",
        active.display()
    )]
    Unfinished {
        /// Where it is.
        active: std::path::PathBuf,
    },
    /// A replay was to begin after the end.
    #[error("it lasts {lasts_s:.3} s only, and was to be played from {start_s:.3} s on")]
    TooShort {
        /// Seconds from its first frame to its last.
        lasts_s: f64,
        /// Where it was to begin, seconds.
        start_s: f64,
    },
    /// It does not begin as MCAP does.
    #[error("it is no MCAP file")]
    NotMcap,
    /// It is MCAP, and broken.
    #[error("it is broken: {0}")]
    Broken(String),
    /// It ends before its end.
    #[error("it ends in the middle, as after a crash or while it is still being written")]
    Cut,
    /// A frame that nobody could read.
    #[error("a frame of /{topic} is wrong: {error}")]
    Frame {
        /// Without a leading slash.
        topic: String,
        /// What.
        error: FrameError,
    },
    /// MCAP, and not of ours.
    #[error("it has no frames of Belvedere, which a replay needs; it was written by \"{library}\"")]
    Foreign {
        /// What its header says.
        library: String,
    },
    /// A consumer that is waited for has not come, or follows too few streams.
    #[error("\"{name}\" did not come within {:.1} s; start it within that time, or raise --patience", waited.as_secs_f64())]
    ConsumerMissing {
        /// Which.
        name: String,
        /// How long was waited.
        waited: std::time::Duration,
    },
    /// A stream cannot be opened or sent to.
    #[error(transparent)]
    Bridge(#[from] belvedere_bridge::Error),
}

impl RecordingError {
    /// Whether shared memory has no room for a stream.
    pub(super) fn lacks_memory(&self) -> bool {
        matches!(self, Self::Bridge(belvedere_bridge::Error::SharedMemoryTooSmall { .. }))
    }
}

impl From<mcap::McapError> for RecordingError {
    fn from(error: mcap::McapError) -> Self {
        use mcap::McapError as E;
        match error {
            E::Io(error) => Self::Io(error),
            E::BadMagic => Self::NotMcap,
            E::UnexpectedEof | E::UnexpectedEoc => Self::Cut,
            error => Self::Broken(error.to_string()),
        }
    }
}
