//! [`Room`]: pools as large as `/dev/shm` has room for.
//!
//! A Kinect's streams, each with places for 8 subscribers, are made for 400 MB of frames, and `/dev/shm` of a container
//! has 64 MiB. So whoever is mounted is opened with whole pools; if they do not fit, again with pools of at most 128 MiB,
//! 64, 32 and so on: the largest are cut first, and all streams fit beside each other or none is opened.

use belvedere_bridge::StreamSpec;
use std::cell::{Cell, RefCell};

/// The largest pool of the second attempt, bytes.
const FIRST: u64 = 128 << 20;
/// Below this nothing is worth cutting.
const LAST: u64 = 64 << 10;

/// How large a stream's pool may be, and which streams have a smaller one for it.
#[derive(Debug, Clone, Default)]
pub struct Room {
    most_bytes: Cell<Option<u64>>,
    cut: RefCell<Vec<Cut>>,
    /// Those that were warned of already.
    told: RefCell<Vec<Cut>>,
}

/// A stream with less than it asked for.
#[derive(Debug, Clone, PartialEq)]
struct Cut {
    asked: StreamSpec,
    given: StreamSpec,
}

impl Room {
    /// Opens streams with `open`, which asks [`Room::cut`] for each, with pools as large as fit beside each other, and
    /// warns of those that are smaller than usual. `lacks_memory` tells which errors mean that they do not fit.
    ///
    /// # Errors
    /// What `open` says when they do not fit in the least size, and anything else that it says.
    pub(crate) fn fit<T, E>(
        &self,
        lacks_memory: impl Fn(&E) -> bool,
        mut open: impl FnMut() -> Result<T, E>,
    ) -> Result<T, E> {
        let before = self.most_bytes.get();
        loop {
            self.cut.borrow_mut().clear();
            let most_bytes = self.most_bytes.get();
            match open() {
                Err(error) if lacks_memory(&error) && most_bytes.is_none_or(|bytes| bytes > LAST) => {
                    self.most_bytes.set(Some(most_bytes.map_or(FIRST, |bytes| bytes / 2)));
                }
                Err(error) => {
                    self.most_bytes.set(before);
                    return Err(error);
                }
                Ok(opened) => {
                    self.warn();
                    return Ok(opened);
                }
            }
        }
    }

    /// What a stream is made with.
    pub(crate) fn cut(&self, spec: &StreamSpec) -> StreamSpec {
        let Some(bytes) = self.most_bytes.get() else { return spec.clone() };
        let given = spec.within(bytes);
        if given != *spec {
            self.cut.borrow_mut().push(Cut { asked: spec.clone(), given: given.clone() });
        }
        given
    }

    fn warn(&self) {
        let mut told = self.told.borrow_mut();
        let mut cut = self.cut.take();
        cut.retain(|cut| !told.contains(cut));
        if cut.is_empty() {
            return;
        }
        let missing: u64 =
            cut.iter().map(|Cut { asked, given }| asked.pool_bytes() - given.pool_bytes()).sum();
        let streams: Vec<String> = cut.iter().map(Cut::words).collect();
        tracing::warn!(
            "/dev/shm is too small for all the consumers that streams usually have room for: {}; for all of them it needs {} MiB more (docker run --shm-size, mount -o remount,size=...)",
            streams.join("; "),
            missing.div_ceil(1 << 20)
        );
        told.extend(cut);
    }
}

impl Cut {
    fn words(&self) -> String {
        let consumers = |count| if count == 1 { "consumer" } else { "consumers" };
        let Self { asked, given } = self;
        let count = given.max_subscribers;
        let fewer = if given.buffer < asked.buffer {
            format!(", and keeps {} instead of {} frames waiting for it", given.buffer, asked.buffer)
        } else {
            String::new()
        };
        format!(
            "{} has room for {count} {} instead of {}{fewer}",
            given.topic.trim_start_matches('/'),
            consumers(count),
            asked.max_subscribers
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rig::RigError;
    use belvedere_bridge::{Encoding, Error, Kind};

    /// Opens streams of these sizes in a memory of so many bytes.
    fn open(room: &Room, free: u64, sizes: &[usize]) -> Result<Vec<StreamSpec>, RigError> {
        let mut left = free;
        let specs = sizes.iter().map(|&size| {
            let spec = room.cut(&StreamSpec::new("image", Kind::Image, Encoding::Mono8, size));
            let needed = spec.pool_bytes();
            left = left.checked_sub(needed).ok_or(Error::SharedMemoryTooSmall {
                topic: "image".to_owned(),
                needed_mib: needed >> 20,
                free_mib: left >> 20,
            })?;
            Ok(spec)
        });
        specs.collect()
    }

    #[test]
    fn the_largest_pools_are_cut_first() {
        let room = Room::default();
        let sizes = [100, 1_000_000, 10_000_000];
        let all = room.fit(RigError::lacks_memory, || open(&room, 1 << 30, &sizes)).unwrap();
        assert!(all.iter().all(|spec| spec.max_subscribers == 8 && spec.buffer == 2));
        let room = Room::default();
        let some = room.fit(RigError::lacks_memory, || open(&room, 90_000_000, &sizes)).unwrap();
        assert_eq!(some.iter().map(|spec| spec.max_subscribers).collect::<Vec<_>>(), [8, 7, 1]);
        // Who comes later is cut as much, or more.
        let late = room.fit(RigError::lacks_memory, || open(&room, 20_000_000, &[1_000_000])).unwrap();
        assert!(late[0].max_subscribers < 7);
    }

    #[test]
    fn what_does_not_fit_at_all_is_told_and_forgotten() {
        let room = Room::default();
        let refused =
            room.fit(RigError::lacks_memory, || open(&room, 30_000_000, &[10_000_000])).unwrap_err();
        assert!(matches!(refused, RigError::Bridge(Error::SharedMemoryTooSmall { .. })), "{refused}");
        assert_eq!(room.cut(&StreamSpec::structs("clock", Kind::Clock, 1)).max_subscribers, 8);
        assert_eq!(room.most_bytes.get(), None);
    }
}
