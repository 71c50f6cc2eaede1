//! [`NewFile`]: nothing half-written under the final name.

use super::RecordingError;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A file that has its name only once it is complete: until then `.active` stands behind it.
#[derive(Debug)]
pub struct NewFile {
    file: File,
    active: PathBuf,
    path: PathBuf,
}

impl NewFile {
    /// Begins a file. One that is there is replaced only with `replace`, and only when this one is complete; so is what
    /// a killed process left under `.active`, which is lost at once.
    ///
    /// # Errors
    /// [`io::ErrorKind::AlreadyExists`], [`RecordingError::Unfinished`], [`RecordingError::BeingWritten`], and the
    /// system's.
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
        // Whoever writes it holds the lock, and the system takes it from the dead. Where files cannot be locked, those
        // that are there are taken to be finished.
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

    /// Nothing of worth was written: nothing is left of it.
    pub(super) fn discard(self) {
        if let Err(error) = fs::remove_file(&self.active) {
            tracing::warn!("{}: {error}", self.active.display());
        }
    }

    /// Where it is until it is complete.
    pub fn active(&self) -> &Path {
        &self.active
    }

    /// Another handle of the same file, for who writes it.
    ///
    /// # Errors
    /// The system's.
    pub fn writer(&self) -> io::Result<impl Write + Send + use<>> {
        // A chunk comes whole; its index and its records' heads are small.
        Ok(io::BufWriter::with_capacity(1 << 18, self.file.try_clone()?))
    }

    /// It is complete: gives it its name.
    ///
    /// # Errors
    /// The system's.
    pub fn complete(self) -> io::Result<()> {
        self.file.sync_all()?;
        fs::rename(&self.active, &self.path)
    }
}
