//! The clock on the wall: alone in its test binary, so that no other simulator takes the cores meanwhile.

mod live;

use live::{Simulator, next_frame};
use std::collections::HashMap;
use std::time::{Duration, Instant};

/// Rates may be off by that part of what was asked.
const RATE_TOLERANCE: f64 = 0.005;

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
    let mut arrivals: HashMap<&str, Vec<(Instant, u64)>> = HashMap::new();
    while Instant::now() < end {
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
                    assert_eq!(frame.missed(), 0, "{topic} has a gap");
                    arrivals.entry(topic).or_default().push((Instant::now(), header.stamp_ns));
                }
            }
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    for (topic, numerator, denominator) in asked.iter().filter(|(_, numerator, _)| *numerator > 0) {
        let seen = &arrivals[topic];
        let (first, last) = (seen.first().unwrap(), seen.last().unwrap());
        let rate = (seen.len() - 1) as f64 / (last.0 - first.0).as_secs_f64();
        let wanted = *numerator as f64 / *denominator as f64;
        assert!(
            (rate - wanted).abs() < wanted * RATE_TOLERANCE,
            "{topic} comes at {rate:.3} Hz instead of {wanted} Hz"
        );
        let spacing = (last.1 - first.1) as f64 * 1e-9 / (seen.len() - 1) as f64;
        assert!((spacing * wanted - 1.0).abs() < 1e-6, "{topic}: a stamp every {spacing} s");
    }
}
