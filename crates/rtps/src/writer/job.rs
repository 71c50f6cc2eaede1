//! Samples, and their fragments that are still to be sent.

use std::sync::Arc;
use std::time::Duration;

use crate::answer::Answer;
use crate::guid::{Guid, SampleIdentity};
use crate::numbers::NumberSet;

/// Bytes of a sample in one datagram.
pub(super) const FRAGMENT: usize = 64_000;

/// A sample of the history.
#[derive(Clone, Debug)]
pub(crate) struct Sample {
    pub(crate) payload: Arc<Vec<u8>>,
    /// When it was written, since 1970.
    pub(crate) time: Duration,
    /// What it is about, and whether that is gone: in discovery alone.
    pub(crate) key: Option<(Guid, bool)>,
    /// The client that gets it: for replies of services alone. Other samples are for every reader.
    pub(crate) answer: Option<Answer>,
}

impl Sample {
    /// A sample of a topic.
    pub(crate) fn plain(payload: Arc<Vec<u8>>, time: Duration) -> Sample {
        Sample { payload, time, key: None, answer: None }
    }

    /// A sample of discovery.
    pub(crate) fn keyed(payload: Vec<u8>, key: Guid, disposed: bool) -> Sample {
        let time = Duration::ZERO;
        Sample { payload: Arc::new(payload), time, key: Some((key, disposed)), answer: None }
    }

    pub(super) fn is_for(&self, reader: Guid) -> bool {
        self.answer.is_none_or(|answer| answer.client == reader.prefix)
    }

    pub(super) fn related(&self) -> Option<SampleIdentity> {
        self.answer.and_then(|answer| answer.related)
    }

    pub(super) fn is_disposed(&self) -> bool {
        self.key.is_some_and(|(_, disposed)| disposed)
    }
}

/// Fragments that are still to be sent.
#[derive(Debug)]
pub(super) struct Job {
    pub(super) sequence: i64,
    pub(super) sample: Sample,
    /// One reader, or all.
    pub(super) reader: Option<Guid>,
    /// Those that are asked for, counted from 1, or all.
    pub(super) only: Option<NumberSet>,
    /// Counted from 0.
    pub(super) next: u32,
}

impl Job {
    pub(super) fn is_for(&self, reader: Guid) -> bool {
        self.reader.is_none_or(|only| only == reader) && self.sample.is_for(reader)
    }

    pub(super) fn count(&self) -> u32 {
        self.sample.payload.len().div_ceil(FRAGMENT).max(1) as u32
    }

    /// Goes to the next fragment that is to be sent, if any is left.
    pub(super) fn seek(&mut self) -> bool {
        if let Some(only) = &self.only {
            let next = only.iter().find(|&number| number > i64::from(self.next));
            self.next = next.map_or(u32::MAX, |number| number as u32 - 1);
        }
        self.next < self.count()
    }
}
