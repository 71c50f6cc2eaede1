//! [`Room`]: limits the streams' pools to the space in `/dev/shm`.
//!
//! A Kinect's streams, with places for 8 subscribers each, need 400 MB for frames, but a container's `/dev/shm` has 64
//! MiB. The streams of a model are first opened with full pools. If these do not fit, they are opened again with pools
//! of at most 128 MiB, then 64, 32 and so on. This cuts the largest pools first, and either all streams fit or none is
//! opened.

use belvedere_bridge::StreamSpec;
use std::cell::{Cell, RefCell};

/// Largest pool in the second attempt, in bytes.
const FIRST: u64 = 128 << 20;
/// Limit below which cutting is not worth it, in bytes.
const LAST: u64 = 64 << 10;

/// The limit of pools, and the streams whose pools it makes smaller.
#[derive(Debug, Clone, Default)]
pub struct Room {
    most_bytes: Cell<Option<u64>>,
    cut: RefCell<Vec<Cut>>,
    /// Streams that a warning was already logged for.
    warned: RefCell<Vec<Cut>>,
}

/// A stream with a smaller pool than it asked for.
#[derive(Debug, Clone, PartialEq)]
struct Cut {
    asked: StreamSpec,
    given: StreamSpec,
}

impl Room {
    /// Opens streams with `open`, which asks [`Room::cut`] for each. The pools are as large as all of them fit, and
    /// streams with smaller pools than usual are logged. `lacks_memory` returns true for errors that mean that the
    /// pools do not fit.
    ///
    /// # Errors
    /// The error of `open` if the streams do not fit even with the smallest pools, and all its other errors.
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

    /// Returns the specification with which a stream is opened.
    pub(crate) fn cut(&self, spec: &StreamSpec) -> StreamSpec {
        let Some(bytes) = self.most_bytes.get() else { return spec.clone() };
        let given = spec.within(bytes);
        if given != *spec {
            self.cut.borrow_mut().push(Cut { asked: spec.clone(), given: given.clone() });
        }
        given
    }

    fn warn(&self) {
        let mut warned = self.warned.borrow_mut();
        let mut cut = self.cut.take();
        cut.retain(|cut| !warned.contains(cut));
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
        warned.extend(cut);
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

    /// Opens streams of these sizes in a memory of this many bytes.
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
        // Streams that are opened later get the same limit, or a lower one.
        let late = room.fit(RigError::lacks_memory, || open(&room, 20_000_000, &[1_000_000])).unwrap();
        assert!(late[0].max_subscribers < 7);
    }

    #[test]
    fn streams_that_do_not_fit_at_all_are_an_error_and_leave_no_limit() {
        let room = Room::default();
        let refused =
            room.fit(RigError::lacks_memory, || open(&room, 30_000_000, &[10_000_000])).unwrap_err();
        assert!(matches!(refused, RigError::Bridge(Error::SharedMemoryTooSmall { .. })), "{refused}");
        assert_eq!(room.cut(&StreamSpec::structs("clock", Kind::Clock, 1)).max_subscribers, 8);
        assert_eq!(room.most_bytes.get(), None);
    }
}
