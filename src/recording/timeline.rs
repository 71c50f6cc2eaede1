//! [`Timeline`]: where a replay is in its recording, and where somebody wants it to be.

use super::RecordingError;
use super::reader::{Item, RecordingReader};
use super::skip::summary;
use std::io::{Read, Seek};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Recorded seconds in a second that may be asked for.
const RATES: std::ops::RangeInclusive<f64> = 0.01..=100.0;

/// Between whoever plays a recording and whoever looks at it.
#[derive(Debug)]
pub struct Timeline {
    duration: Duration,
    state: Mutex<State>,
}

#[derive(Debug)]
struct State {
    now: Playhead,
    /// Where to go on.
    sought: Option<Duration>,
}

/// Where a replay is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Playhead {
    /// After the recording's first message.
    pub position: Duration,
    /// Recorded seconds in a second.
    pub rate: f64,
    /// Whether it stands.
    pub is_paused: bool,
}

impl Timeline {
    /// Of a recording: by its index, or if it has none, by all that is whole in it.
    ///
    /// # Errors
    /// [`RecordingError::Foreign`] when nothing is in it, and those of reading.
    pub fn of<R: Read + Seek>(mut source: R) -> Result<Self, RecordingError> {
        let stats = summary(&mut source).and_then(|summary| summary.stats);
        let [first_ns, last_ns] = if let Some(stats) = stats {
            [stats.message_start_time, stats.message_end_time]
        } else {
            times(RecordingReader::starting_at(source, Duration::ZERO)?)?
        };
        let now = Playhead { position: Duration::ZERO, rate: 1.0, is_paused: false };
        let duration = Duration::from_nanos(last_ns.saturating_sub(first_ns));
        Ok(Self { duration, state: Mutex::new(State { now, sought: None }) })
    }

    /// From the first message to the last.
    pub fn duration(&self) -> Duration {
        self.duration
    }

    /// Where it is.
    pub fn now(&self) -> Playhead {
        self.with(|state| state.now)
    }

    /// Has it go on from here, in the order in which messages were recorded; what was sought before and has not been reached is forgotten.
    pub fn seek(&self, position: Duration) {
        self.with(|state| state.sought = Some(position.min(self.duration)));
    }

    /// Has the last frame of each stream sent again while it stands: for who has come late.
    pub fn refresh(&self) {
        self.with(|state| {
            if state.now.is_paused && state.sought.is_none() {
                state.sought = Some(state.now.position);
            }
        });
    }

    /// Recorded seconds in a second from now on.
    ///
    /// # Errors
    /// In words, for what is no rate.
    pub fn set_rate(&self, rate: f64) -> Result<(), String> {
        if !RATES.contains(&rate) {
            return Err(format!("a rate is from {} to {}, and not {rate}", RATES.start(), RATES.end()));
        }
        self.with(|state| state.now.rate = rate);
        Ok(())
    }

    /// Takes the position that was sought, if one was.
    pub(super) fn take_sought(&self) -> Option<Duration> {
        self.with(|state| state.sought.take())
    }

    /// Returns true if a position was sought that playing has not gone to yet.
    pub(super) fn is_sought(&self) -> bool {
        self.with(|state| state.sought.is_some())
    }

    /// Publishes how far playing has come.
    pub(super) fn set_position(&self, position: Duration, is_paused: bool) {
        self.with(|state| state.now = Playhead { position, is_paused, ..state.now });
    }

    /// Publishes whether playing is paused.
    pub(super) fn set_paused(&self, is_paused: bool) {
        self.with(|state| state.now.is_paused = is_paused);
    }

    fn with<T>(&self, body: impl FnOnce(&mut State) -> T) -> T {
        body(&mut self.state.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// Times of the first and the last message, nanoseconds.
fn times<R: Read>(mut recording: RecordingReader<R>) -> Result<[u64; 2], RecordingError> {
    let mut times: Option<[u64; 2]> = None;
    loop {
        let time_ns = match recording.next_item() {
            Ok(Some(Item::Message(message))) => message.log_time_ns,
            Ok(Some(Item::Frame(frame))) => frame.log_time_ns,
            Ok(Some(_)) => continue,
            Ok(None) => break,
            // All that is whole can be played, if anything is.
            Err(RecordingError::Cut) if times.is_some() => break,
            Err(error) => return Err(error),
        };
        times = Some([times.map_or(time_ns, |[first, _]| first), time_ns]);
    }
    times.ok_or_else(|| RecordingError::Foreign { library: recording.library().to_owned() })
}
