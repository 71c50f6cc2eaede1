//! [`Sharing`]: opens a domain's files to a group as they are created.
//!
//! iceoryx2 creates every file for its owner alone, and its permissions show when the file is complete. Files are
//! created in many places, some while frames are sent. So a thread watches for new files with inotify and gives those
//! of this user to the group. A peer that is faster than the thread waits: iceoryx2 treats a file that it cannot open
//! as still being created, for half a second. The reverse, creating files open and closing them to others, would leave
//! a moment in which any user can open them.

use std::{
    collections::HashMap,
    fs, io,
    mem::MaybeUninit,
    os::{
        fd::{AsFd as _, AsRawFd as _, OwnedFd},
        unix::fs::{MetadataExt as _, PermissionsExt as _},
    },
    path::{Path, PathBuf},
    sync::Arc,
    thread::JoinHandle,
    time::{Duration, Instant},
};

use rustix::{
    event::{EventfdFlags, PollFd, PollFlags, eventfd, poll},
    fs::{
        AtFlags, FileType, Mode, OFlags,
        inotify::{CreateFlags, ReadFlags, Reader, WatchFlags, add_watch, init},
    },
    process::{Gid, geteuid},
};

use super::{
    Domain, Group,
    group::user,
    places::{Places, SHM, entries},
};
use crate::Error;

/// The mode of a group's directories: all members create and remove files there, and new files belong to the group at
/// once.
const DIRECTORY: u32 = 0o2770;

/// The watch, which runs until it is dropped.
#[derive(Debug)]
pub(crate) struct Sharing {
    files: Arc<Files>,
    stop: Arc<OwnedFd>,
    thread: Option<JoinHandle<()>>,
}

impl Sharing {
    /// Starts the watch.
    ///
    /// # Errors
    /// [`Error::Transport`] if the kernel has no watch or thread left.
    pub(crate) fn start(domain: &Domain, group: &Group, places: &Places) -> Result<Self, Error> {
        let failed = |error: rustix::io::Errno| {
            Error::transport(format!("sharing domain \"{domain}\" with group {}", group.name()), error)
        };
        let files = Arc::new(Files { places: places.clone(), gid: Gid::from_raw(group.gid()) });
        let mut watch = Watch {
            inotify: init(CreateFlags::CLOEXEC | CreateFlags::NONBLOCK).map_err(failed)?,
            directories: HashMap::new(),
        };
        for directory in [Path::new(SHM), &places.root, &places.nodes, &places.services] {
            watch.add(directory).map_err(failed)?;
        }
        let stop = Arc::new(eventfd(0, EventfdFlags::CLOEXEC).map_err(failed)?);
        let (of_thread, until) = (Arc::clone(&files), Arc::clone(&stop));
        let thread = std::thread::Builder::new()
            .name("belvedere-group".to_owned())
            .spawn(move || watch.run(&of_thread, &until))
            .map_err(|error| Error::transport("starting a thread", error))?;
        Ok(Self { files, stop, thread: Some(thread) })
    }

    /// Opens all existing files to the group.
    pub(crate) fn settle(&self) {
        self.files.share_all();
    }
}

impl Drop for Sharing {
    fn drop(&mut self) {
        let _ = rustix::io::write(&self.stop, &1_u64.to_ne_bytes());
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

#[derive(Debug)]
struct Files {
    places: Places,
    gid: Gid,
}

impl Files {
    fn share_all(&self) {
        for path in entries(&self.places.nodes) {
            self.share(&path);
        }
        for path in self.places.files() {
            self.share(&path);
        }
    }

    /// Gives a file of this user to the group; leaves all others as they are. If a file cannot be shared now, the
    /// process that fails to open it reports that.
    fn share(&self, path: &Path) {
        if let Err(error) = self.try_share(path) {
            tracing::debug!(path = %path.display(), %error, "not shared with the group");
        }
    }

    fn try_share(&self, path: &Path) -> io::Result<()> {
        // The descriptor keeps referring to this file even if its name changes: members of the group could replace it
        // by a link to another file of this user.
        let file =
            match rustix::fs::open(path, OFlags::PATH | OFlags::NOFOLLOW | OFlags::CLOEXEC, Mode::empty()) {
                Err(rustix::io::Errno::NOENT) => return Ok(()),
                file => file?,
            };
        let stat = rustix::fs::fstat(&file)?;
        if stat.st_uid != geteuid().as_raw() {
            return Ok(());
        }
        let mode = stat.st_mode & 0o7777;
        let shared = match FileType::from_raw_mode(stat.st_mode) {
            FileType::Directory => DIRECTORY,
            // A hard link may be another name of a private file: leave it.
            FileType::RegularFile if stat.st_nlink == 1 && self.is_complete(path, mode) => opened(mode),
            FileType::Socket => opened(mode),
            _ => return Ok(()),
        };
        // In this order, so that the previous group gets no access.
        if stat.st_gid != self.gid.as_raw() {
            rustix::fs::chownat(file.as_fd(), "", None, Some(self.gid), AtFlags::EMPTY_PATH)?;
        }
        if mode != shared {
            // By the descriptor, for the same reason as above.
            let name = format!("/proc/self/fd/{}", file.as_raw_fd());
            rustix::fs::chmod(name, Mode::from_raw_mode(shared))?;
        }
        Ok(())
    }

    /// Returns true if the permissions of a file show that it is complete. iceoryx2 judges by the same permissions, so
    /// a file must not be opened to peers earlier.
    fn is_complete(&self, path: &Path, mode: u32) -> bool {
        let parent = path.parent();
        let is_monitor = parent == Some(&self.places.nodes);
        let is_shared_memory = parent == Some(Path::new(SHM));
        if is_monitor || is_shared_memory {
            mode & 0o400 != 0
        } else {
            // Descriptions and tags are writable until they are complete.
            mode & 0o600 == 0o400
        }
    }
}

/// Extends the owner's read and write permissions to the group; others get none.
fn opened(mode: u32) -> u32 {
    mode & 0o700 | (mode & 0o600) >> 3
}

struct Watch {
    inotify: OwnedFd,
    directories: HashMap<i32, PathBuf>,
}

impl Watch {
    fn add(&mut self, directory: &Path) -> rustix::io::Result<()> {
        let what = WatchFlags::CREATE | WatchFlags::ATTRIB | WatchFlags::MOVED_TO | WatchFlags::ONLYDIR;
        let watch = add_watch(&self.inotify, directory, what)?;
        self.directories.insert(watch, directory.to_owned());
        Ok(())
    }

    fn run(mut self, files: &Files, stop: &OwnedFd) {
        files.share_all();
        loop {
            let mut waiting = [PollFd::new(&self.inotify, PollFlags::IN), PollFd::new(stop, PollFlags::IN)];
            match poll(&mut waiting, None) {
                Ok(_) | Err(rustix::io::Errno::INTR) => {}
                Err(_) => return,
            }
            if !waiting[1].revents().is_empty() {
                return;
            }
            self.read(files);
        }
    }

    fn read(&mut self, files: &Files) {
        let mut changed = Vec::new();
        let mut overflow = false;
        let mut buffer = [MaybeUninit::uninit(); 4096];
        let mut reader = Reader::new(&self.inotify, &mut buffer);
        while let Ok(event) = reader.next() {
            overflow |= event.events().contains(ReadFlags::QUEUE_OVERFLOW);
            if event.events().contains(ReadFlags::IGNORED) {
                self.directories.remove(&event.wd());
            }
            if let (Some(directory), Some(name)) = (self.directories.get(&event.wd()), event.file_name())
                && let Ok(name) = name.to_str()
            {
                changed.push((directory.join(name), event.events().contains(ReadFlags::ISDIR)));
            }
        }
        for (path, is_directory) in changed {
            if files.places.has_prefix(&path) {
                files.share(&path);
            } else if is_directory && path.parent() == Some(&files.places.nodes) && is_own(&path) {
                files.share(&path);
                // Files may have been created in it before the watch was added.
                let _ = self.add(&path);
                entries(&path)
                    .filter(|path| files.places.has_prefix(path))
                    .for_each(|path| files.share(&path));
            }
        }
        if overflow {
            files.share_all();
        }
    }
}

fn is_own(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok_and(|metadata| metadata.uid() == geteuid().as_raw())
}

/// Creates the group's directories, or checks that they belong to it.
///
/// # Errors
/// [`Error::InvalidGroup`] if this process does not belong to the group, [`Error::Permission`] if something that does
/// not belong to the group is in the way.
pub(crate) fn make_directories(places: &Places, group: &Group) -> Result<(), Error> {
    if !group.has_this_process() {
        return Err(Error::InvalidGroup {
            group: group.name().to_owned(),
            reason: format!(
                "{} is not in it; an administrator can change that: usermod -aG {} USER, then log in again",
                user(geteuid().as_raw()),
                group.name()
            ),
        });
    }
    [&places.root, &places.nodes, &places.services]
        .into_iter()
        .try_for_each(|directory| group_directory(directory, group))
}

/// Creates a directory of the group, or checks that it is one.
fn group_directory(path: &Path, group: &Group) -> Result<(), Error> {
    let deadline = Instant::now() + Duration::from_millis(500);
    loop {
        if let Err(error) = make_group_directory(path, group)
            // Another process may be removing the parent directory; the check below sees the result.
            && !matches!(error.kind(), io::ErrorKind::AlreadyExists | io::ErrorKind::NotFound)
        {
            return Err(Error::transport(format!("making {}", path.display()), error));
        }
        // Links are not followed: any user can create one in /tmp. Only a member, or root, can have given the directory
        // to the group.
        match fs::symlink_metadata(path) {
            Ok(found)
                if found.is_dir()
                    && found.gid() == group.gid()
                    && found.permissions().mode() & 0o077 == 0o070 =>
            {
                return Ok(());
            }
            // Another member may be creating or removing it at this moment.
            _ if Instant::now() < deadline => std::thread::sleep(Duration::from_millis(5)),
            found => {
                return Err(Error::Permission {
                    path: path.to_owned(),
                    owner: found.map_or_else(|_| "no user".to_owned(), |found| user(found.uid())),
                    remedy: format!(
                        "it must be a directory of group {name}, open to that group alone (chgrp {name}; chmod 2770); or its owner must remove it",
                        name = group.name()
                    ),
                });
            }
        }
    }
}

fn make_group_directory(path: &Path, group: &Group) -> io::Result<()> {
    rustix::fs::mkdir(path, Mode::RWXU)?;
    let directory = rustix::fs::open(
        path,
        OFlags::RDONLY | OFlags::DIRECTORY | OFlags::NOFOLLOW | OFlags::CLOEXEC,
        Mode::empty(),
    )?;
    rustix::fs::fchown(&directory, None, Some(Gid::from_raw(group.gid())))?;
    Ok(rustix::fs::fchmod(&directory, Mode::from_raw_mode(DIRECTORY))?)
}
