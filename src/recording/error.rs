//! Errors of recordings.

use belvedere_bridge::FrameError;

/// The reason why a recording cannot be written or read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// An error of the operating system.
    #[error("{0}")]
    Io(#[from] std::io::Error),
    /// Another process is writing it.
    #[error("another process is writing it; choose another name, or end that process")]
    BeingWritten,
    /// A killed process has left an unfinished recording.
    #[error(
        "{} exists, from a recording that was not finished; it can be played under that name: rename it, or replace it \
         with --force",
        active.display()
    )]
    Unfinished {
        /// Path of the unfinished recording.
        active: std::path::PathBuf,
    },
    /// A replay was to start after the end of the recording.
    #[error("it lasts only {lasts_s:.3} s, and was to be played from {start_s:.3} s")]
    TooShort {
        /// Seconds from its first frame to its last.
        lasts_s: f64,
        /// Requested start, seconds.
        start_s: f64,
    },
    /// The file does not start like an MCAP file.
    #[error("it is not an MCAP file")]
    NotMcap,
    /// The MCAP file is damaged.
    #[error("it is broken: {0}")]
    Broken(String),
    /// Damaged parts of the file were left out.
    #[error("it is damaged: {parts} left out")]
    Damaged {
        /// The number of parts, in words.
        parts: String,
    },
    /// The file is cut off.
    #[error("it ends in the middle, as after a crash or while it is still being written")]
    Cut,
    /// A frame is invalid.
    #[error("a frame of /{topic} is invalid: {error}")]
    Frame {
        /// Its topic, without a leading slash.
        topic: String,
        /// The reason why the frame is invalid.
        error: FrameError,
    },
    /// An MCAP file that Belvedere has not written.
    #[error("it has no frames of Belvedere, which a replay needs; it was written by \"{library}\"")]
    Foreign {
        /// The program that wrote it, according to its header.
        library: String,
    },
    /// A consumer given with --wait-for has not connected, or subscribes to too few streams.
    #[error("\"{name}\" did not come within {:.1} s; start it within that time, or raise --patience", waited.as_secs_f64())]
    ConsumerMissing {
        /// Name of the consumer.
        name: String,
        /// Time waited.
        waited: std::time::Duration,
    },
    /// A stream cannot be opened or sent to.
    #[error(transparent)]
    Bridge(#[from] belvedere_bridge::Error),
}

impl RecordingError {
    /// Returns true if shared memory has no room for a stream.
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
