//! [`Room`]: limits the shared memory for streams of another machine.
//!
//! Anyone who can reach the port can announce streams. Each stream that is opened here takes a pool in `/dev/shm`,
//! which the simulators on this machine need as well. So their total memory and their number are limited. Where the
//! memory is small, pools become smaller before streams are left out.

use super::wire;
use belvedere_bridge::StreamSpec;
use rustix::process::{Resource, getrlimit};
use std::time::{Duration, Instant};

/// Most streams that are opened, however small they are.
const MAX_STREAMS: usize = 256;
/// Upper bounds on the open files of a stream, and of everything else.
const FILES: usize = 12;
const OTHER_FILES: usize = 100;
/// Upper bound on the bytes that a stream takes in addition to its pool: bookkeeping, queues and connections.
const BOOKS: u64 = 256 << 10;
/// Largest pool in the second attempt, and the limit below which cutting is not worth it, in bytes.
const LARGEST: u64 = 128 << 20;
const SMALLEST: u64 = 64 << 10;
/// Shortest time between two warnings, because streams are announced once a second.
const QUIET: Duration = Duration::from_secs(60);

/// The limit of memory and streams.
pub(super) struct Room {
    /// Most bytes that all streams together may take.
    memory: u64,
    streams: usize,
    last_warning: Option<Instant>,
}

/// The memory taken by open streams.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Taken {
    pub(super) streams: usize,
    pub(super) bytes: u64,
}

/// The reason why a stream does not fit.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
pub(super) enum Full {
    #[error(
        "its frames need {} of shared memory, but only {} of the {} for the other machine's streams are left; name the topics that you need, or allow more with --memory",
        mib(*.needed), mib(*.left), mib(*.most)
    )]
    Memory { needed: u64, left: u64, most: u64 },
    #[error(
        "{0} streams of the other machine are open, which is the limit; name the topics that you need, or allow more open files (ulimit -n) for up to {MAX_STREAMS}"
    )]
    Streams(usize),
}

fn mib(bytes: u64) -> String {
    format!("{:.1} MiB", bytes as f64 / f64::from(1 << 20))
}

impl Room {
    /// Creates a limit of this many bytes, and as many streams as this process may open files for.
    pub(super) fn new(memory: u64) -> Self {
        let files = getrlimit(Resource::Nofile).current.map_or(usize::MAX, |files| files as usize);
        let streams = (files.saturating_sub(OTHER_FILES) / FILES).min(MAX_STREAMS);
        Self { memory, streams, last_warning: None }
    }

    /// Returns the limit of each pool with which these streams fit beside those in `taken`; `None` if they fit with full
    /// pools. If they do not fit with the smallest pools, it returns that limit.
    pub(super) fn largest_pool(&self, taken: Taken, streams: &[&StreamSpec]) -> Option<u64> {
        let fit =
            |bytes: Option<u64>| {
                let mut taken = taken;
                for &spec in streams {
                    taken.add(bytes.map_or_else(
                        || wire::pool_bytes(spec),
                        |bytes| wire::pool_bytes(&spec.within(bytes)),
                    ));
                }
                taken.bytes <= self.memory
            };
        if fit(None) {
            return None;
        }
        let mut bytes = LARGEST;
        while bytes > SMALLEST && !fit(Some(bytes)) {
            bytes /= 2;
        }
        Some(bytes)
    }

    /// Returns the memory of all streams together, for messages.
    pub(super) fn memory_text(&self) -> String {
        mib(self.memory)
    }

    /// Adds a stream with a pool of this many bytes to `taken`, if there is room for it.
    pub(super) fn take(&self, taken: &mut Taken, pool_bytes: u64) -> Result<(), Full> {
        let needed = pool_bytes.saturating_add(BOOKS);
        let left = self.memory.saturating_sub(taken.bytes);
        if taken.streams >= self.streams {
            return Err(Full::Streams(self.streams));
        }
        if needed > left {
            return Err(Full::Memory { needed, left, most: self.memory });
        }
        taken.add(pool_bytes);
        Ok(())
    }

    /// Logs a warning about a stream that is not opened, and the number of others, unless one was logged recently.
    pub(super) fn warn(&mut self, topic: &str, why: &dyn std::fmt::Display, others: usize) {
        if self.last_warning.is_some_and(|last| last.elapsed() < QUIET) {
            return;
        }
        self.last_warning = Some(Instant::now());
        let more = if others > 0 { format!(" (and {others} others are not opened)") } else { String::new() };
        tracing::warn!(topic, "a stream of the other machine is not opened: {why}{more}");
    }
}

impl Taken {
    /// Counts a stream that is open.
    pub(super) fn add(&mut self, pool_bytes: u64) {
        self.streams += 1;
        self.bytes = self.bytes.saturating_add(pool_bytes).saturating_add(BOOKS);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_streams_together_have_a_bound() {
        let room = Room { streams: MAX_STREAMS, ..Room::new(100 << 20) };
        let mut taken = Taken::default();
        let full = Full::Memory { needed: (100 << 20) + BOOKS, left: 100 << 20, most: 100 << 20 };
        assert_eq!(room.take(&mut taken, 100 << 20), Err(full));
        assert_eq!(taken.streams, 0);
        while room.take(&mut taken, 7 << 20).is_ok() {}
        assert!(taken.bytes <= 100 << 20 && taken.bytes + (8 << 20) > 100 << 20, "{taken:?}");
        // A smaller stream still fits.
        room.take(&mut taken, 0).unwrap();
        assert!(matches!(room.take(&mut taken, u64::MAX), Err(Full::Memory { .. })));
        let words = room.take(&mut taken, 7 << 20).unwrap_err().to_string();
        assert!(words.contains("7.2 MiB") && words.contains("--memory"), "{words}");
    }

    #[test]
    fn pools_become_smaller_before_streams_are_left_out() {
        use belvedere_bridge::{Encoding, Kind};
        let image = |topic: &str, bytes| StreamSpec::new(topic, Kind::Image, Encoding::Rgb8, bytes);
        // The streams of a Kinect.
        let streams = [
            image("rgb", 921_600),
            image("depth", 1_228_800),
            image("points", 9_830_400),
            image("scan", 2560),
        ];
        let all: Vec<&StreamSpec> = streams.iter().collect();
        let full: u64 = streams.iter().map(wire::pool_bytes).sum();
        assert_eq!(Room::new(full + 4 * BOOKS).largest_pool(Taken::default(), &all), None);
        let room = Room::new(128 << 20);
        let bytes = room.largest_pool(Taken::default(), &all).expect("a limit");
        let mut taken = Taken::default();
        for spec in &streams {
            room.take(&mut taken, wire::pool_bytes(&spec.within(bytes))).unwrap();
        }
        // Small pools stay as they are, and the next larger limit would be too large.
        assert_eq!(streams[3].within(bytes), streams[3]);
        let twice: u64 = streams.iter().map(|spec| wire::pool_bytes(&spec.within(2 * bytes)) + BOOKS).sum();
        assert!(twice > 128 << 20, "{twice}");
        // Streams that are already open leave less.
        let later = room.largest_pool(Taken { streams: 1, bytes: 64 << 20 }, &all).expect("a limit");
        assert!(later < bytes, "{later} {bytes}");
        // It ends if nothing fits.
        assert_eq!(Room::new(0).largest_pool(Taken::default(), &all), Some(SMALLEST));
    }

    #[test]
    fn streams_that_need_almost_no_memory_are_counted() {
        let room = Room::new(u64::MAX);
        let mut taken = Taken::default();
        while room.take(&mut taken, 0).is_ok() {}
        assert!((1..=MAX_STREAMS).contains(&taken.streams), "{taken:?}");
        assert_eq!(room.take(&mut taken, 0), Err(Full::Streams(taken.streams)));
    }
}
