//! [`Watch`]: nobody waits for ever for shared memory whose maker was killed before it had a size.
//!
//! iceoryx2 0.10 makes a segment in steps: an empty file that nobody may read, its size, its contents, its permissions.
//! Who opens it in between waits until it is complete, for `creation_timeout` at most; but an empty one it waits for
//! without end (`MappingSizeIsZero` in `dynamic_storage/posix_shared_memory.rs`). Users other than root never come so
//! far, as they may not open the file. Processes of root, which containers are full of, hang when one of them was killed
//! between two of its system calls: in taking, in sending, in cleaning up after it.

use std::{
    collections::HashMap,
    fs,
    os::unix::fs::MetadataExt as _,
    path::{Path, PathBuf},
    sync::mpsc::{RecvTimeoutError, Sender, channel},
    thread::JoinHandle,
    time::Duration,
};

use crate::{
    places::{Places, SHM, entries},
    remains::{identities, runs},
};

/// From one look to the next: twenty microseconds each.
const INTERVAL: Duration = Duration::from_millis(250);
/// So many looks at an empty file are enough when one of the processes that it is named after is no more: a living one
/// needs some microseconds.
const LOOKS_AT_THE_DEAD: u32 = 2;
/// And so many when they live: another process may have got the number of the dead.
const LOOKS: u32 = 8;

/// Removes empty files of a domain from shared memory, from a thread of its own, until it is dropped: whoever waits for
/// one finds it gone, and goes on.
#[derive(Debug)]
pub(crate) struct Watch {
    /// Ends the thread when it is dropped.
    life: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Watch {
    /// `None` where nobody waits for ever, or no thread can be had.
    pub(crate) fn start(places: &Places) -> Option<Self> {
        if !rustix::process::geteuid().is_root() {
            return None;
        }
        let (life, end) = channel();
        let mut looks = Looks { places: places.clone(), empty: HashMap::new() };
        let watch = move || {
            while end.recv_timeout(INTERVAL) == Err(RecvTimeoutError::Timeout) {
                looks.look();
            }
        };
        let thread = std::thread::Builder::new().name("belvedere watch".to_owned()).spawn(watch).ok()?;
        Some(Self { life: Some(life), thread: Some(thread) })
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        drop(self.life.take());
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
    fn look(&mut self) {
        let mut empty = HashMap::new();
        for path in entries(Path::new(SHM)).filter(|path| self.places.has_prefix(path)) {
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
    }
}

/// Whether all processes run that a file is named after: the two ends of a connection, the maker of anything else.
fn makers_run(file: &Path) -> bool {
    file.file_name().and_then(|name| name.to_str()).is_none_or(|name| identities(name).all(runs))
}
