//! Lidars that fire beam by beam while they move, as real products do. For a grid of beams as in Gazebo, use
//! [`lidar`](crate::lidar).
//!
//! A [`Scanner`] has a [`Pattern`] of firings, each with its own time and origin, and traces each of them from the
//! poses that the sensor and all instances have at its time ([`Shutter::Moving`]).
//!
//! ```
//! use belvedere_sensors::{glam::DVec3, scanner::*, scene::*, trace::WorkspaceBuf, Capture, Keyframe, Pose, Sensor};
//! let mut world = SceneBuilder::new();
//! world.add_instance(&InstanceConfig {
//!     shape: Shape::Box { size: [0.1, 40.0, 20.0] }, // a wall, whose front is 10 m ahead
//!     world_from_instance: Pose::from_translation(DVec3::X * 10.05),
//!     ..Default::default()
//! })?;
//! // A VLP-16 that drives at 5 m/s towards the wall, during a turn of 0.1 s.
//! let config = presets::VLP_16.config().intensity(Intensity::Reflectivity);
//! let scanner = Scanner::new(config)?;
//! let at = |time_s: f64| Keyframe { time_s, at: world.moment(Pose::from_translation(DVec3::X * 5.0 * time_s)) };
//! let keyframes = [at(0.0), at(0.1)];
//! let mut ranges = vec![0.0; scanner.echoes_len()];
//! let mut intensities = vec![0.0; scanner.echoes_len()];
//! let echoes = Echoes::new().ranges(&mut ranges).intensities(&mut intensities);
//! scanner.sense_in(&mut WorkspaceBuf::default(), &world.scene(), &Capture::new(0, &keyframes), echoes)?;
//! // The laser that looks up by 1°, in the first column and in the last one that it fires in this frame.
//! let ahead = 1_f32.to_radians().cos();
//! let last = scanner.firings(0) - 16 + 1;
//! assert!((ranges[1] * ahead - 10.0).abs() < 0.15 && (ranges[last] * ahead - 9.5).abs() < 0.15);
//! assert!((intensities[1] - 70.0).abs() < 1.0); // per cent: the diffuse grey of the default material
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod beam;
mod clock;
mod config;
mod crosstalk;
mod echoes;
mod firing;
mod frame;
mod intensity;
mod mems;
mod motions;
#[cfg(feature = "alloc")]
mod owned;
mod pattern;
pub mod presets;
mod prisms;
mod raster;
mod returns;
mod rosette;
mod spinning;
mod weather;

use super::Sensor;
use crate::ParameterError;
use crate::execution::{SplitRows, for_each_row};
use crate::memory::{CacheLine, Cutter};
use crate::moment::{Capture, Shutter};
use crate::noise::Stream;
use crate::scene::Scene;
use crate::simd::{LANES, dispatch, sqrt};
use crate::trace::grid::Sight;
use crate::trace::placed::memory::view_lines;
use crate::trace::{SenseError, Workspace};
use beam::BeamRays;
pub use beam::{Beam, Halo, MAX_BEAM_RAYS};
pub use config::{ScannerConfig, Spread};
pub use crosstalk::Crosstalk;
pub use echoes::Echoes;
use fearless_simd::Simd;
pub use firing::Firing;
use frame::ScannerFrame;
pub use intensity::{Intensity, Receiver};
pub use mems::{Mems, MirrorAxis, Wave};
use motions::Motions;
#[cfg(feature = "alloc")]
pub use owned::ScannerBuf;
use pattern::FrameFirings;
pub use pattern::{MAX_FIRINGS, Pattern};
#[cfg(feature = "alloc")]
pub(super) use prisms::WheelsBuf;
pub use prisms::{Axis, Face, MAX_WHEELS, Prisms, Swing, Wheel, Wheels};
pub use raster::Raster;
use returns::Echo;
pub use returns::{MAX_RETURNS, Returns};
pub use rosette::Rosette;
pub use spinning::{Columns, Laser, MAX_LASERS, Spinning};
use weather::Air;
pub use weather::{DropSizes, Weather};

/// The largest number of pieces into which a frame is divided. Results do not depend on it.
const MOST_PIECES: usize = 16;

/// A lidar that fires beam by beam while it moves, as a real product does. Use it for a Velodyne, Ouster, Livox, SICK
/// or Hokuyo, and a [`Lidar`](crate::lidar::Lidar) for Gazebo's grid of beams.
///
/// The configuration is checked when the scanner is created; [`presets`] has the configurations of products.
#[derive(Debug, Clone, Copy)]
pub struct Scanner<'a> {
    config: ScannerConfig<'a>,
    bias: f32,
    bundle: BeamRays,
    air: Air,
    /// The smallest power that the receiver detects.
    least: f64,
    /// Whether beams are single rays with one return, whose power does not matter.
    is_line: bool,
    /// Whether the power of returns must be computed.
    is_lit: bool,
}

impl<'a> Scanner<'a> {
    /// Creates a scanner after checking its configuration.
    ///
    /// # Errors
    /// Returns a [`ParameterError`] that names the first parameter out of range.
    pub fn new(config: ScannerConfig<'a>) -> Result<Self, ParameterError> {
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
            bundle: BeamRays::new(&beam, &halo),
            air: Air::new(&weather, &beam, least),
            least,
            is_line: beam.rays == 1 && returns.count() == 1 && !is_lit,
            is_lit,
            config,
        })
    }

    /// Returns the same scanner with another pattern and other spreads, which must have been checked.
    #[cfg(feature = "alloc")]
    pub(super) fn with_tables<'b>(&self, pattern: Pattern<'b>, spreads: &'b [Spread]) -> Scanner<'b> {
        let Self { config, bias, bundle, air, least, is_line, is_lit } = *self;
        Scanner { config: config.with_tables(pattern, spreads), bias, bundle, air, least, is_line, is_lit }
    }

    /// Returns the configuration that the scanner was created with.
    pub fn config(&self) -> &ScannerConfig<'a> {
        &self.config
    }

    /// Returns the number of returns per firing, which the buffers of an [`Echoes`] must have room for.
    pub fn returns(&self) -> usize {
        self.config.returns.count()
    }

    /// Returns the number of elements of ranges, points and intensities in an [`Echoes`]: those of all returns of
    /// [`Scanner::most_firings`] firings.
    pub fn echoes_len(&self) -> usize {
        self.most_firings() * self.returns()
    }

    /// Returns the largest number of firings that a frame can have, which the buffers of an [`Echoes`] must have room
    /// for.
    pub fn most_firings(&self) -> usize {
        self.config.pattern.most_firings(self.config.frame_time_ns) as usize
    }

    /// Returns the number of firings of a frame.
    pub fn firings(&self, frame: u64) -> usize {
        self.in_frame(frame).count
    }

    /// Returns a firing of a frame, in the order of time. If `index` is too large, this is the last one.
    pub fn firing(&self, frame: u64, index: usize) -> Firing {
        let firings = self.in_frame(frame);
        firings.firing(index.min(firings.count.saturating_sub(1)))
    }

    fn in_frame(&self, frame: u64) -> FrameFirings<'_> {
        self.config.pattern.in_frame(frame, self.config.frame_time_ns)
    }

    /// Returns true if measured ranges equal the true ones.
    #[inline(always)]
    fn is_exact(&self) -> bool {
        self.config.noise.is_none()
            && self.config.spreads.is_empty()
            && self.config.receiver.is_none_or(|receiver| receiver.resolution_m == 0.0)
    }

    /// Returns the measured range for a true one and a standard normal number `z`. The variance of the noise is the sum
    /// of three: the noise of all ranges, the spread at this range, and `more` (a standard deviation in metres).
    #[inline(always)]
    fn measured(&self, truth: f64, z: f32, more: f64) -> f32 {
        let config = &self.config;
        // The variances of independent errors add up.
        let (own, spread) = (f64::from(config.noise.stddev()), Spread::stddev_at(config.spreads, truth));
        let variance = spread * spread + more * more;
        let more = sqrt(own * own + variance) - own;
        let bias = if variance > 0.0 { self.bias + more as f32 * z } else { self.bias };
        let limits = [config.range_min_m, config.range_max_m].map(|limit| limit as f32);
        config.noise.apply_to_range(truth as f32, bias, z, limits)
    }

    /// Returns the standard deviation of a range that results from the power of its return: weaker returns have a
    /// larger one.
    fn spread(&self, echo: &Echo) -> f64 {
        let resolution_m = self.config.receiver.map_or(0.0, |receiver| receiver.resolution_m);
        resolution_m / sqrt(2.0 * echo.weight / self.least)
    }

    /// Returns which hits count.
    fn sight(&self) -> Sight {
        Sight { faces: self.config.faces, range: [0.0, self.config.range_max_m], within: f64::INFINITY }
    }
}

impl Sensor for Scanner<'_> {
    type Output<'a> = Echoes<'a>;

    fn workspace_len(&self, scene: &Scene<'_>, capture: &Capture<'_>) -> usize {
        let (view, piece) =
            (view_lines(scene.instances().len(), 1), ScannerFrame::piece_len(scene.has_mirrors_or_panes()));
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
        // Whole volleys of 64 firings, so that volleys do not depend on how pieces are divided.
        let in_piece = firings.count.div_ceil(MOST_PIECES).next_multiple_of(LANES).max(LANES);
        let ScannerConfig { seed, sensor, .. } = self.config;
        let noise = Stream { seed, sensor, frame: capture.frame, channel: Stream::RANGE };
        let mut frame = ScannerFrame {
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
        let mut stride = ScannerFrame::piece_len(frame.has_mirrors);
        let mut memory = memory;
        if motions.count() == 1 {
            let (shared, rest) = memory.split_at_mut(view);
            frame.view = Some(frame.view(0, shared));
            memory = rest;
        } else {
            stride += view;
        }
        let pieces = FramePieces { firings: in_piece, returns: self.returns(), stride, memory, echoes };
        for_each_row(
            execution,
            0..firings.count.div_ceil(in_piece),
            pieces,
            &|piece, part: FramePieces<'_>| {
                dispatch!(execution.level, simd => simd.vectorize(
                    #[inline(always)]
                    || frame.take_piece(simd, piece, part.memory, part.echoes),
                ));
            },
        );
        Ok(())
    }
}

/// The memory for the views of some pieces, and the outputs of their echoes.
struct FramePieces<'a> {
    /// The number of firings of each piece but the last.
    firings: usize,
    returns: usize,
    /// The number of cache lines of a piece's views.
    stride: usize,
    memory: &'a mut [CacheLine],
    echoes: Echoes<'a>,
}

impl SplitRows for FramePieces<'_> {
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
