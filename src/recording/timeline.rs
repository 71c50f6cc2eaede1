//! [`Timeline`]: where a replay is in its recording, and where somebody wants it to be.

use super::RecordingError;
use super::player::{Ending, NAP, Player};
use super::player_options::Pace;
use super::reader::{Item, RecordingReader};
use super::skip::summary;
use std::io::{Read, Seek};
use std::sync::{Arc, Mutex, PoisonError};
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

impl Player {
    /// Plays a recording along a time line until `go_on` ends it. At its end it stands, and resumed there it begins again.
    /// Wherever it goes on, the last frame of each stream until then is sent first, so that all is seen as it was then.
    /// `open` gives the file, anew after each seek.
    ///
    /// # Errors
    /// As [`Player::play`], and those of `open`.
    pub fn play_along<R: Read + Seek>(
        &mut self,
        timeline: &Arc<Timeline>,
        mut open: impl FnMut() -> std::io::Result<R>,
        mut go_on: impl FnMut() -> bool,
    ) -> Result<(), RecordingError> {
        self.timeline = Some(timeline.clone());
        loop {
            let sought = timeline.with(|state| state.sought.take());
            // What is at the very time that was sought is seen, too.
            let start = sought.map_or(Duration::ZERO, |sought| sought + Duration::from_nanos(1));
            self.options.start = start;
            self.before.clear();
            self.tell(sought.unwrap_or(Duration::ZERO));
            let recording = RecordingReader::resuming_at(open()?, start)?;
            match self.play(recording, |_| go_on()) {
                Ok(Ending::Stopped) if self.is_sought() => continue,
                Ok(Ending::Stopped) => return Ok(()),
                // All that is whole was played.
                Ok(Ending::Played) | Err(RecordingError::Cut | RecordingError::TooShort { .. }) => {}
                Err(error) => return Err(error),
            }
            self.send_before()?;
            self.paused = true;
            self.tell(timeline.duration);
            while !self.is_sought() {
                if !go_on() {
                    return Ok(());
                }
                self.look_after(NAP)?;
                self.refuse_steps("the recording is at its end");
                if !self.paused {
                    timeline.seek(Duration::ZERO);
                }
            }
        }
    }

    /// Sends what comes before the start.
    pub(super) fn send_before(&mut self) -> Result<(), RecordingError> {
        let mut frames: Vec<_> = std::mem::take(&mut self.before).into_values().collect();
        frames.sort_by_key(|frame| frame.log_time_ns);
        frames.iter().try_for_each(|frame| self.send(frame))
    }

    /// Tells whoever looks where this is.
    pub(super) fn tell(&self, position: Duration) {
        if let Some(timeline) = &self.timeline {
            let is_paused = self.paused;
            timeline.with(|state| state.now = Playhead { position, is_paused, ..state.now });
        }
    }

    /// Whether it is to go on elsewhere.
    pub(super) fn is_sought(&self) -> bool {
        self.timeline.as_ref().is_some_and(|timeline| timeline.with(|state| state.sought.is_some()))
    }

    /// Takes the pace that somebody wants.
    pub(super) fn take_rate(&mut self) {
        if let Some(timeline) = &self.timeline {
            self.options.pace = Pace::Rate(timeline.now().rate);
            timeline.with(|state| state.now.is_paused = self.paused);
        }
    }
}
