//! Samples in a tar file, in the layout of `WebDataset`: the files of a sample lie together, and what stands before the first
//! dot of their names is the sample's.

use super::DatasetError;
use super::fields::Field;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write as _};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// A file that is there whole or not at all: written under a name that begins with a dot, synchronised to the disk, then
/// renamed.
pub(super) struct WholeFile {
    path: PathBuf,
    temporary: PathBuf,
    file: Option<File>,
}

impl WholeFile {
    /// Begins one.
    pub(super) fn create(path: &Path) -> Result<Self, DatasetError> {
        static COUNT: AtomicU64 = AtomicU64::new(0);
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        // Processes of several machines may write the same shard; what they write is the same, so that the last one to
        // rename replaces nothing.
        let host = fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
        let (host, process) = (host.trim(), std::process::id());
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let temporary = path.with_file_name(format!(".{name}.{host}.{process}.{number}"));
        let file = File::create(&temporary).map_err(failed(&temporary))?;
        Ok(Self { path: path.to_owned(), temporary, file: Some(file) })
    }

    fn file(&mut self) -> io::Result<&mut File> {
        self.file.as_mut().ok_or_else(|| io::ErrorKind::NotFound.into())
    }

    /// Gives it its name, once all of it is on the disk.
    pub(super) fn finish(mut self) -> Result<(), DatasetError> {
        let path = self.path.clone();
        self.file().and_then(|file| file.sync_all()).map_err(failed(&path))?;
        self.file = None;
        let renamed = fs::rename(&self.temporary, &path);
        match renamed {
            // Another process was first, and has swept.
            Err(error) if error.kind() == io::ErrorKind::NotFound && path.is_file() => {}
            renamed => renamed.map_err(failed(&path))?,
        }
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        File::open(folder.unwrap_or(Path::new(".")))
            .and_then(|folder| folder.sync_all())
            .map_err(failed(&path))
    }
}

impl Drop for WholeFile {
    fn drop(&mut self) {
        // Renamed, it is not there any more.
        let _ = fs::remove_file(&self.temporary);
    }
}

impl io::Write for WholeFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file()?.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file()?.flush()
    }
}

/// Writes all of a file.
pub(super) fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), DatasetError> {
    let mut file = WholeFile::create(path)?;
    file.write_all(bytes).map_err(failed(path))?;
    file.finish()
}

fn failed(path: &Path) -> impl Fn(io::Error) -> DatasetError {
    move |source| DatasetError::Output { path: path.to_owned(), source }
}

/// A shard that is being written.
pub(super) struct ShardWriter {
    path: PathBuf,
    tar: tar::Builder<BufWriter<WholeFile>>,
}

impl ShardWriter {
    pub(super) fn create(path: &Path) -> Result<Self, DatasetError> {
        let file = BufWriter::with_capacity(1 << 20, WholeFile::create(path)?);
        Ok(Self { path: path.to_owned(), tar: tar::Builder::new(file) })
    }

    /// Adds a sample.
    pub(super) fn add(&mut self, index: u64, fields: &[Field]) -> Result<(), DatasetError> {
        for Field { name, bytes } in fields {
            let mut header = tar::Header::new_ustar();
            header.set_size(bytes.len() as u64);
            // Nothing of when, where and by whom.
            header.set_mode(0o644);
            header.set_mtime(0);
            header.set_uid(0);
            header.set_gid(0);
            let name = format!("{index:08}.{name}");
            self.tar.append_data(&mut header, name, &bytes[..]).map_err(failed(&self.path))?;
        }
        Ok(())
    }

    /// Ends it and gives it its name.
    pub(super) fn finish(self) -> Result<(), DatasetError> {
        let Self { path, tar } = self;
        let file = tar.into_inner().map_err(failed(&path))?;
        file.into_inner().map_err(|error| failed(&path)(error.into_error()))?.finish()
    }
}
