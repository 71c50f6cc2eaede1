//! [`Places`]: where a domain's files lie.

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

/// Where pools, connections and the books of streams lie: POSIX shared memory, as Linux shows it.
pub(crate) const SHM: &str = "/dev/shm";

/// The directories that hold a domain's files, and what the names of these begin with.
#[derive(Clone, Debug)]
pub(crate) struct Places {
    /// Of each file's name but those of the directories of nodes.
    pub(crate) prefix: String,
    /// Sockets to wake listeners with; and the next two.
    pub(crate) root: PathBuf,
    /// A lock that lives as long as the process for each node, and a directory of its tags.
    pub(crate) nodes: PathBuf,
    /// How each stream was made.
    pub(crate) services: PathBuf,
}

impl Places {
    pub(crate) fn new(domain: &Domain, config: &Config) -> Self {
        // Without a slash at the end, which would follow a link.
        let path = |text: String| Path::new(&text).components().collect();
        Self {
            prefix: domain.prefix(),
            root: path(config.global.root_path().to_string()),
            nodes: path(config.global.node_dir().to_string()),
            services: path(config.global.service_dir().to_string()),
        }
    }

    /// The domain's files in shared memory.
    pub(crate) fn in_shared_memory(&self) -> impl Iterator<Item = PathBuf> {
        entries(Path::new(SHM)).filter(|path| self.has_prefix(path))
    }

    /// Every file of the domain, with those of its nodes' directories.
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

    /// Whether a file's name is one of the domain's.
    pub(crate) fn has_prefix(&self, path: &Path) -> bool {
        path.file_name().is_some_and(|name| name.as_encoded_bytes().starts_with(self.prefix.as_bytes()))
    }

    /// The first file or directory in the way: one that another user owns, and that is not open to the group.
    ///
    /// Root could use the files of a domain without a group; but what root then makes, their owner could not.
    pub(crate) fn foreign(&self, group: Option<&Group>) -> Option<(PathBuf, u32)> {
        let own = rustix::process::geteuid().as_raw();
        let in_the_way = |path: &PathBuf| {
            // Links count themselves, not what they point to: it is their owner who may exchange them.
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

    /// Makes the root directory of a domain without a group, and checks that it and what is in it is this user's alone:
    /// files are believed for the directory that they are found in.
    ///
    /// # Errors
    /// [`Error::Permission`], [`Error::NotADirectory`].
    pub(crate) fn make_root_alone(&self, domain: &Domain) -> Result<(), Error> {
        // A failure is found when the directory is used. iceoryx2 makes the others in it.
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

    /// Closes the one file that iceoryx2 makes open to all: who can write it could cut it under a process that is
    /// just counting in it.
    pub(crate) fn close_to_others(&self) {
        for path in self.in_shared_memory() {
            if path.extension().is_some_and(|kind| kind == "global_mgmt") {
                // Not through a link: others can make files there.
                let flags = OFlags::RDWR | OFlags::NOFOLLOW | OFlags::CLOEXEC;
                if let Ok(file) = rustix::fs::open(&path, flags, Mode::empty()) {
                    let _ = rustix::fs::fchmod(file, Mode::RUSR | Mode::WUSR);
                }
            }
        }
    }

    /// Removes the directories that all domains share, if nothing is in them.
    pub(crate) fn remove_empty_directories(&self) -> std::io::Result<()> {
        fs::remove_dir(&self.nodes)?;
        fs::remove_dir(&self.services)?;
        fs::remove_dir(&self.root)
    }

    /// Makes the directories if they are not there, and locks them.
    ///
    /// # Errors
    /// What `make` finds.
    pub(crate) fn make_and_lock(&self, make: impl Fn() -> Result<(), Error>) -> Result<Option<Lock>, Error> {
        // A process that leaves may take them away between the two.
        for _ in 0..10 {
            make()?;
            if let Ok(lock) = self.lock() {
                return Ok(lock);
            }
        }
        Ok(None)
    }

    /// Locks the root directory against other processes of ours that join or leave, so that none takes what another is
    /// just making for remains. `None` when it cannot be had in time: the lock helps, but nobody must be stopped by a
    /// process that hangs with it.
    ///
    /// # Errors
    /// [`Gone`]: there is no such directory, or not any more.
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
        // Who held it before may have removed the directory.
        let locked = rustix::fs::fstat(&directory).map_err(|_| Gone)?;
        let is_it = fs::metadata(&self.root).is_ok_and(|now| now.ino() == locked.st_ino);
        if is_it { Ok(Some(Lock { _directory: directory })) } else { Err(Gone) }
    }
}

/// The root directory is not there (any more).
#[derive(Debug)]
pub(crate) struct Gone;

/// Held until it is dropped.
#[derive(Debug)]
pub(crate) struct Lock {
    _directory: std::os::fd::OwnedFd,
}

/// The paths in a directory; none when it cannot be read.
pub(crate) fn entries(directory: &Path) -> impl Iterator<Item = PathBuf> {
    fs::read_dir(directory).into_iter().flatten().flatten().map(|entry| entry.path())
}

/// What to say when something was refused: whose file is in the way, if one is.
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

/// A failure of iceoryx2, or what is behind it: another user's file.
pub(crate) fn failed(domain: &Domain, places: &Places, what: String, detail: impl std::fmt::Debug) -> Error {
    match places.foreign(domain.group()) {
        Some((path, uid)) => foreign(domain, places, path, uid),
        None => Error::transport(what, detail),
    }
}

/// The error for a file of another user.
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
