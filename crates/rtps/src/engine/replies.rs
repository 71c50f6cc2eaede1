//! Replies of services, which wait until their clients can hear them.

use std::time::{Duration, Instant};

use super::{Engine, Held};
use crate::guid::EntityId;
use crate::writer::Sample;

/// A client may find the reader of requests here before its reader of replies is found. Its reply waits so long.
const HOLD: Duration = Duration::from_secs(1);

/// At most so many replies wait; the oldest one is then sent, or dropped if nobody is there to get it.
const MOST_HELD: usize = 64;

impl Engine {
    pub(super) fn hold(&mut self, writer: EntityId, sample: Sample, now: Instant) {
        self.held.push_back(Held { writer, sample, until: now + HOLD });
    }

    /// Sends replies whose clients can hear them, and those that have waited long enough.
    pub(super) fn send_held(&mut self, now: Instant) {
        let mut too_many = self.held.len().saturating_sub(MOST_HELD);
        for held in std::mem::take(&mut self.held) {
            let Some(own) = self.writers.get_mut(&held.writer) else { continue };
            let is_late = too_many > 0 || held.until <= now;
            too_many = too_many.saturating_sub(1);
            if is_late || held.sample.answer.is_none_or(|client| own.writer.is_heard_by(client)) {
                own.writer.write(held.sample, now);
            } else {
                self.held.push_back(held);
            }
        }
    }
}
