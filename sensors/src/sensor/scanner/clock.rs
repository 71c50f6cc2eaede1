//! What goes on from frame to frame: the times of firings that know of no frames.

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

    /// The same in seconds.
    pub(super) fn time_s(&self, tick: u64) -> f64 {
        self.at_ns(tick) as f64 * 1e-9
    }
}
