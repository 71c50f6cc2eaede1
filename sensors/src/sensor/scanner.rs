//! Laser scanners as they are built: each firing at a time and from a place of its own.
//!
//! A [`Lidar`](crate::lidar::Lidar) is Gazebo's: an even grid of beams from one point. A [`Scanner`] has a
//! [`Pattern`] of firings, and traces each from where the sensor and everything else is at its time
//! ([`Shutter::Moving`]).

mod beam;
mod clock;
mod config;
mod crosstalk;
mod echoes;
mod error;
mod firing;
mod frame;
mod intensity;
mod mems;
mod motions;
mod pattern;
pub mod presets;
mod prisms;
mod raster;
mod returns;
mod rosette;
mod spinning;
mod weather;

use super::Sensor;
use crate::execution::{SplitRows, for_each_row};
use crate::memory::{CacheLine, Cutter};
use crate::moment::{Capture, Shutter};
use crate::noise::Stream;
use crate::scene::Scene;
use crate::simd::{LANES, dispatch, sqrt};
use crate::trace::grid::Sight;
use crate::trace::memory::view_lines;
use crate::trace::{SenseError, Workspace};
use beam::Bundle;
pub use beam::{Beam, Halo, MAX_BEAM_RAYS};
pub use config::{ScannerConfig, Spread};
pub use crosstalk::Crosstalk;
pub use echoes::Echoes;
pub use error::ScannerError;
use fearless_simd::Simd;
pub use firing::Firing;
use frame::Frame;
pub use intensity::{Intensity, Receiver};
pub use mems::{Mems, MirrorAxis, Wave};
use motions::Motions;
use pattern::FrameFirings;
pub use pattern::{MAX_FIRINGS, Pattern};
pub use prisms::{Axis, Face, MAX_WHEELS, Prisms, Swing, Wheel};
pub use raster::Raster;
use returns::Echo;
pub use returns::{MAX_RETURNS, Returns};
pub use rosette::Rosette;
pub use spinning::{Columns, Laser, MAX_LASERS, Spinning};
use weather::Air;
pub use weather::{DropSizes, Weather};

/// Pieces that a frame is dealt out in, at the most. Nothing else depends on it.
const MOST_PIECES: usize = 16;
/// A checked scanner.
#[derive(Debug, Clone, Copy)]
pub struct Scanner<'a> {
    config: ScannerConfig<'a>,
    bias: f32,
    bundle: Bundle,
    air: Air,
    /// The least that is noticed of what comes back.
    least: f64,
    /// Whether its beams are single rays, of which all comes back.
    is_line: bool,
    /// Whether it is asked how much comes back.
    is_lit: bool,
}

impl<'a> Scanner<'a> {
    /// Checks the configuration.
    ///
    /// # Errors
    /// Names the first parameter that is out of its range.
    pub fn new(config: ScannerConfig<'a>) -> Result<Self, ScannerError> {
        config.check()?;
        let ScannerConfig { beam, halo, crosstalk, returns, intensity, weather, .. } = config;
        let is_lit = intensity != Intensity::Retro
            || config.receiver.is_some()
            || weather != Weather::CLEAR
            || halo.share > 0.0
            || crosstalk != Crosstalk::NONE;
        let least = config.effective_receiver().map_or(0.0, |receiver| receiver.least());
        Ok(Self {
            bias: config.noise.bias(config.seed, config.sensor, 0),
            bundle: Bundle::new(&beam, &halo),
            air: Air::new(&weather, &beam, least),
            least,
            is_line: beam.rays == 1 && returns.count() == 1 && !is_lit,
            is_lit,
            config,
        })
    }

    /// What it was made from.
    pub fn config(&self) -> &ScannerConfig<'a> {
        &self.config
    }

    /// Returns of each firing, for which there is room in an [`Echoes`].
    pub fn returns(&self) -> usize {
        self.config.returns.count()
    }

    /// Firings that no frame has more of, for which there is room in an [`Echoes`].
    pub fn most_firings(&self) -> usize {
        self.config.pattern.most_firings(self.config.frame_time_ns) as usize
    }

    /// Firings of a frame.
    pub fn firings(&self, frame: u64) -> usize {
        self.in_frame(frame).count
    }

    /// A firing of a frame, in the order of time; the last for those that it does not have.
    pub fn firing(&self, frame: u64, index: usize) -> Firing {
        let firings = self.in_frame(frame);
        firings.firing(index.min(firings.count.saturating_sub(1)))
    }

    fn in_frame(&self, frame: u64) -> FrameFirings<'_> {
        self.config.pattern.in_frame(frame, self.config.frame_time_ns)
    }

    /// Whether ranges are what they are.
    #[inline(always)]
    fn is_exact(&self) -> bool {
        self.config.noise.is_none()
            && self.config.spreads.is_empty()
            && self.config.receiver.is_none_or(|receiver| receiver.resolution_m == 0.0)
    }

    /// What is measured of a range with a standard normal: by the noise of all ranges, that of such a range, and some more.
    #[inline(always)]
    fn measured(&self, truth: f64, z: f32, more: f64) -> f32 {
        let config = &self.config;
        // Independent ones are one whose variance is the sum.
        let (own, spread) = (f64::from(config.noise.stddev()), Spread::stddev_at(config.spreads, truth));
        let variance = spread * spread + more * more;
        let more = sqrt(own * own + variance) - own;
        let bias = if variance > 0.0 { self.bias + more as f32 * z } else { self.bias };
        let limits = [config.range_min_m, config.range_max_m].map(|limit| limit as f32);
        config.noise.apply_to_range(truth as f32, bias, z, limits)
    }

    /// By how much ranges vary more of what comes back weaker.
    fn spread(&self, echo: &Echo) -> f64 {
        let resolution_m = self.config.receiver.map_or(0.0, |receiver| receiver.resolution_m);
        resolution_m / sqrt(2.0 * echo.weight / self.least)
    }

    /// What counts as a hit.
    fn sight(&self) -> Sight {
        Sight { faces: self.config.faces, range: [0.0, self.config.range_max_m], within: f64::INFINITY }
    }
}

impl Sensor for Scanner<'_> {
    type Output<'a> = Echoes<'a>;

    fn workspace_len(&self, scene: &Scene<'_>, capture: &Capture<'_>) -> usize {
        let (view, piece) =
            (view_lines(scene.instances().len(), 1), Frame::piece_len(scene.has_mirrors_or_panes()));
        match capture.shutter {
            Shutter::Moving(keyframes) if keyframes.len() > 2 => MOST_PIECES * (piece + view),
            _ => MOST_PIECES * piece + view,
        }
    }

    fn sense(
        &self,
        scene: &Scene<'_>,
        capture: &Capture<'_>,
        workspace: &mut Workspace<'_>,
        output: Echoes<'_>,
    ) -> Result<(), SenseError> {
        output.check(self.most_firings(), self.returns())?;
        let frame_time_s = self.config.frame_time_ns as f64 * 1e-9;
        let motions = Motions::of(scene, &capture.shutter, frame_time_s)?;
        let execution = workspace.execution;
        let Cutter(memory) = workspace.cut(self.workspace_len(scene, capture))?;
        let firings = self.in_frame(capture.frame);
        // Whole volleys, so that they do not depend on how pieces are cut.
        let in_piece = firings.count.div_ceil(MOST_PIECES).next_multiple_of(LANES).max(LANES);
        let ScannerConfig { seed, sensor, .. } = self.config;
        let noise = Stream { seed, sensor, frame: capture.frame, channel: Stream::RANGE };
        let mut frame = Frame {
            scanner: self,
            scene,
            execution,
            noise,
            firings,
            motions,
            view: None,
            in_piece,
            has_mirrors: scene.has_mirrors_or_panes(),
        };
        let (echoes, mut none) = output.split_at(firings.count, self.returns());
        none.fill_with_nothing(self.most_firings() - firings.count);
        let view = view_lines(scene.instances().len(), 1);
        let mut stride = Frame::piece_len(frame.has_mirrors);
        let mut memory = memory;
        if motions.count() == 1 {
            let (shared, rest) = memory.split_at_mut(view);
            frame.view = Some(frame.view(0, shared));
            memory = rest;
        } else {
            stride += view;
        }
        let pieces = Pieces { firings: in_piece, returns: self.returns(), stride, memory, echoes };
        for_each_row(execution, 0..firings.count.div_ceil(in_piece), pieces, &|piece, part: Pieces<'_>| {
            dispatch!(execution.level, simd => simd.vectorize(
                #[inline(always)]
                || frame.take_piece(simd, piece, part.memory, part.echoes),
            ));
        });
        Ok(())
    }
}

/// Memory for the views of some pieces, and where their echoes go.
struct Pieces<'a> {
    /// Of each piece but the last.
    firings: usize,
    returns: usize,
    /// Cache lines of a piece's views.
    stride: usize,
    memory: &'a mut [CacheLine],
    echoes: Echoes<'a>,
}

impl SplitRows for Pieces<'_> {
    fn split_rows(self, pieces: usize) -> (Self, Self) {
        let Self { firings, returns, stride, memory, echoes } = self;
        let at = (pieces * stride).min(memory.len());
        let (memory, memory_rest) = memory.split_at_mut(at);
        let (echoes, echoes_rest) = echoes.split_at(pieces * firings, returns);
        (
            Self { firings, returns, stride, memory, echoes },
            Self { firings, returns, stride, memory: memory_rest, echoes: echoes_rest },
        )
    }
}
