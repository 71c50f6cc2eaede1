//! Measures two sides alternately.
//!
//! The speed of the machine changes by tens of per cent from minute to minute, so absolute times of two runs cannot be
//! compared. Each round measures both sides one right after the other, and the median of the rounds' ratios is
//! reported. For wall time, which other processes prolong, the ratio of the best rounds is reported.

use super::clock::Clock;
use super::figures::median;

/// One side of a comparison.
pub struct Side<'a> {
    /// The work.
    pub call: &'a mut dyn FnMut(),
    /// The units of work per call: the number of rays, or 1.
    pub work: f64,
}

/// The result of a comparison.
#[derive(Debug, Clone, Copy)]
pub struct Measured {
    /// Our seconds per unit of work.
    pub ours_s: f64,
    /// The other side's seconds per unit of work.
    pub theirs_s: f64,
    /// The other side's time divided by ours: how many times as fast we are.
    pub ratio: f64,
}

/// The calls of a side are repeated until a sample takes this long.
const SAMPLE_S: f64 = 0.012;
/// The largest number of repetitions.
const MOST_CALLS: f64 = 1000.0;

/// Factor by which wall time is measured in more rounds, so that at least one is undisturbed.
const WALL_ROUNDS: usize = 5;

/// Measures both sides for `rounds` rounds.
pub fn measure(clock: Clock, rounds: usize, mut ours: Side<'_>, mut theirs: Side<'_>) -> Measured {
    let rounds = match clock {
        Clock::Thread => rounds,
        Clock::Wall => WALL_ROUNDS * rounds,
    };
    let ours_calls = calls(clock, &mut ours);
    let theirs_calls = calls(clock, &mut theirs);
    let mut samples: [Vec<f64>; 3] = Default::default();
    for round in 0..rounds {
        // The second side finds the other one's data in the cache, so the order alternates.
        let (ours_s, theirs_s) = if round % 2 == 0 {
            let ours_s = sample(clock, &mut ours, ours_calls);
            (ours_s, sample(clock, &mut theirs, theirs_calls))
        } else {
            let theirs_s = sample(clock, &mut theirs, theirs_calls);
            (sample(clock, &mut ours, ours_calls), theirs_s)
        };
        for (samples, sample) in samples.iter_mut().zip([ours_s, theirs_s, theirs_s / ours_s]) {
            samples.push(sample);
        }
    }
    match clock {
        Clock::Thread => {
            let [ours_s, theirs_s, ratio] = samples.map(median);
            Measured { ours_s, theirs_s, ratio }
        }
        // Other processes make wall time longer, never shorter.
        Clock::Wall => {
            let [ours_s, theirs_s, _] =
                samples.map(|samples| samples.into_iter().fold(f64::INFINITY, f64::min));
            Measured { ours_s, theirs_s, ratio: theirs_s / ours_s }
        }
    }
}

/// A first call that takes this long needs no warm-up.
const LONG_S: f64 = 0.1;

/// Returns the number of calls per sample. This also warms up.
fn calls(clock: Clock, side: &mut Side<'_>) -> usize {
    let cold_s = sample(clock, side, 1) * side.work;
    if cold_s > LONG_S {
        return 1;
    }
    let once_s = sample(clock, side, 1) * side.work;
    (SAMPLE_S / once_s.max(1e-9)).ceil().clamp(1.0, MOST_CALLS) as usize
}

/// Returns the seconds per unit of work, as the mean of some calls.
fn sample(clock: Clock, side: &mut Side<'_>, calls: usize) -> f64 {
    let start_s = clock.now_s();
    for _ in 0..calls {
        (side.call)();
    }
    (clock.now_s() - start_s) / (calls as f64 * side.work)
}
