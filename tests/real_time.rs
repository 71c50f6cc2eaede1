//! The clock on the wall: alone in its test binary, so that no other simulator takes the cores meanwhile.

mod live;

use live::{Simulator, next_frame};
use std::collections::HashMap;
use std::time::{Duration, Instant};

/// Rates may be off by that part of what was asked.
const RATE_TOLERANCE: f64 = 0.005;

/// Pictures are published as steadily as this where cores are free, three of four at least: what the machine does
/// besides may delay some.
const STEADY: Duration = Duration::from_micros(300);
/// Part of the cores' time that is idle where cores are free: the simulator takes a fifth of two.
const FREE: f64 = 0.5;

/// Ticks that the cores were idle and ticks in all, since the machine was started.
fn ticks() -> [f64; 2] {
    let stat = std::fs::read_to_string("/proc/stat").unwrap();
    let ticks: Vec<f64> =
        stat.lines().next().unwrap().split_whitespace().skip(1).map(|n| n.parse().unwrap()).collect();
    [ticks[3], ticks[..8].iter().sum()]
}

/// What is known of a frame that came.
struct Arrival {
    at: Instant,
    stamp_ns: u64,
    /// Frames that were missed before it.
    missed: u64,
    /// When it was published, by the clock, after its stamp: the same for all frames but for delays.
    lag_ns: i64,
    /// Since this stream was looked at before.
    away: Duration,
}

/// Two cores, 20 seconds: every stream comes at the rate that was asked for, and each stamp is ⌊k·10⁹/rate⌋.
#[test]
fn rates_and_stamps_hold_in_real_time() {
    let simulator = Simulator::start(&[]);
    let node = simulator.node();
    // (topic, exact rate as a fraction)
    let asked: [(&str, u64, u64); 8] = [
        ("/image_raw", 30, 1),
        ("/camera_info", 30, 1),
        ("/scan", 11, 2),
        ("/odom", 50, 1),
        ("/tf", 50, 1),
        ("/joint_states", 50, 1),
        ("/clock", 100, 1),
        ("/tf_static", 0, 1),
    ];
    let mut subscribers: Vec<_> = asked.iter().map(|(topic, ..)| node.subscriber(topic).unwrap()).collect();
    // Until all are there and the bustle of the start is over.
    for subscriber in &mut subscribers {
        next_frame(subscriber);
    }
    let settled = Instant::now() + Duration::from_secs(1);
    let end = settled + Duration::from_secs(20);
    let mut arrivals: HashMap<&str, Vec<Arrival>> = HashMap::new();
    let mut looked = Instant::now();
    let ticks_before = ticks();
    while Instant::now() < end {
        let away = looked.elapsed();
        looked = Instant::now();
        for (subscriber, (topic, numerator, denominator)) in subscribers.iter_mut().zip(&asked) {
            while let Some(frame) = subscriber.take().unwrap() {
                let header = frame.header();
                if *numerator > 0 {
                    // seq counts from the first frame, which is stamped 0.
                    let k = (u128::from(header.stamp_ns) * u128::from(*numerator))
                        .div_ceil(1_000_000_000 * u128::from(*denominator));
                    let exact = k * 1_000_000_000 * u128::from(*denominator) / u128::from(*numerator);
                    assert_eq!(u128::from(header.stamp_ns), exact, "{topic}: the stamp of frame {k}");
                }
                if Instant::now() >= settled {
                    arrivals.entry(topic).or_default().push(Arrival {
                        at: Instant::now(),
                        stamp_ns: header.stamp_ns,
                        missed: frame.missed(),
                        lag_ns: header.publish_mono_ns as i64 - header.stamp_ns as i64,
                        away,
                    });
                }
            }
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    for (topic, numerator, denominator) in asked.iter().filter(|(_, numerator, _)| *numerator > 0) {
        let seen = &arrivals[topic];
        let (first, last) = (seen.first().unwrap(), seen.last().unwrap());
        let wanted = *numerator as f64 / *denominator as f64;
        let period = Duration::from_secs_f64(1.0 / wanted);
        let in_time_ns = seen.iter().map(|arrival| arrival.lag_ns).min().unwrap();
        for arrival in seen {
            // A buffer of two overflows when nobody looks for a period, or when what is late comes all at once.
            let late = Duration::from_nanos((arrival.lag_ns - in_time_ns) as u64);
            let has_cause = arrival.away >= period || late >= period;
            assert!(arrival.missed == 0 || has_cause, "{topic} misses {} without a cause", arrival.missed);
        }
        let sent = seen.len() as u64 - 1 + seen[1..].iter().map(|arrival| arrival.missed).sum::<u64>();
        let rate = sent as f64 / (last.at - first.at).as_secs_f64();
        assert!(
            (rate - wanted).abs() < wanted * RATE_TOLERANCE,
            "{topic} comes at {rate:.3} Hz instead of {wanted} Hz"
        );
        let spacing = (last.stamp_ns - first.stamp_ns) as f64 * 1e-9 / sent as f64;
        assert!((spacing * wanted - 1.0).abs() < 1e-6, "{topic}: a stamp every {spacing} s");
    }

    let mut lags: Vec<i64> = arrivals["/image_raw"].iter().map(|arrival| arrival.lag_ns).collect();
    lags.sort_unstable();
    let middle = lags[lags.len() / 2];
    let mut off: Vec<u64> = lags.iter().map(|lag| lag.abs_diff(middle)).collect();
    off.sort_unstable();
    let part = |of: f64| Duration::from_nanos(off[(off.len() as f64 * of) as usize]);
    let [idle, all] = std::array::from_fn(|index| ticks()[index] - ticks_before[index]);
    println!(
        "pictures are published off their rhythm by p50 {:?}, p75 {:?}, p95 {:?}; cores were idle for {:.0} % of the time",
        part(0.5),
        part(0.75),
        part(0.95),
        100.0 * idle / all
    );
    assert!(
        part(0.75) < STEADY || idle < FREE * all,
        "pictures come off their rhythm by {:?}, one of four, and cores are free",
        part(0.75)
    );
}
