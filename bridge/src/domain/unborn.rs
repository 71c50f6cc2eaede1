//! [`Watch`]: nobody waits for ever for shared memory whose maker was killed before it had a size.
//!
//! iceoryx2 0.10 makes a segment in steps: an empty file that nobody may read, its size, its contents, its permissions.
//! Who opens it in between waits until it is complete, for `creation_timeout` at most; but an empty one it waits for
//! without end (`MappingSizeIsZero` in `dynamic_storage/posix_shared_memory.rs`). Users other than root never come so
//! far, as they may not open the file. Processes of root, which containers are full of, hang when one of them was killed
//! between two of its system calls: in taking, in sending, in cleaning up after it.

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

/// From one look at an empty file to the next.
const INTERVAL: Duration = Duration::from_millis(200);
/// So many looks are enough when one of the processes that a file is named after is no more: a living one needs some
/// microseconds to give it a size.
const LOOKS_AT_THE_DEAD: u32 = 2;
/// And so many when they live: another process may have got the number of the dead.
const LOOKS: u32 = 10;

/// Removes files of a domain that stay empty from shared memory, from a thread of its own, until it is dropped: whoever
/// waits for one finds it gone, and goes on. The thread sleeps until a file is made. (Four looks a second instead took
/// 0.05 % of a core.)
#[derive(Debug)]
pub(crate) struct Watch {
    stop: Arc<OwnedFd>,
    thread: Option<JoinHandle<()>>,
}

impl Watch {
    /// `None` where nobody waits for ever; and where no watch or thread can be had: any other process of the domain does.
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

/// What was empty at the looks until now.
struct Looks {
    places: Places,
    /// The inode, as the same name may be made again, and how often it was seen.
    empty: HashMap<PathBuf, (u64, u32)>,
}

impl Looks {
    fn run(&mut self, inotify: &OwnedFd, until: &OwnedFd) {
        // What was there before the watch.
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

    /// Whether a file of the domain was made, or more than can be told.
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

    /// When to look again, if it need be.
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
                tracing::debug!(path = %path.display(), "its maker was killed: removed");
                let _ = fs::remove_file(&path);
            } else {
                empty.insert(path, (inode, looks));
            }
        }
        self.empty = empty;
        (!self.empty.is_empty()).then(|| Instant::now() + INTERVAL)
    }
}

/// Whether all processes run that a file is named after: the two ends of a connection, the maker of anything else.
fn makers_run(file: &Path) -> bool {
    file.file_name().and_then(|name| name.to_str()).is_none_or(|name| identities(name).all(runs))
}
