//! Firing times that continue from frame to frame, independent of frame boundaries.

use crate::ParameterError;

/// One minute in nanoseconds. Everything whose speed is a whole number of turns per minute makes a whole number of
/// turns in it.
pub(super) const MINUTE_NS: i128 = 60_000_000_000;

/// Returns the fraction of a turn at a time since the beginning of some minute. Whole turns are removed before
/// rounding.
#[inline(always)]
pub(super) fn turns(at_ns: i128, per_min: i64) -> f64 {
    (at_ns * i128::from(per_min)).rem_euclid(MINUTE_NS) as f64 / MINUTE_NS as f64
}

/// A clock that ticks every `tick_ns` nanoseconds from time 0 on, independent of frames.
#[derive(Debug, Clone, Copy)]
pub(super) struct Clock {
    pub(super) tick_ns: u64,
}

impl Clock {
    /// Checks that the clock ticks, and that a frame is not shorter than a tick. `parameter` is the name of the time of
    /// a tick. Where both times are sensible, the time of the frame is the one to blame: it is chosen last, and a
    /// preset fixes the other.
    pub(super) fn check(self, parameter: &'static str, frame_time_ns: u64) -> Result<(), ParameterError> {
        let tick_ns = self.tick_ns;
        ParameterError::require("scanner", parameter, tick_ns as f64, tick_ns > 0, "1 or more")?;
        let rule = "at least the time from one firing, volley or column of the pattern to the next";
        ParameterError::require(
            "scanner",
            "frame_time_ns",
            frame_time_ns as f64,
            tick_ns <= frame_time_ns,
            rule,
        )
    }

    /// Returns the ticks in a frame.
    pub(super) fn in_frame(self, frame: u64, frame_time_ns: u64) -> Ticks {
        let tick = u128::from(self.tick_ns);
        let begin = u128::from(frame) * u128::from(frame_time_ns);
        let (first, next) = (begin.div_ceil(tick), (begin + u128::from(frame_time_ns)).div_ceil(tick));
        Ticks {
            tick_ns: self.tick_ns,
            first_ns: (first * tick - begin) as u64,
            count: (next - first) as u64,
            begin_ns: begin,
        }
    }

    /// Returns the largest number of ticks that a frame can have.
    pub(super) fn most(self, frame_time_ns: u64) -> u64 {
        frame_time_ns.div_ceil(self.tick_ns)
    }
}

/// The ticks of a clock in one frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ticks {
    tick_ns: u64,
    /// The time from the beginning of the frame to the first tick.
    first_ns: u64,
    pub(super) count: u64,
    /// The time from time 0 to the beginning of the frame.
    pub(super) begin_ns: u128,
}

impl Ticks {
    /// Returns the time of a tick, in nanoseconds after the beginning of the frame.
    pub(super) fn at_ns(&self, tick: u64) -> u64 {
        self.first_ns + tick * self.tick_ns
    }

    /// Returns the time of a tick, in nanoseconds after the beginning of the minute in which the frame begins.
    #[inline(always)]
    pub(super) fn in_minute_ns(&self, tick: u64) -> i128 {
        (self.begin_ns % MINUTE_NS as u128) as i128 + i128::from(self.at_ns(tick))
    }

    /// Returns [`Ticks::at_ns`] in seconds.
    pub(super) fn time_s(&self, tick: u64) -> f64 {
        self.at_ns(tick) as f64 * 1e-9
    }
}
