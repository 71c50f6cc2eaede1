//! [`BusyPoll`]: decides when to poll for a frame instead of sleeping until it is announced.
//!
//! Waking a process takes more time than all other steps of a frame's delivery. The frames of a sensor are periodic, so
//! an alpha-beta filter tracks their send times (T. R. Benedict and G. W. Bordner, "Synthesis of an Optimal Set of
//! Radar Track-While-Scan Smoothing Equations", IRE Trans. Automatic Control 7(4), 1962), and the subscriber is awake
//! and polling when the next one is due.

use std::time::Duration;

use crate::{FrameHeader, clock};

/// Gain of the phase. The smaller it is, the less a single late frame shifts the forecast.
const ALPHA: f64 = 0.125;
/// Gain of the period: Benedict and Bordner's optimum for this gain of the phase.
const BETA: f64 = ALPHA * ALPHA / (2.0 - ALPHA);
/// Gain of the deviation.
const GAMMA: f64 = 0.0625;
/// Number of frames after which a forecast is trusted.
const FRAMES: u32 = 8;
/// The largest deviation of a periodic stream, as a share of its period.
const MOST_DEVIATION: f64 = 0.125;
/// Half the polling window in mean absolute deviations: covers 98 % of a normal distribution.
const SPREAD: f64 = 3.0;
/// The least half of the window: the time for a timer and a wakeup.
const LEAST_NS: f64 = 150e3;

/// Polls for frames when they are due, for at most `limit` each.
#[derive(Debug)]
pub(crate) struct BusyPoll {
    limit_ns: f64,
    forecast: Option<Forecast>,
}

/// The predicted timing of a stream.
#[derive(Debug)]
struct Forecast {
    session: u64,
    seq: u64,
    /// Filtered send time of frame `seq`.
    sent_ns: f64,
    period_ns: f64,
    /// Mean absolute error of the forecasts.
    deviation_ns: f64,
    frames: u32,
}

/// The action until a frame arrives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Until {
    /// Sleep until one is announced: none is due.
    Announced,
    /// Sleep for this time, unless one is announced.
    Due(Duration),
    /// Poll until this time of the monotonic clock.
    Late(u64),
}

impl BusyPoll {
    /// Returns `None` if `limit` is zero or there is no second core.
    pub(crate) fn new(limit: Duration) -> Option<Self> {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        (!limit.is_zero() && cores > 1)
            .then_some(Self { limit_ns: limit.as_secs_f64() * 1e9, forecast: None })
    }

    /// Updates the forecast by a frame that was taken.
    pub(crate) fn taken(&mut self, header: &FrameHeader) {
        let FrameHeader { session, seq, publish_mono_ns, .. } = *header;
        match &mut self.forecast {
            Some(forecast) if forecast.session == session && forecast.seq < seq => {
                if !forecast.follow(seq, publish_mono_ns as f64) {
                    self.forecast = Some(Forecast::begin(session, seq, publish_mono_ns as f64));
                }
            }
            Some(forecast) if forecast.session == session => {}
            _ => self.forecast = Some(Forecast::begin(session, seq, publish_mono_ns as f64)),
        }
    }

    /// Polls for a frame without sleeping while one is due, for at most `most`. Returns true if one arrived.
    pub(crate) fn look<E>(
        &self,
        most: Duration,
        mut has_frames: impl FnMut() -> Result<bool, E>,
    ) -> Result<bool, E> {
        let now_ns = clock::mono_ns();
        let Until::Late(late_ns) = self.until(now_ns) else { return Ok(false) };
        let end_ns = late_ns.min(now_ns.saturating_add(u64::try_from(most.as_nanos()).unwrap_or(u64::MAX)));
        while !has_frames()? {
            if clock::mono_ns() >= end_ns {
                return Ok(false);
            }
            std::hint::spin_loop();
        }
        Ok(true)
    }

    /// Returns how long to sleep if no frame is announced.
    pub(crate) fn sleep(&self) -> Duration {
        match self.until(clock::mono_ns()) {
            Until::Announced => Duration::MAX,
            // Zero would disarm the timer.
            Until::Due(sleep) => sleep.max(Duration::from_nanos(1)),
            // The frame became due in between.
            Until::Late(_) => Duration::from_nanos(1),
        }
    }

    /// Returns the action at this time.
    fn until(&self, now_ns: u64) -> Until {
        let Some(forecast) = &self.forecast else { return Until::Announced };
        if forecast.frames < FRAMES || forecast.deviation_ns > MOST_DEVIATION * forecast.period_ns {
            return Until::Announced;
        }
        let due_ns = forecast.sent_ns + forecast.period_ns;
        let most_ns = self.limit_ns.min(forecast.period_ns) / 2.0;
        let early_ns = (SPREAD * forecast.deviation_ns).max(LEAST_NS).min(most_ns);
        let now_ns = now_ns as f64;
        if now_ns < due_ns - early_ns {
            Until::Due(Duration::from_nanos((due_ns - early_ns - now_ns) as u64))
        } else if now_ns < due_ns + early_ns {
            Until::Late((due_ns + early_ns) as u64)
        } else {
            Until::Announced
        }
    }
}

impl Forecast {
    fn begin(session: u64, seq: u64, sent_ns: f64) -> Self {
        Self { session, seq, sent_ns, period_ns: 0.0, deviation_ns: 0.0, frames: 1 }
    }

    /// Updates the filter by a later frame. Returns false if the stream's period has changed, or it was paused.
    fn follow(&mut self, seq: u64, sent_ns: f64) -> bool {
        let periods = (seq - self.seq) as f64;
        self.seq = seq;
        self.frames = self.frames.saturating_add(1);
        if self.frames == 2 {
            self.period_ns = (sent_ns - self.sent_ns) / periods;
            self.deviation_ns = self.period_ns / 16.0;
            self.sent_ns = sent_ns;
            return self.period_ns > 0.0;
        }
        let forecast_ns = self.sent_ns + periods * self.period_ns;
        let error_ns = sent_ns - forecast_ns;
        self.sent_ns = forecast_ns + ALPHA * error_ns;
        self.period_ns += BETA * error_ns / periods;
        self.deviation_ns += GAMMA * (error_ns.abs() - self.deviation_ns);
        error_ns.abs() < periods * self.period_ns
    }
}

#[cfg(test)]
mod tests {
    use bytemuck::Zeroable as _;

    use super::*;

    const PERIOD_NS: u64 = 33_333_333;

    fn take(poll: &mut BusyPoll, session: u64, seq: u64, publish_mono_ns: u64) {
        poll.taken(&FrameHeader { seq, session, publish_mono_ns, ..FrameHeader::zeroed() });
    }

    /// Returns the state after `frames` frames, each of them late by `late_ns`.
    fn after(frames: u64, late_ns: impl Fn(u64) -> u64) -> BusyPoll {
        let mut poll = BusyPoll { limit_ns: 4e6, forecast: None };
        for seq in 0..frames {
            take(&mut poll, 1, seq, 1_000_000_000 + seq * PERIOD_NS + late_ns(seq));
        }
        poll
    }

    /// Returns when the window for frame `seq` opens and closes, relative to its due time.
    fn window(poll: &BusyPoll, seq: u64) -> (i64, i64) {
        let due_ns = 1_000_000_000 + seq * PERIOD_NS;
        let Until::Due(sleep) = poll.until(due_ns - PERIOD_NS / 2) else { panic!("it is not due") };
        let opens_ns = due_ns - PERIOD_NS / 2 + sleep.as_nanos() as u64;
        let Until::Late(closes_ns) = poll.until(opens_ns + 1) else { panic!("it is due") };
        assert_eq!(poll.until(closes_ns + 1), Until::Announced, "late frames are slept for");
        (opens_ns as i64 - due_ns as i64, closes_ns as i64 - due_ns as i64)
    }

    #[test]
    fn a_steady_stream_is_polled_for_the_time_of_a_wakeup() {
        let (opens_ns, closes_ns) = window(&after(200, |_| 0), 200);
        assert!((-160_000..=-149_000).contains(&opens_ns), "{opens_ns}");
        assert!((149_000..=160_000).contains(&closes_ns), "{closes_ns}");
    }

    #[test]
    fn the_window_grows_with_the_deviation_up_to_the_limit() {
        // Up to 0.6 ms late, uniformly: a mean deviation of 0.15 ms.
        let (opens_ns, closes_ns) = window(&after(400, |seq| seq * 7919 % 601 * 1000), 400);
        assert!((-400_000..0).contains(&opens_ns), "{opens_ns}");
        assert!((600_000..1_000_000).contains(&closes_ns), "{closes_ns}");
        // Up to 8 ms late: the window must not exceed 4 ms.
        let (opens_ns, closes_ns) = window(&after(400, |seq| seq * 7919 % 8001 * 1000), 400);
        assert!((3_999_000..=4_001_000).contains(&(closes_ns - opens_ns)), "{}", closes_ns - opens_ns);
    }

    #[test]
    fn missed_frames_do_not_shift_the_forecast() {
        let mut poll = after(100, |_| 0);
        take(&mut poll, 1, 110, 1_000_000_000 + 110 * PERIOD_NS);
        let (opens_ns, _) = window(&poll, 111);
        assert!((-160_000..=-149_000).contains(&opens_ns), "{opens_ns}");
    }

    #[test]
    fn a_stream_without_a_period_is_not_polled() {
        assert_eq!(BusyPoll { limit_ns: 1e6, forecast: None }.until(0), Until::Announced);
        // Too few frames for a forecast.
        assert_eq!(after(FRAMES as u64 - 1, |_| 0).until(1_000_000_000), Until::Announced);
        // Aperiodic events.
        let mut events = BusyPoll { limit_ns: 4e6, forecast: None };
        let mut sent_ns = 0;
        for seq in 0..100 {
            sent_ns += 1 + seq * 7919 % 10_007 * 100_000;
            take(&mut events, 1, seq, sent_ns);
            assert_eq!(events.until(sent_ns + 1), Until::Announced);
        }
        // After a pause or a restart, the timing of a stream is learned again.
        let mut poll = after(100, |_| 0);
        take(&mut poll, 1, 100, 60_000_000_000);
        assert_eq!(poll.until(60_000_000_001), Until::Announced);
        let mut poll = after(100, |_| 0);
        take(&mut poll, 2, 0, 1_000_000_000 + 100 * PERIOD_NS);
        assert_eq!(poll.until(1_000_000_001 + 100 * PERIOD_NS), Until::Announced);
    }

    #[test]
    fn hostile_headers_do_no_harm() {
        let mut poll = after(100, |_| 0);
        for (seq, sent_ns) in [(u64::MAX, 0), (u64::MAX, u64::MAX), (0, u64::MAX), (u64::MAX - 1, 5)] {
            take(&mut poll, 1, seq, sent_ns);
            for now_ns in [0, u64::MAX] {
                if let Until::Late(end_ns) = poll.until(now_ns) {
                    assert!(end_ns - now_ns <= 4_000_000, "it looks until {end_ns}, longer than the limit");
                }
            }
        }
        // The next life of the publisher is tracked from scratch.
        for seq in 0..100 {
            take(&mut poll, 2, seq, 1_000_000_000 + seq * PERIOD_NS);
        }
        assert_eq!(window(&poll, 100), window(&after(100, |_| 0), 100));
    }
}
