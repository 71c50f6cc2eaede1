//! Real-time tests. They are a program of their own, so that no other simulator uses the cores meanwhile.

mod live;

use belvedere_bridge::Subscriber;
use live::{Simulator, next_frame};
use std::collections::HashMap;
use std::time::{Duration, Instant};

/// The tolerance of the rate of simulated time, relative to the clock.
const RATE_TOLERANCE: f64 = 0.005;
/// Three of four pictures are published with at most this jitter, if the machine wakes up sleeping threads as
/// punctually.
const STEADY: Duration = Duration::from_micros(300);
/// The duration of each try.
const TRY: Duration = Duration::from_secs(7);

/// (topic, exact rate as a fraction)
const ASKED: [(&str, u64, u64); 8] = [
    ("/image_raw", 30, 1),
    ("/camera_info", 30, 1),
    ("/scan", 11, 2),
    ("/odom", 50, 1),
    ("/tf", 50, 1),
    ("/joint_states", 50, 1),
    ("/clock", 100, 1),
    ("/tf_static", 0, 1),
];

/// The data of a received frame.
struct Arrival {
    stamp_ns: u64,
    /// The number of frames that were missed before it.
    missed: u64,
    /// The time of publication by the clock minus the timestamp: the same for all frames except for delays.
    lag_ns: i64,
    /// The time since the previous poll of this stream.
    away: Duration,
}

/// The frames received within [`TRY`].
struct Seen {
    arrivals: HashMap<&'static str, Vec<Arrival>>,
    /// The excess of each sleep of this test, sorted.
    overslept: Vec<Duration>,
}

impl Seen {
    /// Polls all streams, and checks that timestamps are exact.
    fn watch(subscribers: &mut [Subscriber]) -> Self {
        const NAP: Duration = Duration::from_millis(1);
        let mut arrivals: HashMap<&str, Vec<Arrival>> = HashMap::new();
        let mut overslept = Vec::new();
        let end = Instant::now() + TRY;
        let mut looked = Instant::now();
        while Instant::now() < end {
            let away = looked.elapsed();
            looked = Instant::now();
            for (subscriber, (topic, numerator, denominator)) in subscribers.iter_mut().zip(&ASKED) {
                while let Some(frame) = subscriber.take().unwrap() {
                    let header = frame.header();
                    if *numerator > 0 {
                        // seq counts from the first frame, whose timestamp is 0.
                        let k = (u128::from(header.stamp_ns) * u128::from(*numerator))
                            .div_ceil(1_000_000_000 * u128::from(*denominator));
                        let exact = k * 1_000_000_000 * u128::from(*denominator) / u128::from(*numerator);
                        assert_eq!(u128::from(header.stamp_ns), exact, "{topic}: the stamp of frame {k}");
                    }
                    arrivals.entry(topic).or_default().push(Arrival {
                        stamp_ns: header.stamp_ns,
                        missed: frame.missed(),
                        lag_ns: header.publish_mono_ns as i64 - header.stamp_ns as i64,
                        away,
                    });
                }
            }
            let asleep = Instant::now();
            std::thread::sleep(NAP);
            overslept.push(asleep.elapsed().saturating_sub(NAP));
        }
        overslept.sort_unstable();
        Self { arrivals, overslept }
    }

    /// Checks that every requested frame was sent, and that simulated time has the same offset from the clock at the
    /// end as at the beginning.
    fn assert_rates(&self) {
        for (topic, numerator, denominator) in ASKED.iter().filter(|(_, numerator, _)| *numerator > 0) {
            let seen = &self.arrivals[topic];
            let (first, last) = (seen.first().unwrap(), seen.last().unwrap());
            let wanted_hz = *numerator as f64 / *denominator as f64;
            let period = Duration::from_secs_f64(1.0 / wanted_hz);
            let least_lag_ns = |part: &[Arrival]| part.iter().map(|arrival| arrival.lag_ns).min().unwrap();
            for arrival in seen {
                // A buffer of two frames overflows if it is not polled for a period, or if late frames arrive all at
                // once.
                let late = Duration::from_nanos((arrival.lag_ns - least_lag_ns(seen)) as u64);
                let has_cause = arrival.away >= period || late >= period;
                assert!(
                    arrival.missed == 0 || has_cause,
                    "{topic} misses {} without a reason",
                    arrival.missed
                );
            }
            let sent = seen.len() as u64 - 1 + seen[1..].iter().map(|arrival| arrival.missed).sum::<u64>();
            let seconds = (last.stamp_ns - first.stamp_ns) as f64 * 1e-9;
            assert!(
                (seconds / sent as f64 * wanted_hz - 1.0).abs() < 1e-6,
                "{topic}: {sent} frames in {seconds} s"
            );
            // The least lag of many is that of a frame without any delay.
            let (early, late) = seen.split_at(seen.len() / 2);
            let drift = (least_lag_ns(late) - least_lag_ns(early)) as f64 * 1e-9 / (seconds / 2.0);
            assert!(drift.abs() < RATE_TOLERANCE, "{topic}: {:.2} % off the clock", 100.0 * drift);
        }
    }

    /// Returns true if pictures are published in their rhythm, about as punctually as this test wakes up from its
    /// sleeps.
    fn is_steady(&self) -> bool {
        let mut lags: Vec<i64> = self.arrivals["/image_raw"].iter().map(|arrival| arrival.lag_ns).collect();
        lags.sort_unstable();
        let middle = lags[lags.len() / 2];
        let mut off: Vec<u64> = lags.iter().map(|lag| lag.abs_diff(middle)).collect();
        off.sort_unstable();
        let part = |of: f64| Duration::from_nanos(off[(off.len() as f64 * of) as usize]);
        let overslept = self.overslept[self.overslept.len() * 3 / 4];
        println!(
            "pictures are published off their rhythm by p50 {:?}, p75 {:?}, p95 {:?}; sleeps are too long by p75 {overslept:?}",
            part(0.5),
            part(0.75),
            part(0.95),
        );
        part(0.75) < STEADY.max(3 * overslept)
    }
}

/// On two cores, every stream has the requested rate, each timestamp is ⌊k·10⁹/rate⌋, and pictures come steadily. Other
/// load may delay some of them, so one of five tries must succeed.
#[test]
fn rates_and_stamps_hold_in_real_time() {
    let simulator = Simulator::start(&[]);
    let node = simulator.node();
    let mut subscribers: Vec<_> = ASKED.iter().map(|(topic, ..)| node.subscriber(topic).unwrap()).collect();
    // Until all streams exist and the load of the start is over.
    for subscriber in &mut subscribers {
        next_frame(subscriber);
    }
    std::thread::sleep(Duration::from_secs(1));
    let is_steady = |_| {
        // Frames received before are not part of the try.
        for subscriber in &mut subscribers {
            while subscriber.take().unwrap().is_some() {}
        }
        let seen = Seen::watch(&mut subscribers);
        seen.assert_rates();
        seen.is_steady()
    };
    assert!((0..5).any(is_steady), "pictures come off their rhythm");
}
