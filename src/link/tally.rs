//! Counts the frames that a link has carried and lost.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Most topics that are counted individually. Names come from the network; if there are too many, further ones are
/// counted together.
const MAX_TOPICS: usize = 4096;
const OTHERS: &str = "others";

/// The progress of a link.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LinkProgress {
    /// Number of connected machines.
    pub peers: usize,
    /// Number of announced streams.
    pub streams: usize,
    /// Number of these that are carried now, because they have subscribers.
    pub carried: usize,
    /// Frames carried, commands included.
    pub frames: u64,
    /// Bytes of their payloads.
    pub bytes: u64,
    /// Commands among them.
    pub commands: u64,
    /// Frames that were sent but not carried, because the network was too slow or interrupted.
    pub lost: u64,
    /// Messages from the network that were refused, because they were not frames of the stream.
    pub refused: u64,
}

/// The counts of one stream.
#[derive(Debug, Default)]
pub(super) struct Tally {
    pub(super) is_carried: AtomicBool,
    pub(super) frames: AtomicU64,
    pub(super) bytes: AtomicU64,
    pub(super) lost: AtomicU64,
    pub(super) refused: AtomicU64,
}

impl Tally {
    pub(super) fn carry(&self, bytes: usize) {
        self.frames.fetch_add(1, Ordering::Relaxed);
        self.bytes.fetch_add(bytes as u64, Ordering::Relaxed);
    }

    pub(super) fn lose(&self, frames: u64) {
        // Saturates, because numbers from the network may be arbitrarily large.
        let add = |lost: u64| Some(lost.saturating_add(frames));
        let _ = self.lost.fetch_update(Ordering::Relaxed, Ordering::Relaxed, add);
    }

    /// Counts a refused message. Logs a warning for the 1st, 10th, 100th … one.
    pub(super) fn refuse(&self, topic: &str, why: &dyn std::fmt::Display) {
        let refused = self.refused.fetch_add(1, Ordering::Relaxed) + 1;
        if refused == 10_u64.pow(refused.ilog10()) {
            tracing::warn!(topic, refused, "a message from the network was refused: {why}");
        }
    }
}

/// The tallies of all streams, including those that have ended.
#[derive(Debug, Default)]
pub(super) struct Tallies(Mutex<BTreeMap<String, (bool, Arc<Tally>)>>);

impl Tallies {
    /// Returns the tally of a stream, which continues an earlier one.
    pub(super) fn of(&self, topic: &str, is_command: bool) -> Arc<Tally> {
        let mut tallies = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let is_known = tallies.len() < MAX_TOPICS || tallies.contains_key(topic);
        let topic = if is_known { topic } else { OTHERS };
        tallies.entry(topic.to_owned()).or_insert_with(|| (is_command, Arc::default())).1.clone()
    }

    /// Returns the sum of all tallies. The caller adds the numbers of peers and streams.
    pub(super) fn sum(&self) -> LinkProgress {
        let mut sum = LinkProgress::default();
        for (is_command, tally) in self.0.lock().unwrap_or_else(PoisonError::into_inner).values() {
            let frames = tally.frames.load(Ordering::Relaxed);
            sum.frames += frames;
            sum.commands += if *is_command { frames } else { 0 };
            sum.carried += usize::from(tally.is_carried.load(Ordering::Relaxed));
            sum.bytes += tally.bytes.load(Ordering::Relaxed);
            sum.lost = sum.lost.saturating_add(tally.lost.load(Ordering::Relaxed));
            sum.refused += tally.refused.load(Ordering::Relaxed);
        }
        sum
    }

    /// Returns the numbers of carried and lost frames, for each stream that has any.
    pub(super) fn by_topic(&self) -> BTreeMap<String, (u64, u64)> {
        let tallies = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let read = |tally: &Tally| (tally.frames.load(Ordering::Relaxed), tally.lost.load(Ordering::Relaxed));
        let each = tallies.iter().map(|(topic, (_, tally))| (topic.clone(), read(tally)));
        each.filter(|(_, counts)| *counts != (0, 0)).collect()
    }
}
