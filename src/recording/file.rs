//! [`NewFile`]: a file that gets its final name only when it is complete.

use super::RecordingError;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A file that gets its name only when it is complete. Until then `.active` is appended to the name.
#[derive(Debug)]
pub struct NewFile {
    file: File,
    active: PathBuf,
    path: PathBuf,
}

impl NewFile {
    /// Creates a file. An existing file is replaced only with `replace`, and only when this one is complete. An
    /// `.active` file left by a killed process is also replaced only with `replace`, but at once.
    ///
    /// # Errors
    /// [`io::ErrorKind::AlreadyExists`], [`RecordingError::Unfinished`], [`RecordingError::BeingWritten`], and those of
    /// the system.
    pub fn create(path: &Path, replace: bool) -> Result<Self, RecordingError> {
        if !replace && path.exists() {
            return Err(io::Error::from(io::ErrorKind::AlreadyExists).into());
        }
        let mut active = path.as_os_str().to_owned();
        active.push(".active");
        let active = PathBuf::from(active);
        let (file, is_new) = match OpenOptions::new().write(true).create_new(true).open(&active) {
            Ok(file) => (file, true),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                (OpenOptions::new().write(true).open(&active)?, false)
            }
            Err(error) => return Err(error.into()),
        };
        // The process that writes the file holds the lock, and the system releases it when the process ends. Where
        // files cannot be locked, existing files are assumed to be finished.
        if let Err(TryLockError::WouldBlock) = file.try_lock() {
            return Err(RecordingError::BeingWritten);
        }
        if !is_new {
            if !replace {
                return Err(RecordingError::Unfinished { active });
            }
            file.set_len(0)?;
        }
        Ok(Self { file, active, path: path.to_owned() })
    }

    /// Removes the file, because nothing useful was written.
    pub(super) fn discard(self) {
        if let Err(error) = fs::remove_file(&self.active) {
            tracing::warn!("{}: {error}", self.active.display());
        }
    }

    /// Returns the path of the file until it is complete.
    pub fn active(&self) -> &Path {
        &self.active
    }

    /// Returns a second handle of the file, for writing.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn writer(&self) -> io::Result<impl Write + Send + use<>> {
        // A chunk is written at once; its index and the heads of records are small and need the buffer.
        Ok(io::BufWriter::with_capacity(1 << 18, self.file.try_clone()?))
    }

    /// Completes the file and gives it its name.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn complete(self) -> io::Result<()> {
        self.file.sync_all()?;
        fs::rename(&self.active, &self.path)
    }
}
