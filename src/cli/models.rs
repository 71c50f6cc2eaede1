//! The models that the program contains. They are unpacked if no other folder has them.

use crate::description::models;
use rustix::process::geteuid;
use std::fs::{self, DirBuilder};
use std::io;
use std::os::unix::fs::{DirBuilderExt as _, MetadataExt as _};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use xxhash_rust::xxh3::Xxh3Default;

/// Files with their paths below the folder of the models.
pub type Files = &'static [(&'static str, &'static [u8])];

static FILES: OnceLock<Files> = OnceLock::new();

/// Registers the models that the program contains. They are unpacked when they are first needed.
pub(super) fn carry(files: Files) {
    let _ = FILES.set(files);
    models::carry(unpacked);
}

/// Returns the folder with the models, which are unpacked by the first call of a process.
fn unpacked() -> PathBuf {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    let files = FILES.get().copied().unwrap_or_default();
    FOLDER.get_or_init(|| unpack(files, &caches())).clone()
}

/// Returns the folders for cached files, the preferred one first.
fn caches() -> Vec<PathBuf> {
    let xdg = std::env::var_os("XDG_CACHE_HOME").map(PathBuf::from).filter(|folder| folder.is_absolute());
    let home = std::env::home_dir().filter(|home| home.is_absolute()).map(|home| home.join(".cache"));
    let cache = xdg.or(home).map(|folder| folder.join("belvedere"));
    let temporary = std::env::temp_dir().join(format!("belvedere-{}", geteuid().as_raw()));
    cache.into_iter().chain([temporary]).collect()
}

/// Unpacks the files in the first of these folders that this user can safely write to.
fn unpack(files: Files, caches: &[PathBuf]) -> PathBuf {
    let name = folder_name(files);
    let mut refused = Vec::new();
    for cache in caches {
        let folder = cache.join(&name);
        match make_private(cache).and_then(|()| write_missing(files, &folder)) {
            Ok(()) => return folder,
            Err(error) => refused.push(format!("{}: {error}", cache.display())),
        }
    }
    tracing::warn!(
        "the robots and worlds that the program carries cannot be unpacked ({}); set XDG_CACHE_HOME to a folder that \
         you may write to",
        refused.join("; ")
    );
    caches.first().map(|cache| cache.join(name)).unwrap_or_default()
}

/// Returns a name that depends on the files' contents, so that different versions of the program use different folders.
fn folder_name(files: Files) -> String {
    let mut hash = Xxh3Default::new();
    for (path, bytes) in files {
        hash.update(&(path.len() as u64).to_le_bytes());
        hash.update(path.as_bytes());
        hash.update(&(bytes.len() as u64).to_le_bytes());
        hash.update(bytes);
    }
    format!("models-{}-{:016x}", env!("CARGO_PKG_VERSION"), hash.digest())
}

/// Creates a folder that only this user can write to, or checks that an existing one is.
fn make_private(folder: &Path) -> io::Result<()> {
    make_folder(folder)?;
    let found = fs::symlink_metadata(folder)?;
    if !found.is_dir() || found.uid() != geteuid().as_raw() || found.mode() & 0o022 != 0 {
        return Err(io::Error::other("not a folder that only this user can write to"));
    }
    Ok(())
}

fn make_folder(folder: &Path) -> io::Result<()> {
    DirBuilder::new().recursive(true).mode(0o700).create(folder)
}

/// Writes the files that are missing or different. Each is replaced atomically, because other processes may be reading
/// it.
fn write_missing(files: Files, folder: &Path) -> io::Result<()> {
    for (path, bytes) in files {
        let path = folder.join(path);
        if fs::read(&path).is_ok_and(|there| there == *bytes) {
            continue;
        }
        if let Some(parent) = path.parent() {
            make_folder(parent)?;
        }
        let mut name = path.clone().into_os_string();
        name.push(format!(".{}", std::process::id()));
        let written = fs::write(&name, bytes).and_then(|()| fs::rename(&name, &path));
        if written.is_err() {
            let _ = fs::remove_file(&name);
        }
        written?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::fs::PermissionsExt as _;

    const FILES: Files = &[("a/b.world", b"one"), ("c.png", b"two")];

    #[test]
    fn what_is_changed_or_gone_is_written_again_and_nothing_else() {
        let cache = tempfile::tempdir().unwrap();
        let caches = [cache.path().join("belvedere")];
        let folder = unpack(FILES, &caches);
        let (kept, changed) = (folder.join("c.png"), folder.join("a/b.world"));
        assert_eq!(fs::read(&kept).unwrap(), b"two");
        let inode = fs::metadata(&kept).unwrap().ino();
        fs::write(&changed, "other").unwrap();
        assert_eq!(unpack(FILES, &caches), folder);
        assert_eq!(fs::read(&changed).unwrap(), b"one");
        assert_eq!(fs::metadata(&kept).unwrap().ino(), inode);
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 2);
        let other: Files = &[("a/b.world", b"one"), ("c.png", b"new")];
        assert_ne!(unpack(other, &caches), folder);
    }

    #[test]
    fn a_folder_that_others_can_write_to_is_passed_over() {
        let place = tempfile::tempdir().unwrap();
        let caches = ["open", "linked", "own"].map(|name| place.path().join(name));
        fs::create_dir(&caches[0]).unwrap();
        fs::set_permissions(&caches[0], fs::Permissions::from_mode(0o777)).unwrap();
        std::os::unix::fs::symlink(place.path(), &caches[1]).unwrap();
        assert!(unpack(FILES, &caches).starts_with(&caches[2]));
        assert_eq!(fs::read_dir(&caches[0]).unwrap().count(), 0);
    }
}
