//! Rate, jitter, latency and gaps of a stream that is being received.

use std::time::Instant;

/// Measurements of the frames received from a stream.
#[derive(Clone, Debug, Default)]
pub struct StreamStatistics {
    first: Option<Instant>,
    last: Option<Instant>,
    intervals_s: Vec<f64>,
    latencies_ns: Vec<u64>,
    gaps: u64,
}

/// The figures of a stream; those that need more frames are `None`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// Frames per second over the time between the first and the last.
    pub rate_hz: Option<f64>,
    /// Standard deviation of the time between frames, milliseconds.
    pub jitter_ms: Option<f64>,
    /// Median time from sending to reading, microseconds.
    pub latency_us_p50: Option<f64>,
    /// 99th percentile of the time from sending to reading, microseconds.
    pub latency_us_p99: Option<f64>,
    /// Frames received.
    pub frames: u64,
    /// Frames sent and not received.
    pub gaps: u64,
}

impl StreamStatistics {
    /// Counts a frame that was received at `now`, `latency_ns` after it was sent, with `missed` frames between it and
    /// the previous one.
    pub fn add(&mut self, now: Instant, latency_ns: u64, missed: u64) {
        if let Some(last) = self.last.replace(now) {
            self.intervals_s.push((now - last).as_secs_f64());
        }
        self.first.get_or_insert(now);
        self.latencies_ns.push(latency_ns);
        self.gaps += missed;
    }

    /// Forgets everything except the time of the last frame, at which the next interval starts.
    pub fn start_anew(&mut self) {
        *self = Self { first: self.last, last: self.last, ..Self::default() };
    }

    /// Returns the figures.
    #[must_use]
    pub fn summary(&self) -> Summary {
        let intervals = self.intervals_s.len() as f64;
        let span_s = self.first.zip(self.last).map_or(0.0, |(first, last)| (last - first).as_secs_f64());
        let mean_s = span_s / intervals;
        let variance =
            self.intervals_s.iter().map(|interval| (interval - mean_s).powi(2)).sum::<f64>() / intervals;
        let mut latencies_ns = self.latencies_ns.clone();
        latencies_ns.sort_unstable();
        // The smallest value that at least this share does not exceed (nearest rank).
        let percentile = |share: f64| {
            let rank = (share * latencies_ns.len() as f64).ceil() as usize;
            latencies_ns.get(rank.saturating_sub(1)).map(|&ns| ns as f64 / 1e3)
        };
        Summary {
            rate_hz: (span_s > 0.0).then(|| intervals / span_s),
            jitter_ms: (intervals > 0.0).then(|| variance.sqrt() * 1e3),
            latency_us_p50: percentile(0.50),
            latency_us_p99: percentile(0.99),
            frames: self.latencies_ns.len() as u64,
            gaps: self.gaps,
        }
    }
}

impl Summary {
    /// Returns the figures as one JSON object.
    #[must_use]
    pub fn json(&self, topic: &str) -> serde_json::Value {
        let round = |value: Option<f64>| value.map(|value| (value * 1e3).round() / 1e3);
        serde_json::json!({
            "topic": topic,
            "rate_hz": round(self.rate_hz),
            "jitter_ms": round(self.jitter_ms),
            "latency_us_p50": round(self.latency_us_p50),
            "latency_us_p99": round(self.latency_us_p99),
            "frames": self.frames,
            "gaps": self.gaps,
        })
    }
}

impl std::fmt::Display for Summary {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let show = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{value:.2}"));
        write!(
            f,
            "rate {} Hz   jitter {} ms   latency p50 {} us  p99 {} us   frames {}   gaps {}",
            show(self.rate_hz),
            show(self.jitter_ms),
            show(self.latency_us_p50),
            show(self.latency_us_p99),
            self.frames,
            self.gaps
        )
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn figures_of_a_known_series() {
        let start = Instant::now();
        let mut statistics = StreamStatistics::default();
        for (index, at_ms) in [0, 90, 210, 300, 400].into_iter().enumerate() {
            let missed = u64::from(index == 2);
            statistics.add(start + Duration::from_millis(at_ms), 1000 * (index as u64 + 1), missed);
        }
        let summary = statistics.summary();
        assert!((summary.rate_hz.unwrap() - 10.0).abs() < 1e-9);
        // Intervals 90, 120, 90, 100: mean 100, variance (100 + 400 + 100 + 0) / 4.
        assert!((summary.jitter_ms.unwrap() - 150.0_f64.sqrt()).abs() < 1e-6);
        assert_eq!((summary.latency_us_p50, summary.latency_us_p99), (Some(3.0), Some(5.0)));
        assert_eq!((summary.frames, summary.gaps), (5, 1));

        statistics.start_anew();
        statistics.add(start + Duration::from_millis(500), 1000, 0);
        assert!((statistics.summary().rate_hz.unwrap() - 10.0).abs() < 1e-9);
    }

    #[test]
    fn figures_without_frames_are_absent() {
        let mut statistics = StreamStatistics::default();
        assert_eq!(statistics.summary().rate_hz, None);
        statistics.add(Instant::now(), 5, 0);
        let summary = statistics.summary();
        assert_eq!((summary.rate_hz, summary.jitter_ms, summary.frames), (None, None, 1));
    }
}
