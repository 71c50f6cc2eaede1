//! [`Player`]: plays a recording in place of the simulator.

use super::RecordingError;
use super::play_clock::PlayClock;
use super::player_options::{Pace, PlayerOptions};
use super::reader::{Item, RecordedFrame, RecordingReader};
use super::replay_streams::ReplayStreams;
use super::timeline::Timeline;
use crate::server::attendance::{Awaited, START_PATIENCE};
use crate::server::inbox::{Inbox, Request};
use belvedere_bridge::payload::SimulationCommand;
use belvedere_bridge::{Kind, Node, Operation};
use std::collections::{BTreeMap, BTreeSet};
use std::io::Read;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Interval at which new subscribers get the last frame of latched streams.
const UPDATE_INTERVAL: Duration = Duration::from_millis(100);
/// Longest sleep between two calls of `go_on`.
pub(super) const NAP: Duration = Duration::from_millis(20);

/// Plays recordings in a domain: the same streams with the same frames, in the order and at the intervals of the
/// recording. In a header only the counter, the session and the send time are the replay's own, and
/// [`REPLAYED`](belvedere_bridge::FrameHeader::REPLAYED) is set. Commands pause, resume and step a replay like a simulator.
pub struct Player {
    streams: ReplayStreams,
    inbox: Inbox,
    pub(super) options: PlayerOptions,
    pub(super) paused: bool,
    /// Shared with other threads that seek and read the position.
    pub(super) timeline: Option<Arc<Timeline>>,
    /// The last frame of each stream before the start, sent after seeking.
    pub(super) before: BTreeMap<String, RecordedFrame>,
    /// Number of steps left, and the command that is answered when they are done.
    steps: Option<(u64, SimulationCommand)>,
    next_update: Instant,
    time_ns: u64,
    has_clock: bool,
    frames: u64,
    /// The damaged parts of the recording that were reported.
    left_out: BTreeSet<String>,
}

/// The reason why playing ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// The recording, or the requested part of it, has ended.
    Played,
    /// The caller stopped it.
    Stopped,
}

impl Player {
    /// Creates a player in place of the simulator in a domain.
    ///
    /// # Errors
    /// If the domain has a simulator or another replay.
    pub fn open(node: Node, options: PlayerOptions) -> Result<Self, RecordingError> {
        let inbox = Inbox::open(&node)?;
        Ok(Self {
            streams: ReplayStreams::new(node, &options),
            inbox,
            paused: options.paused,
            options,
            timeline: None,
            before: BTreeMap::new(),
            steps: None,
            next_update: Instant::now(),
            time_ns: 0,
            has_clock: false,
            frames: 0,
            left_out: BTreeSet::new(),
        })
    }

    /// Returns the simulated time in nanoseconds, according to the last clock message.
    pub fn time_ns(&self) -> u64 {
        self.time_ns
    }

    /// Returns the number of frames sent.
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// Plays a recording once. `go_on` is called about fifty times a second.
    ///
    /// # Errors
    /// [`RecordingError::Foreign`] if the recording has no frames; [`RecordingError::TooShort`] if it ends before the
    /// requested start; [`RecordingError::Cut`] at the end of a recording that is cut off, once everything before the
    /// cut was played; errors of the streams.
    pub fn play<R: Read>(
        &mut self,
        mut recording: RecordingReader<R>,
        mut go_on: impl FnMut(&Self) -> bool,
    ) -> Result<Ending, RecordingError> {
        let mut clock = recording.begins_ns().map(PlayClock::new);
        let mut last_ns = 0;
        let mut waited = self.options.wait_for.is_empty();
        let ending = loop {
            let frame = match recording.next_item() {
                Ok(Some(Item::Frame(frame))) => frame,
                Ok(Some(Item::Stream(stream))) => {
                    self.streams.add(stream);
                    continue;
                }
                Ok(Some(Item::LeftOut(what))) => {
                    // A recording that is repeated has the same damage again.
                    if self.left_out.insert(what.clone()) {
                        tracing::warn!("{}: {what}", self.options.name);
                    }
                    continue;
                }
                Ok(Some(_)) => continue,
                Ok(None) => break Ok(Ending::Played),
                Err(error) => break Err(error),
            };
            self.streams.open_new()?;
            last_ns = frame.log_time_ns;
            let clock = clock.get_or_insert_with(|| PlayClock::new(frame.log_time_ns));
            let since_start = Duration::from_nanos(frame.log_time_ns.saturating_sub(clock.first_ns));
            if since_start < self.options.start {
                clock.skip_to(frame.log_time_ns);
                // Latched messages are sent even if they were recorded before the start.
                if self.timeline.is_some() {
                    self.before.insert(frame.topic.clone(), frame);
                } else if matches!(frame.header.kind(), Some(Kind::StaticTransforms | Kind::SensorSettings)) {
                    self.send(&frame)?;
                }
                if self.is_sought() || !self.is_wanted(Instant::now(), &mut go_on)? {
                    return Ok(Ending::Stopped);
                }
                continue;
            }
            clock.has_begun = true;
            self.send_before()?;
            let end = self.options.duration.map(|duration| self.options.start + duration);
            if end.is_some_and(|end| since_start >= end) {
                return Ok(Ending::Played);
            }
            if !waited {
                waited = self.gather(&mut go_on)?;
            }
            if !waited || !self.wait_until_due(clock, frame.log_time_ns, &mut go_on)? {
                return Ok(Ending::Stopped);
            }
            self.send(&frame)?;
            self.count_step(&frame);
            self.show_position(since_start);
        };
        match (&ending, clock) {
            (Ok(_), None) => Err(RecordingError::Foreign { library: recording.library().to_owned() }),
            (Ok(_) | Err(RecordingError::Cut), Some(PlayClock { has_begun: false, first_ns, .. })) => {
                Err(RecordingError::TooShort {
                    lasts_s: last_ns.saturating_sub(first_ns) as f64 * 1e-9,
                    start_s: self.options.start.as_secs_f64(),
                })
            }
            _ => ending,
        }
    }

    /// Sends the last frame of each stream before the start.
    pub(super) fn send_before(&mut self) -> Result<(), RecordingError> {
        let mut frames: Vec<_> = std::mem::take(&mut self.before).into_values().collect();
        frames.sort_by_key(|frame| frame.log_time_ns);
        frames.iter().try_for_each(|frame| self.send(frame))
    }

    /// Publishes the position and the pause on the timeline.
    pub(super) fn show_position(&self, position: Duration) {
        if let Some(timeline) = &self.timeline {
            timeline.set_position(position, self.paused);
        }
    }

    /// Returns true if another position was sought.
    pub(super) fn is_sought(&self) -> bool {
        self.timeline.as_ref().is_some_and(|timeline| timeline.is_sought())
    }

    /// Applies the rate that was set on the timeline.
    pub(super) fn take_rate(&mut self) {
        if let Some(timeline) = &self.timeline {
            self.options.pace = Pace::Rate(timeline.now().rate);
            timeline.set_paused(self.paused);
        }
    }

    /// Returns true if the caller wants to continue. From time to time this calls `go_on`, and sends latched frames to
    /// new subscribers.
    fn is_wanted(
        &mut self,
        now: Instant,
        go_on: &mut impl FnMut(&Self) -> bool,
    ) -> Result<bool, RecordingError> {
        if now < self.next_update {
            return Ok(true);
        }
        self.next_update = now + UPDATE_INTERVAL;
        self.streams.update()?;
        Ok(go_on(self))
    }

    /// Waits until all awaited consumers subscribe to as many streams as required. Returns false if `go_on` stops it.
    fn gather(&mut self, go_on: &mut impl FnMut(&Self) -> bool) -> Result<bool, RecordingError> {
        let since = Instant::now();
        loop {
            let mut following: BTreeMap<String, usize> = BTreeMap::new();
            for consumer in self.streams.consumers() {
                *following.entry(consumer.name).or_default() += 1;
            }
            let missing = |awaited: &&Awaited| {
                following.get(&awaited.name).is_none_or(|&count| count < awaited.streams)
            };
            let Some(awaited) = self.options.wait_for.iter().find(missing) else { return Ok(true) };
            let waited = since.elapsed();
            if waited >= self.options.patience.unwrap_or(START_PATIENCE) {
                return Err(RecordingError::ConsumerMissing { name: awaited.name.clone(), waited });
            }
            if !go_on(self) {
                return Ok(false);
            }
            self.streams.clean_up_dead();
            self.look_after(NAP)?;
        }
    }

    /// Waits until a frame is due, including pauses. Returns false if `go_on` stops it.
    fn wait_until_due(
        &mut self,
        clock: &mut PlayClock,
        log_time_ns: u64,
        go_on: &mut impl FnMut(&Self) -> bool,
    ) -> Result<bool, RecordingError> {
        loop {
            let now = Instant::now();
            self.take_rate();
            if self.is_sought() || !self.is_wanted(now, go_on)? {
                return Ok(false);
            }
            self.serve();
            if self.paused && self.steps.is_none() {
                clock.stand();
                if !go_on(self) {
                    return Ok(false);
                }
                self.look_after(NAP)?;
                continue;
            }
            let left = match self.options.pace {
                Pace::Rate(rate) if self.steps.is_none() => clock.left(log_time_ns, rate),
                // Steps are done at once, and time continues where they end.
                _ => {
                    clock.skip_to(log_time_ns);
                    Duration::ZERO
                }
            };
            if left.is_zero() {
                return Ok(true);
            }
            if left > NAP && !go_on(self) {
                return Ok(false);
            }
            self.inbox.wait(left.min(NAP));
        }
    }

    pub(super) fn look_after(&mut self, nap: Duration) -> Result<(), RecordingError> {
        self.streams.update()?;
        self.inbox.wait(nap);
        self.serve();
        Ok(())
    }

    fn serve(&mut self) {
        while let Some(request) = self.inbox.take() {
            if request.operation() == Some(Operation::Query) {
                let answer = self.describe(&request);
                let answer = answer.as_deref().map_err(String::as_str);
                self.inbox.tell(&request.command, self.time_ns, answer);
            } else if let Some(outcome) = self.obey(&request) {
                self.inbox.answer(&request.command, self.time_ns, &outcome);
            }
        }
    }

    /// Answers a query.
    fn describe(&self, request: &Request) -> Result<String, String> {
        if !request.command.name.as_str().is_empty() {
            return Err(format!("this is a replay, so it has no model '{}'", request.command.name));
        }
        let time = match (&self.steps, self.paused) {
            (Some(_), _) => "stepping",
            (None, true) => "paused",
            (None, false) => "playing",
        };
        Ok(format!("{time} replay"))
    }

    /// Executes a command and returns its result, or `None` for a step, which is answered later.
    fn obey(&mut self, request: &Request) -> Option<Result<(), String>> {
        match request.operation() {
            Some(Operation::Pause) => self.paused = true,
            Some(Operation::Resume) => self.paused = false,
            Some(Operation::Step) if request.command.steps > 0 => {
                self.paused = true;
                if let Some((_, before)) = self.steps.replace((request.command.steps, request.command)) {
                    self.inbox.answer(&before, self.time_ns, &Err("another step was requested".into()));
                }
                return None;
            }
            Some(Operation::Step) => {}
            _ => return Some(Err("this is a replay, which can only be paused, resumed and stepped".into())),
        }
        Some(Ok(()))
    }

    /// Refuses steps that cannot be done.
    pub(super) fn refuse_steps(&mut self, why: &str) {
        if let Some((_, command)) = self.steps.take() {
            self.inbox.answer(&command, self.time_ns, &Err(why.to_owned()));
        }
    }

    /// Counts a step, which goes from one message of the clock to the next.
    fn count_step(&mut self, frame: &RecordedFrame) {
        if frame.header.kind() != Some(Kind::Clock) {
            return;
        }
        match &mut self.steps {
            Some((left, _)) if *left > 1 => *left -= 1,
            steps => {
                if let Some((_, command)) = steps.take() {
                    self.inbox.answer(&command, self.time_ns, &Ok(()));
                }
            }
        }
    }

    pub(super) fn send(&mut self, frame: &RecordedFrame) -> Result<(), RecordingError> {
        self.streams.send(frame)?;
        // Streams are recorded in parallel, so some are ahead of the clock by a message. A recording of other streams
        // may have no clock.
        if frame.header.kind() == Some(Kind::Clock) {
            (self.has_clock, self.time_ns) = (true, frame.header.stamp_ns);
        } else if !self.has_clock {
            self.time_ns = self.time_ns.max(frame.header.stamp_ns);
        }
        self.frames += 1;
        Ok(())
    }
}
