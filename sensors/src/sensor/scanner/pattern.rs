//! Firing patterns: direction, origin and time of each firing.

use super::clock::Ticks;
use super::firing::{Firing, FiringLanes};
use super::mems::Mems;
use super::prisms::Prisms;
use super::raster::Raster;
use super::rosette::Rosette;
use super::spinning::Spinning;
use crate::ParameterError;

/// The largest number of firings of a frame.
pub const MAX_FIRINGS: usize = 16_777_216;

/// A firing pattern: the firings of a scanner, frame after frame.
///
/// A frame begins at a multiple of its [time](super::ScannerConfig::frame_time_ns) and contains all firings that begin
/// before the next frame.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Pattern<'a> {
    /// A head that turns once per frame, with lasers above each other.
    Spinning(Spinning<'a>),
    /// Two rotating prisms (Risley prisms).
    Rosette(Rosette),
    /// Several lasers behind rotating prisms and mirrors.
    Prisms(Prisms<'a>),
    /// A mirror that oscillates about two axes.
    Mems(Mems<'a>),
    /// A grid of pixels over a field of view, scanned one after the other or all at once.
    Raster(Raster),
    /// Any other pattern: the same firings in each frame, in the order of time.
    Table(&'a [Firing]),
}

impl Pattern<'_> {
    /// Checks that each frame has firings, in the order of time.
    pub(super) fn check(&self, frame_time_ns: u64) -> Result<(), ParameterError> {
        match self {
            Self::Spinning(spinning) => spinning.check(frame_time_ns)?,
            Self::Rosette(rosette) => rosette.check(frame_time_ns)?,
            Self::Prisms(prisms) => prisms.check(frame_time_ns)?,
            Self::Mems(mems) => mems.check(frame_time_ns)?,
            Self::Raster(raster) => raster.check(frame_time_ns)?,
            Self::Table(firings) => check_table(firings, frame_time_ns)?,
        }
        let most = self.most_firings(frame_time_ns);
        if !(1..=MAX_FIRINGS as u128).contains(&most) {
            return Err(ParameterError::new("scanner", "firings of a frame", most as f64, "1 to 16777216"));
        }
        Ok(())
    }

    /// Returns the largest number of firings that a frame can have.
    pub(super) fn most_firings(&self, frame_time_ns: u64) -> u128 {
        match self {
            Self::Spinning(spinning) => spinning.most_firings(frame_time_ns),
            Self::Rosette(rosette) => u128::from(rosette.clock().most(frame_time_ns)),
            Self::Prisms(prisms) => prisms.most_firings(frame_time_ns),
            Self::Mems(mems) => u128::from(mems.clock().most(frame_time_ns)),
            Self::Raster(raster) => u128::from(raster.firings()),
            Self::Table(firings) => firings.len() as u128,
        }
    }

    /// Returns the firings of a frame.
    pub(super) fn in_frame(&self, frame: u64, frame_time_ns: u64) -> FrameFirings<'_> {
        let (ticks, count) = match self {
            Self::Spinning(spinning) => {
                let ticks = spinning.clock().map(|clock| clock.in_frame(frame, frame_time_ns));
                let columns = ticks.map_or(spinning.columns.at_angles(), |ticks| ticks.count);
                (ticks, columns as usize * spinning.lasers.len())
            }
            Self::Rosette(rosette) => {
                let ticks = rosette.clock().in_frame(frame, frame_time_ns);
                (Some(ticks), ticks.count as usize)
            }
            Self::Prisms(prisms) => {
                let ticks = prisms.clock().in_frame(frame, frame_time_ns);
                (Some(ticks), ticks.count as usize * prisms.lasers_rad.len())
            }
            Self::Mems(mems) => {
                let ticks = mems.clock().in_frame(frame, frame_time_ns);
                (Some(ticks), ticks.count as usize)
            }
            Self::Raster(raster) => (None, raster.firings() as usize),
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
    /// The ticks of a pattern that continues independent of frames.
    ticks: Option<Ticks>,
    pub(super) count: usize,
}

impl FrameFirings<'_> {
    /// Returns the time of a firing, in seconds after the beginning of the frame.
    pub(super) fn time_s(&self, index: usize) -> f64 {
        match self.pattern {
            Pattern::Spinning(spinning) => spinning.time_s(self.ticks.as_ref(), self.frame_time_ns, index),
            Pattern::Rosette(_) | Pattern::Mems(_) => {
                self.ticks.map_or(0.0, |ticks| ticks.time_s(index as u64))
            }
            Pattern::Prisms(prisms) => self.ticks.map_or(0.0, |ticks| prisms.time_s(&ticks, index)),
            Pattern::Raster(raster) => raster.time_s(index),
            Pattern::Table(firings) => firings[index].time_s,
        }
    }

    /// Returns a firing.
    pub(super) fn firing(&self, index: usize) -> Firing {
        let mut volley = FiringLanes::new();
        self.fill(index, 1, &mut volley);
        volley.lane(0)
    }

    /// Fills lanes with up to 64 firings.
    #[inline(always)]
    pub(super) fn fill(&self, first: usize, count: usize, lanes: &mut FiringLanes) {
        match (self.pattern, &self.ticks) {
            (Pattern::Spinning(spinning), ticks) => {
                spinning.fill(ticks.as_ref(), self.frame_time_ns, (first, count), lanes);
            }
            (Pattern::Rosette(rosette), Some(ticks)) => rosette.fill(ticks, (first, count), lanes),
            (Pattern::Prisms(prisms), Some(ticks)) => prisms.fill(ticks, (first, count), lanes),
            (Pattern::Mems(mems), Some(ticks)) => mems.fill(ticks, (first, count), lanes),
            (Pattern::Raster(raster), _) => raster.fill((first, count), lanes),
            (Pattern::Table(firings), _) => {
                for (lane, firing) in firings[first..][..count].iter().enumerate() {
                    lanes.set(lane, firing);
                }
            }
            // These patterns always have ticks.
            (Pattern::Rosette(_) | Pattern::Prisms(_) | Pattern::Mems(_), None) => {}
        }
    }
}

fn check_table(firings: &[Firing], frame_time_ns: u64) -> Result<(), ParameterError> {
    let end = frame_time_ns as f64 * 1e-9;
    let mut before = 0.0;
    for (index, firing) in firings.iter().enumerate() {
        let wrong =
            |parameter, value, rule| Err(ParameterError::new("scanner", parameter, value, rule).at(index));
        let length = firing.direction.length();
        if !firing.origin.is_finite() {
            return wrong("origin of firing", firing.origin.x + firing.origin.y + firing.origin.z, "finite");
        }
        if !(0.999_999..=1.000_001).contains(&length) {
            return wrong("length of the direction of firing", length, "1 to within 1e-6");
        }
        if !(before..end).contains(&firing.time_s) {
            return wrong(
                "time_s of firing",
                firing.time_s,
                "not before that of the previous firing, and less than the frame's",
            );
        }
        before = firing.time_s;
    }
    Ok(())
}
