//! What goes on from frame to frame: the times of firings that know of no frames.

/// A minute, in which what turns so many times a minute makes a whole number of turns.
pub(super) const MINUTE_NS: i128 = 60_000_000_000;

/// Turns at a time since some minute began, less whole ones, which are left out before anything is rounded.
#[inline(always)]
pub(super) fn turns(at_ns: i128, per_min: i64) -> f64 {
    (at_ns * i128::from(per_min)).rem_euclid(MINUTE_NS) as f64 / MINUTE_NS as f64
}

/// Something that ticks without regard to frames: from time 0 on, every so many nanoseconds.
#[derive(Debug, Clone, Copy)]
pub(super) struct Clock {
    pub(super) tick_ns: u64,
}

impl Clock {
    /// The ticks in a frame.
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

    /// Ticks that no frame has more of.
    pub(super) fn most(self, frame_time_ns: u64) -> u64 {
        frame_time_ns.div_ceil(self.tick_ns)
    }
}

/// The ticks of a clock in one frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ticks {
    tick_ns: u64,
    /// From the frame's beginning to the first.
    first_ns: u64,
    pub(super) count: u64,
    /// From time 0 to the frame's beginning.
    pub(super) begin_ns: u128,
}

impl Ticks {
    /// Nanoseconds from the frame's beginning to one of them.
    pub(super) fn at_ns(&self, tick: u64) -> u64 {
        self.first_ns + tick * self.tick_ns
    }

    /// Nanoseconds from the beginning of the minute in which the frame begins to one of them.
    #[inline(always)]
    pub(super) fn in_minute_ns(&self, tick: u64) -> i128 {
        (self.begin_ns % MINUTE_NS as u128) as i128 + i128::from(self.at_ns(tick))
    }

    /// The same as [`Ticks::at_ns`] in seconds.
    pub(super) fn time_s(&self, tick: u64) -> f64 {
        self.at_ns(tick) as f64 * 1e-9
    }
}
