//! [`Watch`]: removes shared memory whose creator was killed before it set the size, so that no process waits for it
//! for ever.
//!
//! iceoryx2 0.10 creates a segment in steps: an empty file without read permission, its size, its contents, its
//! permissions. A process that opens it in between waits until it is complete, for at most `creation_timeout`. But it
//! waits for an empty one without end (`MappingSizeIsZero` in `dynamic_storage/posix_shared_memory.rs`). Users other
//! than root are not affected, as they may not open the file. Processes of root, which are common in containers, hang
//! if one of them was killed between two of these system calls: when taking, when sending, and when cleaning up after
//! it.

use std::{
    collections::HashMap,
    ffi::OsStr,
    fs,
    mem::MaybeUninit,
    os::{
        fd::OwnedFd,
        unix::{ffi::OsStrExt as _, fs::MetadataExt as _},
    },
    path::{Path, PathBuf},
    sync::Arc,
    thread::JoinHandle,
    time::{Duration, Instant},
};

use rustix::{
    event::{EventfdFlags, PollFd, PollFlags, Timespec, eventfd, poll},
    fs::inotify::{CreateFlags, ReadFlags, Reader, WatchFlags, add_watch, init},
};

use super::{
    living::{identities, runs},
    places::{Places, SHM},
};

/// Interval between two checks of an empty file.
const INTERVAL: Duration = Duration::from_millis(200);
/// The number of checks after which an empty file is removed if one of the processes in its name has ended: a running
/// process sets the size within microseconds.
const LOOKS_AT_THE_DEAD: u32 = 2;
/// The number of checks if these processes are running: another process may have got the id of a dead one.
const LOOKS: u32 = 10;

/// A thread that removes files of a domain from shared memory if they stay empty, until it is dropped. A process that
/// waits for such a file finds it gone and continues. The thread sleeps until a file is created. (Polling four times a
/// second took 0.05 % of a core.)
#[derive(Debug)]
pub(crate) struct Watch {
    stop: Arc<OwnedFd>,
    thread: Option<JoinHandle<()>>,
}

impl Watch {
    /// Starts the watch. Returns `None` if this user cannot hang on an empty file, or if no watch or thread is
    /// available: then any other process of the domain removes the files.
    pub(crate) fn start(places: &Places) -> Option<Self> {
        if !rustix::process::geteuid().is_root() {
            return None;
        }
        let inotify = init(CreateFlags::CLOEXEC | CreateFlags::NONBLOCK).ok()?;
        add_watch(&inotify, SHM, WatchFlags::CREATE | WatchFlags::ONLYDIR).ok()?;
        let stop = Arc::new(eventfd(0, EventfdFlags::CLOEXEC).ok()?);
        let until = Arc::clone(&stop);
        let mut looks = Looks { places: places.clone(), empty: HashMap::new() };
        let thread = std::thread::Builder::new()
            .name("belvedere-unborn".to_owned())
            .spawn(move || looks.run(&inotify, &until))
            .ok()?;
        Some(Self { stop, thread: Some(thread) })
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        let _ = rustix::io::write(&self.stop, &1_u64.to_ne_bytes());
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// The files that were empty at the previous checks.
struct Looks {
    places: Places,
    /// Inode and number of checks of each file; the inode, since a file of the same name may be created again.
    empty: HashMap<PathBuf, (u64, u32)>,
}

impl Looks {
    fn run(&mut self, inotify: &OwnedFd, until: &OwnedFd) {
        // Files that existed before the watch.
        let mut next = self.look();
        loop {
            let left = next.map(|next| next.saturating_duration_since(Instant::now()));
            let left = left.map(|left| Timespec {
                tv_sec: left.as_secs().cast_signed(),
                tv_nsec: left.subsec_nanos().into(),
            });
            let mut fds = [PollFd::new(until, PollFlags::IN), PollFd::new(inotify, PollFlags::IN)];
            match poll(&mut fds, left.as_ref()) {
                Ok(_) | Err(rustix::io::Errno::INTR) => {}
                Err(_) => return,
            }
            if !fds[0].revents().is_empty() {
                return;
            }
            let is_news = self.is_news(inotify);
            if next.map_or(is_news, |next| Instant::now() >= next) {
                next = self.look();
            }
        }
    }

    /// Returns true if a file of the domain was created, or if events were lost.
    fn is_news(&self, inotify: &OwnedFd) -> bool {
        let mut buffer = [MaybeUninit::uninit(); 4096];
        let mut reader = Reader::new(inotify, &mut buffer);
        let mut is_news = false;
        while let Ok(event) = reader.next() {
            let name = event.file_name().map(|name| Path::new(OsStr::from_bytes(name.to_bytes())));
            is_news |= event.events().contains(ReadFlags::QUEUE_OVERFLOW)
                || name.is_some_and(|name| self.places.has_prefix(name));
        }
        is_news
    }

    /// Checks all files. Returns when to check again, if any is empty.
    fn look(&mut self) -> Option<Instant> {
        let mut empty = HashMap::new();
        for path in self.places.in_shared_memory() {
            let Ok(found) = fs::symlink_metadata(&path) else { continue };
            if !found.is_file() || found.len() > 0 {
                continue;
            }
            let inode = found.ino();
            let before = self.empty.get(&path).filter(|(then, _)| *then == inode);
            let looks = 1 + before.map_or(0, |(_, looks)| *looks);
            if looks >= LOOKS || looks >= LOOKS_AT_THE_DEAD && !makers_run(&path) {
                tracing::debug!(path = %path.display(), "removed an empty file, whose creator was killed");
                let _ = fs::remove_file(&path);
            } else {
                empty.insert(path, (inode, looks));
            }
        }
        self.empty = empty;
        (!self.empty.is_empty()).then(|| Instant::now() + INTERVAL)
    }
}

/// Returns true if all processes in a file's name are running: the two ends of a connection, or the creator of anything
/// else.
fn makers_run(file: &Path) -> bool {
    file.file_name().and_then(|name| name.to_str()).is_none_or(|name| identities(name).all(runs))
}
