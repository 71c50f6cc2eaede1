//! [`Timeline`]: the position of a replay in its recording, and requests to seek.

use super::RecordingError;
use super::reader::{Item, RecordingReader};
use super::skip::summary;
use std::io::{Read, Seek};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Allowed rates, as factors of real time.
const RATES: std::ops::RangeInclusive<f64> = 0.01..=100.0;

/// Shared by the thread that plays a recording and the threads that show it.
#[derive(Debug)]
pub struct Timeline {
    duration: Duration,
    state: Mutex<State>,
}

#[derive(Debug)]
struct State {
    now: Playhead,
    /// The requested position.
    sought: Option<Duration>,
}

/// The state of a replay.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Playhead {
    /// Time after the recording's first message.
    pub position: Duration,
    /// Speed as a factor of real time.
    pub rate: f64,
    /// True if it is paused.
    pub is_paused: bool,
}

impl Timeline {
    /// Creates the timeline of a recording from its index, or, if it has none, from its complete messages.
    ///
    /// # Errors
    /// [`RecordingError::Foreign`] if the recording is empty, and errors of reading.
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

    /// Returns the time from the first message to the last.
    pub fn duration(&self) -> Duration {
        self.duration
    }

    /// Returns the current state.
    pub fn now(&self) -> Playhead {
        self.with(|state| state.now)
    }

    /// Requests to continue at this position, in the order in which messages were recorded. It replaces an earlier
    /// request that has not been carried out.
    pub fn seek(&self, position: Duration) {
        self.with(|state| state.sought = Some(position.min(self.duration)));
    }

    /// Requests that, while the replay is paused, the last frame of each stream is sent again, for a new subscriber.
    pub fn refresh(&self) {
        self.with(|state| {
            if state.now.is_paused && state.sought.is_none() {
                state.sought = Some(state.now.position);
            }
        });
    }

    /// Sets the speed as a factor of real time.
    ///
    /// # Errors
    /// A message, if the rate is not allowed.
    pub fn set_rate(&self, rate: f64) -> Result<(), String> {
        if !RATES.contains(&rate) {
            return Err(format!("a rate must be from {} to {}, not {rate}", RATES.start(), RATES.end()));
        }
        self.with(|state| state.now.rate = rate);
        Ok(())
    }

    /// Takes the requested position, if there is one.
    pub(super) fn take_sought(&self) -> Option<Duration> {
        self.with(|state| state.sought.take())
    }

    /// Returns true if there is a requested position that has not been taken yet.
    pub(super) fn is_sought(&self) -> bool {
        self.with(|state| state.sought.is_some())
    }

    /// Publishes the position of the replay.
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

/// Returns the times of the first and the last message, nanoseconds.
fn times<R: Read>(mut recording: RecordingReader<R>) -> Result<[u64; 2], RecordingError> {
    let mut times: Option<[u64; 2]> = None;
    loop {
        let time_ns = match recording.next_item() {
            Ok(Some(Item::Message(message))) => message.log_time_ns,
            Ok(Some(Item::Frame(frame))) => frame.log_time_ns,
            Ok(Some(_)) => continue,
            Ok(None) => break,
            // Everything up to the cut can be played, if there is anything.
            Err(RecordingError::Cut) if times.is_some() => break,
            Err(error) => return Err(error),
        };
        times = Some([times.map_or(time_ns, |[first, _]| first), time_ns]);
    }
    times.ok_or_else(|| RecordingError::Foreign { library: recording.library().to_owned() })
}
