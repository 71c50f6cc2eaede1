//! Two things timed in turns.
//!
//! The machine's pace changes by tens of per cent from minute to minute, so absolute times of two runs cannot be
//! compared. Each round here times both sides one right after the other, and what is reported is the median of
//! the rounds' ratios; of wall time, which whatever else runs on the machine prolongs, the ratio of the best.

use super::clock::Clock;
use super::figures::median;

/// One of the two.
pub struct Side<'a> {
    /// What is done.
    pub call: &'a mut dyn FnMut(),
    /// How much is done by a call: rays, or 1 for a whole.
    pub work: f64,
}

/// What came out.
#[derive(Debug, Clone, Copy)]
pub struct Measured {
    /// Seconds a unit of work.
    pub ours_s: f64,
    /// As `ours_s`.
    pub theirs_s: f64,
    /// Theirs over ours: how many times as fast we are.
    pub ratio: f64,
}

/// Calls of a side are repeated until a sample takes as long.
const SAMPLE_S: f64 = 0.012;
/// But not more often than this.
const MOST_CALLS: f64 = 1000.0;

/// Of wall time so many times as many rounds are taken, as one that nothing prolonged must be among them.
const WALL_ROUNDS: usize = 5;

/// Times both for `rounds` rounds.
pub fn measure(clock: Clock, rounds: usize, mut ours: Side<'_>, mut theirs: Side<'_>) -> Measured {
    let rounds = match clock {
        Clock::Thread => rounds,
        Clock::Wall => WALL_ROUNDS * rounds,
    };
    let ours_calls = calls(clock, &mut ours);
    let theirs_calls = calls(clock, &mut theirs);
    let mut samples: [Vec<f64>; 3] = Default::default();
    for round in 0..rounds {
        // Who comes second finds the other's data in the cache: take turns.
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
        // Others on the machine make wall time longer, never shorter.
        Clock::Wall => {
            let [ours_s, theirs_s, _] =
                samples.map(|samples| samples.into_iter().fold(f64::INFINITY, f64::min));
            Measured { ours_s, theirs_s, ratio: theirs_s / ours_s }
        }
    }
}

/// A call that takes so long needs no warming up before it is timed to see how long it takes.
const LONG_S: f64 = 0.1;

/// How many calls make a sample; also warms up.
fn calls(clock: Clock, side: &mut Side<'_>) -> usize {
    let cold_s = sample(clock, side, 1) * side.work;
    if cold_s > LONG_S {
        return 1;
    }
    let once_s = sample(clock, side, 1) * side.work;
    (SAMPLE_S / once_s.max(1e-9)).ceil().clamp(1.0, MOST_CALLS) as usize
}

/// Seconds a unit of work, on the average of some calls.
fn sample(clock: Clock, side: &mut Side<'_>, calls: usize) -> f64 {
    let start_s = clock.now_s();
    for _ in 0..calls {
        (side.call)();
    }
    (clock.now_s() - start_s) / (calls as f64 * side.work)
}
