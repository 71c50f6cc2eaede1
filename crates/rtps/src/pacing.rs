//! How fast the datagrams of a sample follow each other.
//!
//! A reader's socket holds 208 KiB on a stock kernel, which is a quarter of a VGA picture, so a picture that is sent at
//! once is lost. Its datagrams are spread over a part of the time until the next picture. A reliable reader asks again for
//! a datagram that it lost, so samples that only reliable readers get are sent faster.

use std::time::{Duration, Instant};

/// How fast the samples of a writer are sent.
#[derive(Clone, Copy, Debug)]
struct Speed {
    /// The part of a period over which a sample is spread.
    part: f64,
    /// Bytes per second: a large sample is sent no faster.
    fast: f64,
}

/// A reader that another process keeps from the processor for a millisecond would lose a part of a sample that is sent
/// faster.
const CAREFUL: Speed = Speed { part: 0.25, fast: 130e6 };

/// For reliable readers: what is lost is sent again, and that takes less time than this speed saves.
const RELIABLE: Speed = Speed { part: 0.18, fast: 300e6 };

/// The part of a period over which a large sample may be spread.
const LARGE_PART: f64 = 0.5;

/// Bytes per second: no slower than this, so that rare samples are not late.
const SLOW: f64 = 60e6;

/// Bytes per second: with the first fragment, a reader makes room for the whole sample, and cannot read meanwhile.
const ROOM: f64 = 1.5e9;

/// The clock of one writer.
#[derive(Debug)]
pub(crate) struct Pace {
    /// Time between two samples, smoothed.
    period: Duration,
    written: Option<Instant>,
    due: Instant,
    speed: Speed,
}

impl Pace {
    pub(crate) fn new(now: Instant) -> Pace {
        Pace { period: Duration::from_millis(100), written: None, due: now, speed: CAREFUL }
    }

    /// The readers have changed. Are all of them reliable?
    pub(crate) fn readers(&mut self, reliable: bool) {
        self.speed = if reliable { RELIABLE } else { CAREFUL };
    }

    /// A sample was written.
    pub(crate) fn written(&mut self, now: Instant) {
        if let Some(last) = self.written.replace(now) {
            let since = now.saturating_duration_since(last).min(Duration::from_secs(1));
            self.period = (self.period * 3 + since) / 4;
        }
    }

    /// When the next datagram may be sent.
    pub(crate) fn due(&self) -> Instant {
        self.due
    }

    /// A datagram of `bytes` was sent, of a sample of `total`, while `waiting` samples wait behind it. Others of this
    /// sample follow the first one.
    pub(crate) fn sent(&mut self, now: Instant, bytes: usize, total: usize, waiting: usize, is_first: bool) {
        let (bytes, total) = (bytes as f64, total.max(1) as f64);
        let period = self.period.as_secs_f64();
        let Speed { part, fast } = self.speed;
        let spread = (part * period).max((total / fast).min(LARGE_PART * period)).min(total / SLOW);
        let gap = spread * bytes / total / (1.0 + waiting as f64);
        if is_first {
            self.due = now + Duration::from_secs_f64(gap.max(total / ROOM));
            return;
        }
        // A thread that comes late makes up for one datagram, and not for a burst of them.
        let gap = Duration::from_secs_f64(gap);
        let earliest = now.checked_sub(gap).unwrap_or(now);
        self.due = self.due.max(earliest) + gap;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How long it takes to send a sample of `total` bytes, written every `period`, in datagrams of 64,000 bytes.
    fn time(total: usize, period: Duration) -> Duration {
        time_to(false, total, period)
    }

    fn time_to(reliable: bool, total: usize, period: Duration) -> Duration {
        let mut now = Instant::now();
        let mut pace = Pace::new(now);
        pace.readers(reliable);
        for _ in 0..50 {
            now += period;
            pace.written(now);
        }
        let start = now;
        for sent in (0..total).step_by(64_000) {
            now = now.max(pace.due());
            pace.sent(now, 64_000.min(total - sent), total, 0, sent == 0 && total > 64_000);
        }
        now - start
    }

    #[test]
    fn a_sample_takes_a_part_of_its_period() {
        let picture = time(921_600, Duration::from_millis(33));
        assert!((6.0..8.5).contains(&(picture.as_secs_f64() * 1e3)), "{picture:?}");
        let cloud = time(4_915_200, Duration::from_millis(100));
        assert!((39.0..41.0).contains(&(cloud.as_secs_f64() * 1e3)), "{cloud:?}");
        let cloud = time_to(true, 4_915_200, Duration::from_millis(100));
        assert!((19.5..21.5).contains(&(cloud.as_secs_f64() * 1e3)), "{cloud:?}");
        // Full HD sixty times a second needs more than that.
        let large = time(6_220_800, Duration::from_micros(16_667));
        assert!((11.0..12.5).contains(&(large.as_secs_f64() * 1e3)), "{large:?}");
        // A sample each second is not late by a quarter of a second.
        let rare = time(921_600, Duration::from_secs(1));
        assert!((10.0..17.0).contains(&(rare.as_secs_f64() * 1e3)), "{rare:?}");
        assert_eq!(time(400, Duration::from_secs(1)), Duration::ZERO);
    }

    #[test]
    fn a_late_thread_makes_up_for_one_datagram() {
        let start = Instant::now();
        let mut pace = Pace::new(start);
        let late = start + Duration::from_millis(50);
        pace.sent(late, 64_000, 921_600, 0, false);
        assert!(pace.due() <= late);
        pace.sent(late, 64_000, 921_600, 0, false);
        assert!(pace.due() > late);
    }
}
