//! [`BusyPoll`]: when to look for a frame instead of sleeping until it is announced.
//!
//! Waking a process costs more than everything else on a frame's way. The frames of a sensor are periodic, so their
//! times of sending are followed by an alpha-beta filter (T. R. Benedict and G. W. Bordner, "Synthesis of an Optimal
//! Set of Radar Track-While-Scan Smoothing Equations", IRE Trans. Automatic Control 7(4), 1962), and the reader is
//! awake and looking when the next is due.

use std::time::Duration;

use crate::{FrameHeader, clock};

/// Gain of the phase. The smaller, the less single late frames shift the forecast.
const ALPHA: f64 = 0.125;
/// Gain of the period: theirs, optimal for this phase's.
const BETA: f64 = ALPHA * ALPHA / (2.0 - ALPHA);
/// Gain of the deviation.
const GAMMA: f64 = 0.0625;
/// Frames before a forecast is trusted.
const FRAMES: u32 = 8;
/// A stream whose frames deviate by more of its period is not periodic.
const MOST_DEVIATION: f64 = 0.125;
/// How many mean absolute deviations early and late a frame is looked for: 98 % of a normal distribution.
const SPREAD: f64 = 3.0;
/// At least so early and so late: what a timer and a waking take.
const LEAST_NS: f64 = 150e3;

/// Looks for frames when they are due, for at most `limit` each.
#[derive(Debug)]
pub(crate) struct BusyPoll {
    limit_ns: f64,
    forecast: Option<Forecast>,
}

/// What is known of a stream's pace.
#[derive(Debug)]
struct Forecast {
    session: u64,
    seq: u64,
    /// When frame `seq` should have been sent.
    sent_ns: f64,
    period_ns: f64,
    /// Mean absolute error of the forecasts.
    deviation_ns: f64,
    frames: u32,
}

/// What to do until a frame is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Until {
    /// Sleep until it is announced: none is due.
    Announced,
    /// Sleep for as long, unless one is announced.
    Due(Duration),
    /// Look, until this moment of the monotonic clock.
    Late(u64),
}

impl BusyPoll {
    /// `None` where there is nothing to look for, or no second core to look with.
    pub(crate) fn new(limit: Duration) -> Option<Self> {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        (!limit.is_zero() && cores > 1)
            .then_some(Self { limit_ns: limit.as_secs_f64() * 1e9, forecast: None })
    }

    /// A frame was taken.
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

    /// Looks for a frame without sleeping while one is due, but no longer than `most`; whether it came.
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

    /// How long may be slept if no frame is announced.
    pub(crate) fn sleep(&self) -> Duration {
        match self.until(clock::mono_ns()) {
            Until::Announced => Duration::MAX,
            // A timer takes zero for never.
            Until::Due(sleep) => sleep.max(Duration::from_nanos(1)),
            // It became due in between.
            Until::Late(_) => Duration::from_nanos(1),
        }
    }

    /// What to do at this moment.
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

    /// Learns of a later frame; `false` when the stream goes at another pace now, or was paused.
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

    /// After `frames` frames, each as late as `late_ns` says.
    fn after(frames: u64, late_ns: impl Fn(u64) -> u64) -> BusyPoll {
        let mut poll = BusyPoll { limit_ns: 4e6, forecast: None };
        for seq in 0..frames {
            take(&mut poll, 1, seq, 1_000_000_000 + seq * PERIOD_NS + late_ns(seq));
        }
        poll
    }

    /// When the window before frame `seq` opens and closes, relative to the time when it is due.
    fn window(poll: &BusyPoll, seq: u64) -> (i64, i64) {
        let due_ns = 1_000_000_000 + seq * PERIOD_NS;
        let Until::Due(sleep) = poll.until(due_ns - PERIOD_NS / 2) else { panic!("it is not due") };
        let opens_ns = due_ns - PERIOD_NS / 2 + sleep.as_nanos() as u64;
        let Until::Late(closes_ns) = poll.until(opens_ns + 1) else { panic!("it is due") };
        assert_eq!(poll.until(closes_ns + 1), Until::Announced, "late frames are slept for");
        (opens_ns as i64 - due_ns as i64, closes_ns as i64 - due_ns as i64)
    }

    #[test]
    fn a_steady_stream_is_looked_for_as_long_as_waking_takes() {
        let (opens_ns, closes_ns) = window(&after(200, |_| 0), 200);
        assert!((-160_000..=-149_000).contains(&opens_ns), "{opens_ns}");
        assert!((149_000..=160_000).contains(&closes_ns), "{closes_ns}");
    }

    #[test]
    fn the_less_steady_the_longer_up_to_the_limit() {
        // Up to 0.6 ms late, uniformly: 0.15 ms from the middle on average.
        let (opens_ns, closes_ns) = window(&after(400, |seq| seq * 7919 % 601 * 1000), 400);
        assert!((-400_000..0).contains(&opens_ns), "{opens_ns}");
        assert!((600_000..1_000_000).contains(&closes_ns), "{closes_ns}");
        // Up to 8 ms late: longer than 4 ms must not be looked for.
        let (opens_ns, closes_ns) = window(&after(400, |seq| seq * 7919 % 8001 * 1000), 400);
        assert!((3_999_000..=4_001_000).contains(&(closes_ns - opens_ns)), "{}", closes_ns - opens_ns);
    }

    #[test]
    fn frames_that_were_missed_do_not_shift_the_next() {
        let mut poll = after(100, |_| 0);
        take(&mut poll, 1, 110, 1_000_000_000 + 110 * PERIOD_NS);
        let (opens_ns, _) = window(&poll, 111);
        assert!((-160_000..=-149_000).contains(&opens_ns), "{opens_ns}");
    }

    #[test]
    fn what_has_no_pace_is_slept_for() {
        assert_eq!(BusyPoll { limit_ns: 1e6, forecast: None }.until(0), Until::Announced);
        // Hardly begun.
        assert_eq!(after(FRAMES as u64 - 1, |_| 0).until(1_000_000_000), Until::Announced);
        // Events, not a sensor.
        let mut events = BusyPoll { limit_ns: 4e6, forecast: None };
        let mut sent_ns = 0;
        for seq in 0..100 {
            sent_ns += 1 + seq * 7919 % 10_007 * 100_000;
            take(&mut events, 1, seq, sent_ns);
            assert_eq!(events.until(sent_ns + 1), Until::Announced);
        }
        // After a pause, and after a new start, a stream's pace is learned again.
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
        // The publisher's next life is followed as if nothing had been.
        for seq in 0..100 {
            take(&mut poll, 2, seq, 1_000_000_000 + seq * PERIOD_NS);
        }
        assert_eq!(window(&poll, 100), window(&after(100, |_| 0), 100));
    }
}
