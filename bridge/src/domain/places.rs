//! [`Places`]: the paths of a domain's files.

use std::{
    fs,
    os::unix::fs::{DirBuilderExt as _, MetadataExt as _},
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use iceoryx2::prelude::Config;
use rustix::fs::{FlockOperation, Mode, OFlags};

use super::{Domain, Group, group::user};
use crate::Error;

/// The directory of pools, connections and the dynamic parts of streams: POSIX shared memory, as Linux mounts it.
pub(crate) const SHM: &str = "/dev/shm";

/// The directories that hold a domain's files, and the prefix of the files' names.
#[derive(Clone, Debug)]
pub(crate) struct Places {
    /// The prefix of every file name, except for the directories of nodes.
    pub(crate) prefix: String,
    /// The root directory: the sockets that wake listeners, and the next two directories.
    pub(crate) root: PathBuf,
    /// For each node, a lock that its process holds, and a directory of its tags.
    pub(crate) nodes: PathBuf,
    /// The static configuration of each stream.
    pub(crate) services: PathBuf,
}

impl Places {
    pub(crate) fn new(domain: &Domain, config: &Config) -> Self {
        // Without a trailing slash, which would follow a symbolic link.
        let path = |text: String| Path::new(&text).components().collect();
        Self {
            prefix: domain.prefix(),
            root: path(config.global.root_path().to_string()),
            nodes: path(config.global.node_dir().to_string()),
            services: path(config.global.service_dir().to_string()),
        }
    }

    /// Returns the domain's files in shared memory.
    pub(crate) fn in_shared_memory(&self) -> impl Iterator<Item = PathBuf> {
        entries(Path::new(SHM)).filter(|path| self.has_prefix(path))
    }

    /// Returns every file of the domain, including those in its nodes' directories.
    pub(crate) fn files(&self) -> Vec<PathBuf> {
        let mut files: Vec<PathBuf> = self.in_shared_memory().collect();
        for directory in [&self.root, &self.services, &self.nodes] {
            files.extend(entries(directory).filter(|path| self.has_prefix(path)));
        }
        for directory in entries(&self.nodes) {
            if directory.is_dir() {
                files.extend(entries(&directory).filter(|path| self.has_prefix(path)));
            }
        }
        files
    }

    /// Returns true if the file's name has the domain's prefix.
    pub(crate) fn has_prefix(&self, path: &Path) -> bool {
        path.file_name().is_some_and(|name| name.as_encoded_bytes().starts_with(self.prefix.as_bytes()))
    }

    /// Returns the first file or directory that another user owns and that is not open to the group, with its owner.
    ///
    /// Root is no exception: it could use another user's files, but that user could not use the files that root
    /// creates.
    pub(crate) fn foreign(&self, group: Option<&Group>) -> Option<(PathBuf, u32)> {
        let own = rustix::process::geteuid().as_raw();
        let in_the_way = |path: &PathBuf| {
            // Symbolic links are not followed: the owner of the link can redirect it.
            let found = fs::symlink_metadata(path).ok()?;
            let is_shared =
                group.is_some_and(|group| found.gid() == group.gid() && found.mode() & 0o040 != 0);
            (found.uid() != own && !is_shared).then(|| (path.clone(), found.uid()))
        };
        self.directories()
            .into_iter()
            .find_map(in_the_way)
            .or_else(|| self.files().iter().find_map(in_the_way))
    }

    fn directories(&self) -> [&PathBuf; 3] {
        [&self.root, &self.nodes, &self.services]
    }

    /// Creates the root directory of a domain without a group, and checks that it and its contents belong to this user
    /// alone: a file is trusted because of the directory it is in.
    ///
    /// # Errors
    /// [`Error::Permission`], [`Error::NotADirectory`].
    pub(crate) fn make_root_alone(&self, domain: &Domain) -> Result<(), Error> {
        // A failure shows when the directory is used. iceoryx2 creates the directories below it.
        let _ = fs::DirBuilder::new().mode(0o750).create(&self.root);
        if let Some((path, uid)) = self.foreign(None) {
            return Err(foreign(domain, self, path, uid));
        }
        for path in self.directories() {
            match fs::metadata(path) {
                Ok(found) if !found.is_dir() => return Err(Error::NotADirectory(path.clone())),
                Ok(found) if found.mode() & 0o022 != 0 => {
                    return Err(Error::Permission {
                        path: path.clone(),
                        owner: user(found.uid()),
                        remedy: format!(
                            "others may write in it, and could put files there that this process would believe: chmod 750 {}",
                            path.display()
                        ),
                    });
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Restricts the permissions of the one file that iceoryx2 creates writable for all: another user could truncate it
    /// while a process accesses it.
    pub(crate) fn close_to_others(&self) {
        for path in self.in_shared_memory() {
            if path.extension().is_some_and(|kind| kind == "global_mgmt") {
                // Do not follow links: other users can create files there.
                let flags = OFlags::RDWR | OFlags::NOFOLLOW | OFlags::CLOEXEC;
                if let Ok(file) = rustix::fs::open(&path, flags, Mode::empty()) {
                    let _ = rustix::fs::fchmod(file, Mode::RUSR | Mode::WUSR);
                }
            }
        }
    }

    /// Removes the directories that all domains share, if they are empty.
    pub(crate) fn remove_empty_directories(&self) -> std::io::Result<()> {
        fs::remove_dir(&self.nodes)?;
        fs::remove_dir(&self.services)?;
        fs::remove_dir(&self.root)
    }

    /// Creates the directories if they do not exist, and locks them.
    ///
    /// # Errors
    /// The errors of `make`.
    pub(crate) fn make_and_lock(&self, make: impl Fn() -> Result<(), Error>) -> Result<Option<Lock>, Error> {
        // A process that leaves may remove the directories between the two calls.
        for _ in 0..10 {
            make()?;
            if let Ok(lock) = self.lock() {
                return Ok(lock);
            }
        }
        Ok(None)
    }

    /// Locks the root directory against other Belvedere processes that join or leave, so that none of them removes
    /// files that another is creating.
    ///
    /// Returns `None` if the lock is not available in time: a process that hangs while it holds the lock must not block
    /// others.
    ///
    /// # Errors
    /// [`Gone`] if the directory does not exist, or was removed meanwhile.
    pub(crate) fn lock(&self) -> Result<Option<Lock>, Gone> {
        let flags = OFlags::RDONLY | OFlags::DIRECTORY | OFlags::NOFOLLOW | OFlags::CLOEXEC;
        let directory = match rustix::fs::open(&self.root, flags, Mode::empty()) {
            Err(rustix::io::Errno::NOENT) => return Err(Gone),
            Err(_) => return Ok(None),
            Ok(directory) => directory,
        };
        let deadline = Instant::now() + Duration::from_millis(500);
        while rustix::fs::flock(&directory, FlockOperation::NonBlockingLockExclusive).is_err() {
            if Instant::now() > deadline {
                return Ok(None);
            }
            std::thread::sleep(Duration::from_millis(2));
        }
        // The previous holder may have removed the directory.
        let locked = rustix::fs::fstat(&directory).map_err(|_| Gone)?;
        let is_it = fs::metadata(&self.root).is_ok_and(|now| now.ino() == locked.st_ino);
        if is_it { Ok(Some(Lock { _directory: directory })) } else { Err(Gone) }
    }
}

/// The error for a root directory that does not exist.
#[derive(Debug)]
pub(crate) struct Gone;

/// The lock on a domain's root directory, held until it is dropped.
#[derive(Debug)]
pub(crate) struct Lock {
    _directory: std::os::fd::OwnedFd,
}

/// Returns the paths in a directory; none if it cannot be read.
pub(crate) fn entries(directory: &Path) -> impl Iterator<Item = PathBuf> {
    fs::read_dir(directory).into_iter().flatten().flatten().map(|entry| entry.path())
}

/// Returns the error for a refused operation. It names the owner if another user's file is in the way.
pub(crate) fn refused(domain: &Domain, places: &Places, what: &str) -> Error {
    match places.foreign(domain.group()) {
        Some((path, uid)) => foreign(domain, places, path, uid),
        None => Error::Permission {
            path: places.root.clone(),
            owner: user(rustix::process::geteuid().as_raw()),
            remedy: format!(
                "{what} was refused; check the permissions of the files \"{}*\" there and in {SHM}",
                places.prefix
            ),
        },
    }
}

/// Returns the error for a failure of iceoryx2, or the cause behind it: another user's file.
pub(crate) fn failed(domain: &Domain, places: &Places, what: String, detail: impl std::fmt::Debug) -> Error {
    match places.foreign(domain.group()) {
        Some((path, uid)) => foreign(domain, places, path, uid),
        None => Error::transport(what, detail),
    }
}

/// Returns the error for a file of another user.
fn foreign(domain: &Domain, places: &Places, path: PathBuf, uid: u32) -> Error {
    let owner = user(uid);
    let remove = if path.is_dir() { "sudo rm -r" } else { "sudo rm" };
    let other_domain =
        if places.has_prefix(&path) { ", or choose another domain (--domain, BELVEDERE_DOMAIN)" } else { "" };
    let remedy = match domain.group() {
        Some(group) => format!(
            "it is not open to the group {name}; its owner must run with BELVEDERE_GROUP={name}, or remove it",
            name = group.name()
        ),
        None => format!(
            "its name is kept for the files of {you}, so its owner or an administrator must remove it: {remove} {path}; until then use the place of a group of yours (BELVEDERE_GROUP, in every process of domain \"{domain}\"){other_domain}",
            you = user(rustix::process::geteuid().as_raw()),
            path = path.display()
        ),
    };
    Error::Permission { path, owner, remedy }
}
