//! Which way a laser scanner fires, from where, and when.

use super::error::ScannerError;
use super::rosette::Rosette;
use super::spinning::Spinning;
use crate::simd::{LANES, Lanes};
use glam::DVec3;

/// Most firings of a frame.
pub const MAX_FIRINGS: usize = 16_777_216;

/// A pulse of a laser.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Firing {
    /// Seconds after the beginning of the frame.
    pub time_s: f64,
    /// Where it starts, in the frame of the sensor (x ahead, y left, z up) as that is at the time.
    pub origin: DVec3,
    /// Which way it goes there; a unit vector.
    pub direction: DVec3,
    /// Which laser it is of, from 0.
    pub laser: u32,
}

/// The firings of a scanner, frame after frame.
///
/// A frame begins at a multiple of its [time](super::ScannerConfig::frame_time_ns) and has all firings that begin
/// before the next.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Pattern<'a> {
    /// A head that turns once a frame, with lasers one above the other.
    Spinning(Spinning<'a>),
    /// Two prisms that turn.
    Rosette(Rosette),
    /// The same firings in each frame, in the order of their times: a raster, a flash, whatever else.
    Table(&'a [Firing]),
}

impl Pattern<'_> {
    /// That there are firings in each frame, in the order of time.
    pub(super) fn check(&self, frame_time_ns: u64) -> Result<(), ScannerError> {
        match self {
            Self::Spinning(spinning) => spinning.check(frame_time_ns)?,
            Self::Rosette(rosette) => rosette.check(frame_time_ns)?,
            Self::Table(firings) => check_table(firings, frame_time_ns)?,
        }
        let most = self.most_firings(frame_time_ns);
        if !(1..=MAX_FIRINGS as u128).contains(&most) {
            return Err(ScannerError {
                parameter: "firings of a frame",
                index: None,
                value: most as f64,
                rule: "1 to 16777216",
            });
        }
        Ok(())
    }

    /// Firings that no frame has more of.
    pub(super) fn most_firings(&self, frame_time_ns: u64) -> u128 {
        match self {
            Self::Spinning(spinning) => spinning.most_firings(frame_time_ns),
            Self::Rosette(rosette) => u128::from(rosette.clock().most(frame_time_ns)),
            Self::Table(firings) => firings.len() as u128,
        }
    }

    /// The firings of a frame.
    pub(super) fn in_frame(&self, frame: u64, frame_time_ns: u64) -> FrameFirings<'_> {
        let (ticks, count) = match self {
            Self::Spinning(spinning) => {
                let ticks = spinning.clock().map(|clock| clock.in_frame(frame, frame_time_ns));
                let columns = ticks.map_or(spinning.columns_at_angles(), |ticks| ticks.count);
                (ticks, columns as usize * spinning.lasers.len())
            }
            Self::Rosette(rosette) => {
                let ticks = rosette.clock().in_frame(frame, frame_time_ns);
                (Some(ticks), ticks.count as usize)
            }
            Self::Table(firings) => (None, firings.len()),
        };
        FrameFirings { pattern: self, frame_time_ns, ticks, count }
    }
}

/// The firings of one frame, in the order of time.
#[derive(Debug, Clone, Copy)]
pub(super) struct FrameFirings<'a> {
    pattern: &'a Pattern<'a>,
    frame_time_ns: u64,
    /// Of a pattern that goes on without regard to frames.
    ticks: Option<Ticks>,
    pub(super) count: usize,
}

impl FrameFirings<'_> {
    /// When one of them is, in seconds after the frame's beginning.
    pub(super) fn time_s(&self, index: usize) -> f64 {
        match self.pattern {
            Pattern::Spinning(spinning) => spinning.time_s(self.ticks.as_ref(), self.frame_time_ns, index),
            Pattern::Rosette(_) => self.ticks.map_or(0.0, |ticks| ticks.time_s(index as u64)),
            Pattern::Table(firings) => firings[index].time_s,
        }
    }

    /// One of them.
    pub(super) fn firing(&self, index: usize) -> Firing {
        let mut volley = FiringLanes::new();
        self.fill(index, 1, &mut volley);
        volley.lane(0)
    }

    /// Up to 64 of them.
    #[inline(always)]
    pub(super) fn fill(&self, first: usize, count: usize, lanes: &mut FiringLanes) {
        match (self.pattern, &self.ticks) {
            (Pattern::Spinning(spinning), ticks) => {
                spinning.fill(ticks.as_ref(), self.frame_time_ns, (first, count), lanes);
            }
            (Pattern::Rosette(rosette), Some(ticks)) => rosette.fill(ticks, (first, count), lanes),
            (Pattern::Table(firings), _) => {
                for (lane, firing) in firings[first..][..count].iter().enumerate() {
                    lanes.set(lane, firing);
                }
            }
            // It ticks.
            (Pattern::Rosette(_), None) => {}
        }
    }
}

/// Up to 64 firings, lane by lane.
pub(super) struct FiringLanes {
    pub(super) time_s: Lanes<f64>,
    pub(super) origin: [Lanes<f64>; 3],
    pub(super) direction: [Lanes<f64>; 3],
    pub(super) laser: Lanes<u32>,
}

impl FiringLanes {
    pub(super) const fn new() -> Self {
        Self {
            time_s: [0.0; LANES],
            origin: [[0.0; LANES]; 3],
            direction: [[0.0; LANES]; 3],
            laser: [0; LANES],
        }
    }

    #[inline(always)]
    pub(super) fn set(&mut self, lane: usize, firing: &Firing) {
        self.time_s[lane] = firing.time_s;
        self.laser[lane] = firing.laser;
        for axis in 0..3 {
            self.origin[axis][lane] = firing.origin[axis];
            self.direction[axis][lane] = firing.direction[axis];
        }
    }

    #[inline(always)]
    pub(super) fn lane(&self, lane: usize) -> Firing {
        let of = |lanes: &[Lanes<f64>; 3]| DVec3::new(lanes[0][lane], lanes[1][lane], lanes[2][lane]);
        Firing {
            time_s: self.time_s[lane],
            origin: of(&self.origin),
            direction: of(&self.direction),
            laser: self.laser[lane],
        }
    }
}

fn check_table(firings: &[Firing], frame_time_ns: u64) -> Result<(), ScannerError> {
    let end = frame_time_ns as f64 * 1e-9;
    let mut before = 0.0;
    for (index, firing) in firings.iter().enumerate() {
        let wrong = |parameter, value, rule| Err(ScannerError { parameter, index: Some(index), value, rule });
        let length = firing.direction.length();
        if !firing.origin.is_finite() {
            return wrong("origin of firing", firing.origin.x + firing.origin.y + firing.origin.z, "finite");
        }
        if !(0.999_999..=1.000_001).contains(&length) {
            return wrong("length of the direction of firing", length, "1, to a millionth");
        }
        if !(before..end).contains(&firing.time_s) {
            return wrong(
                "time_s of firing",
                firing.time_s,
                "not before that of the firing before, and less than the frame's",
            );
        }
        before = firing.time_s;
    }
    Ok(())
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

    /// The same in seconds.
    pub(super) fn time_s(&self, tick: u64) -> f64 {
        self.at_ns(tick) as f64 * 1e-9
    }
}
