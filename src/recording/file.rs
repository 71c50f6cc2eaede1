//! [`NewFile`]: nothing half-written under the final name.

use std::fs::{self, File};
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
    /// Begins a file. One that is there is replaced only with `replace`, and only when this one is complete.
    ///
    /// # Errors
    /// [`io::ErrorKind::AlreadyExists`], and the system's.
    pub fn create(path: &Path, replace: bool) -> io::Result<Self> {
        if !replace && path.exists() {
            return Err(io::ErrorKind::AlreadyExists.into());
        }
        let mut active = path.as_os_str().to_owned();
        active.push(".active");
        let active = PathBuf::from(active);
        Ok(Self { file: File::create(&active)?, active, path: path.to_owned() })
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
