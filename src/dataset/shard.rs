//! Reads and writes samples in a tar file, in the layout of `WebDataset`: the files of a sample are adjacent, and the
//! part of their names before the first dot is the sample's number.

use super::DatasetError;
use super::fields::Field;
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, BufReader, BufWriter, Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// A file that is written completely or not at all: it is written under a name that begins with a dot, synchronised to
/// the disk, then renamed.
struct WholeFile {
    path: PathBuf,
    temporary: PathBuf,
    file: Option<File>,
}

impl WholeFile {
    /// Creates the temporary file.
    fn create(path: &Path) -> Result<Self, DatasetError> {
        static COUNT: AtomicU64 = AtomicU64::new(0);
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        // Processes on several machines may write the same shard. They write the same bytes, so it does not matter
        // which of them renames its file last.
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

    /// Synchronises the file to the disk and gives it its name.
    fn finish(mut self) -> Result<(), DatasetError> {
        let path = self.path.clone();
        self.file().and_then(|file| file.sync_all()).map_err(failed(&path))?;
        self.file = None;
        let renamed = fs::rename(&self.temporary, &path);
        match renamed {
            // Another process was first, and has removed this temporary file.
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
        // After the renaming this file does not exist any more.
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

/// Writes a file completely or not at all.
pub(super) fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), DatasetError> {
    let mut file = WholeFile::create(path)?;
    file.write_all(bytes).map_err(failed(path))?;
    file.finish()
}

/// Removes temporary files of killed processes for files whose names begin with `begin`.
pub(super) fn sweep(folder: &Path, begin: &str) {
    let begin = format!(".{begin}");
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    for entry in entries.filter(|entry| entry.file_name().to_string_lossy().starts_with(&begin)) {
        let _ = fs::remove_file(entry.path());
    }
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
            // No time and no user, so that the bytes depend only on the sample.
            header.set_mode(0o644);
            header.set_mtime(0);
            header.set_uid(0);
            header.set_gid(0);
            let name = format!("{index:08}.{name}");
            self.tar.append_data(&mut header, name, &bytes[..]).map_err(failed(&self.path))?;
        }
        Ok(())
    }

    /// Completes the shard and gives it its name.
    pub(super) fn finish(self) -> Result<(), DatasetError> {
        let Self { path, tar } = self;
        let file = tar.into_inner().map_err(failed(&path))?;
        file.into_inner().map_err(|error| failed(&path)(error.into_error()))?.finish()
    }
}

/// Reads the samples of a shard, one after the other, with their files by name.
pub(super) fn read_shard(
    path: &Path,
    mut each: impl FnMut(u64, BTreeMap<String, Vec<u8>>) -> Result<(), DatasetError>,
) -> Result<(), DatasetError> {
    let unreadable = |source| DatasetError::Input { path: path.to_owned(), source };
    let file = BufReader::with_capacity(1 << 20, File::open(path).map_err(unreadable)?);
    let mut tar = tar::Archive::new(file);
    let mut sample: Option<(u64, BTreeMap<String, Vec<u8>>)> = None;
    for entry in tar.entries().map_err(unreadable)? {
        let mut entry = entry.map_err(unreadable)?;
        let name = entry.path().map_err(unreadable)?.to_string_lossy().into_owned();
        let key = name.split_once('.').and_then(|(index, field)| Some((index.parse::<u64>().ok()?, field)));
        let Some((index, field)) = key else {
            let what = format!("it contains '{name}', which belongs to no sample");
            return Err(DatasetError::Damaged { path: path.to_owned(), what });
        };
        let mut bytes = Vec::with_capacity(usize::try_from(entry.size()).unwrap_or(0).min(1 << 28));
        entry.read_to_end(&mut bytes).map_err(unreadable)?;
        if let Some((index, files)) = sample.take_if(|(of, _)| *of != index) {
            each(index, files)?;
        }
        let (_, files) = sample.get_or_insert_with(|| (index, BTreeMap::new()));
        files.insert(field.to_owned(), bytes);
    }
    sample.map_or(Ok(()), |(index, files)| each(index, files))
}
