//! Laser scanners as they are built: each firing at a time and from a place of its own.
//!
//! A [`Lidar`](crate::lidar::Lidar) is Gazebo's: an even grid of beams from one point. A [`Scanner`] has a
//! [`Pattern`] of firings, and traces each from where the sensor and everything else is at its time
//! ([`Shutter::Moving`]).

mod clock;
mod config;
mod error;
mod firing;
mod pattern;
pub mod presets;
mod rosette;
mod spinning;

use super::Sensor;
use crate::Pose;
use crate::execution::{Execution, SplitRows, for_each_row, split_at};
use crate::memory::{CacheLine, Cutter};
use crate::moment::{Capture, Keyframe, Moment, Shutter};
use crate::noise::{Stream, fill_standard_normal};
use crate::scene::Scene;
use crate::simd::{LANES, dispatch};
use crate::trace::error::check_output;
use crate::trace::grid::Sight;
use crate::trace::memory::view_lines;
use crate::trace::resolve::Resolver;
use crate::trace::truth::OfRay;
use crate::trace::view::{View, check_moment};
use crate::trace::volley::{Struck, Volley};
use crate::trace::{SenseError, Truth, Workspace};
pub use config::{ScannerConfig, Spread};
use core::ops::Range;
pub use error::ScannerError;
use fearless_simd::Simd;
pub use firing::Firing;
use firing::FiringLanes;
use glam::DVec3;
use pattern::FrameFirings;
pub use pattern::{MAX_FIRINGS, Pattern};
pub use rosette::Rosette;
pub use spinning::{Columns, Laser, MAX_LASERS, Spinning};

/// Pieces that a frame is dealt out in, at the most. Nothing else depends on it.
const MOST_PIECES: usize = 16;

/// The farthest that the last motion goes on behind its end, as a share of it.
const MOST_SHARE: f64 = 2.0;

/// A checked scanner.
#[derive(Debug, Clone, Copy)]
pub struct Scanner<'a> {
    config: ScannerConfig<'a>,
    bias: f32,
}

impl<'a> Scanner<'a> {
    /// Checks the configuration.
    ///
    /// # Errors
    /// Names the first parameter that is out of its range.
    pub fn new(config: ScannerConfig<'a>) -> Result<Self, ScannerError> {
        config.check()?;
        Ok(Self { config, bias: config.noise.bias(config.seed, config.sensor, 0) })
    }

    /// What it was made from.
    pub fn config(&self) -> &ScannerConfig<'a> {
        &self.config
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

    /// What counts as a hit.
    fn sight(&self) -> Sight {
        Sight { faces: self.config.faces, range: [0.0, self.config.range_max_m], within: f64::INFINITY }
    }
}

/// Where the parts of a frame go: as many of each as [`Scanner::most_firings`] says, in the order of the firings. Those
/// that a frame does not have are NaN.
#[derive(Debug, Default)]
#[non_exhaustive]
pub struct Echoes<'a> {
    /// Measured metres from where the firing started; +∞ where nothing is in range, −∞ where something is too near (REP-117).
    pub ranges: Option<&'a mut [f32]>,
    /// Where that is in the frame of the sensor, as that was at the time of the firing, in metres; NaN where there is no
    /// range.
    pub points: Option<&'a mut [[f32; 3]]>,
    /// What the surface is said to send back; 0 where there is no range.
    pub intensities: Option<&'a mut [f32]>,
    /// Seconds after the beginning of the frame.
    pub times: Option<&'a mut [f64]>,
    /// Which laser fires, from 0; `u32::MAX` for firings that a frame does not have.
    pub lasers: Option<&'a mut [u32]>,
    /// What is true of each firing. Flow is not worked out.
    pub truth: Option<Truth<'a>>,
}

impl<'a> Echoes<'a> {
    outputs! {
        /// Sets where ranges go.
        ranges: &'a mut [f32],
        /// Sets where points go.
        points: &'a mut [[f32; 3]],
        /// Sets where intensities go.
        intensities: &'a mut [f32],
        /// Sets where times go.
        times: &'a mut [f64],
        /// Sets where the lasers' numbers go.
        lasers: &'a mut [u32],
        /// Sets where truth goes.
        truth: Truth<'a>,
    }
}

impl Echoes<'_> {
    /// The parts of the first firings, and of the rest.
    fn split_at(self, firings: usize) -> (Self, Self) {
        let (ranges, ranges_rest) = split_at(self.ranges, firings);
        let (points, points_rest) = split_at(self.points, firings);
        let (intensities, intensities_rest) = split_at(self.intensities, firings);
        let (times, times_rest) = split_at(self.times, firings);
        let (lasers, lasers_rest) = split_at(self.lasers, firings);
        let (truth, truth_rest) = self.truth.map(|truth| truth.split_at(firings)).unzip();
        (
            Self { ranges, points, intensities, times, lasers, truth },
            Self {
                ranges: ranges_rest,
                points: points_rest,
                intensities: intensities_rest,
                times: times_rest,
                lasers: lasers_rest,
                truth: truth_rest,
            },
        )
    }

    fn check(&self, firings: usize) -> Result<(), SenseError> {
        check_output("ranges", self.ranges.as_ref().map(|ranges| ranges.len()), firings)?;
        check_output("points", self.points.as_ref().map(|points| points.len()), firings)?;
        check_output("intensities", self.intensities.as_ref().map(|values| values.len()), firings)?;
        check_output("times", self.times.as_ref().map(|times| times.len()), firings)?;
        check_output("lasers", self.lasers.as_ref().map(|lasers| lasers.len()), firings)?;
        let Some(truth) = &self.truth else { return Ok(()) };
        if truth.flow.is_some() || truth.flow_back.is_some() {
            return Err(SenseError::FlowOfFirings);
        }
        truth.check_len(firings)
    }

    /// Those of firings that there are not.
    fn fill_with_nothing(&mut self, firings: usize) {
        if let Some(ranges) = &mut self.ranges {
            ranges.fill(f32::NAN);
        }
        if let Some(points) = &mut self.points {
            points.fill([f32::NAN; 3]);
        }
        if let Some(intensities) = &mut self.intensities {
            intensities.fill(f32::NAN);
        }
        if let Some(times) = &mut self.times {
            times.fill(f64::NAN);
        }
        if let Some(lasers) = &mut self.lasers {
            lasers.fill(u32::MAX);
        }
        if let Some(truth) = &mut self.truth {
            (0..firings).for_each(|firing| truth.put(firing, &OfRay::NOTHING));
        }
    }
}

/// The motions of a frame: from each keyframe to the next, or none at a single moment.
#[derive(Clone, Copy)]
enum Motions<'a> {
    Still(Moment<'a>),
    Between(&'a [Keyframe<'a>]),
}

impl<'a> Motions<'a> {
    fn of(scene: &Scene<'_>, shutter: &Shutter<'a>, frame_time_s: f64) -> Result<Self, SenseError> {
        match *shutter {
            Shutter::Global(moment) => check_moment(scene, &moment).map(|()| Self::Still(moment)),
            Shutter::Slices(_) => Err(SenseError::Shutter {
                rule: "be one moment or keyframes: this sensor's rays have times of their own",
            }),
            Shutter::Moving(keyframes) => {
                check_keyframes(scene, keyframes, frame_time_s)?;
                Ok(Self::Between(keyframes))
            }
        }
    }

    fn count(&self) -> usize {
        match self {
            Self::Still(_) => 1,
            Self::Between(keyframes) => keyframes.len() - 1,
        }
    }
}

/// That there is motion from the beginning of a frame to its end.
fn check_keyframes(scene: &Scene<'_>, keyframes: &[Keyframe<'_>], end_s: f64) -> Result<(), SenseError> {
    let wrong = |keyframe, rule| Err(SenseError::Keyframes { keyframe, rule });
    if keyframes.len() < 2 {
        return wrong(keyframes.len(), "be there: motion is between two at least");
    }
    for (index, keyframe) in keyframes.iter().enumerate() {
        if !keyframe.time_s.is_finite() {
            return wrong(index, "have a time that is finite");
        }
        if index > 0 && keyframe.time_s <= keyframes[index - 1].time_s {
            return wrong(index, "be later than that before it");
        }
        check_moment(scene, &keyframe.at)?;
    }
    if keyframes[0].time_s > 0.0 {
        return wrong(0, "be at the beginning of the frame, 0 s, or before");
    }
    // Of a whole number of nanoseconds, a simulator may know its time to less.
    if keyframes[keyframes.len() - 1].time_s < end_s - 1e-9 {
        return wrong(keyframes.len() - 1, "be at the end of the frame or after");
    }
    Ok(())
}

/// A frame that is being taken.
struct Frame<'a> {
    scanner: &'a Scanner<'a>,
    scene: &'a Scene<'a>,
    execution: Execution,
    /// Where its noise comes from.
    noise: Stream,
    firings: FrameFirings<'a>,
    motions: Motions<'a>,
    /// What all firings see, if there is but one motion.
    view: Option<View<'a>>,
    /// Firings of a piece; the last may have fewer.
    in_piece: usize,
    pieces: usize,
    /// Cache lines of a piece's views.
    stride: usize,
}

impl<'a> Frame<'a> {
    /// The motion that a firing is in.
    fn motion_of(&self, firing: usize) -> usize {
        let Motions::Between(keyframes) = self.motions else { return 0 };
        let time_s = self.firings.time_s(firing);
        let begun = keyframes.partition_point(|keyframe| keyframe.time_s <= time_s);
        // Before the first and after the last, those go on.
        begun.saturating_sub(1).min(keyframes.len() - 2)
    }

    /// The first of some firings that is not in a motion, or the end of them.
    fn end_of(&self, motion: usize, firings: Range<usize>) -> usize {
        match self.motions {
            Motions::Between(keyframes) if motion + 2 < keyframes.len() => {
                let next_s = keyframes[motion + 1].time_s;
                firings.start
                    + partition(firings.len(), |index| self.firings.time_s(firings.start + index) < next_s)
            }
            _ => firings.end,
        }
    }

    /// What is seen during a motion.
    fn view<'m>(&self, motion: usize, memory: &'m mut [CacheLine]) -> View<'m>
    where
        'a: 'm,
    {
        let mut memory = Cutter(memory);
        let views = memory.views(self.scene.instances().len(), 1);
        let visibility = self.scanner.config.visibility;
        match self.motions {
            Motions::Still(moment) => View::new(self.scene, &moment, visibility, views),
            Motions::Between(keyframes) => {
                let [from, to] = [&keyframes[motion], &keyframes[motion + 1]];
                let last = self.firings.count.saturating_sub(1);
                let until = share(from, to, self.firings.time_s(last)).max(1.0);
                let until = if motion + 2 == keyframes.len() { until } else { 1.0 };
                View::until(self.scene, (&from.at, Some((to.at, until))), visibility, views)
            }
        }
    }

    /// Takes the firings of a piece.
    #[inline(always)]
    fn take_piece<S: Simd>(&self, simd: S, piece: usize, memory: &mut [CacheLine], mut echoes: Echoes<'_>) {
        let end = ((piece + 1) * self.in_piece).min(self.firings.count);
        let mut next = (piece * self.in_piece).min(end);
        let (mut lanes, mut volley) = (FiringLanes::new(), Volley::new());
        while next < end {
            let motion = self.motion_of(next);
            let until = self.end_of(motion, next..end);
            let own;
            let view = if let Some(view) = &self.view {
                view
            } else {
                own = self.view(motion, memory);
                &own
            };
            let mut resolver = Resolver::new(view);
            while next < until {
                let count = LANES.min(until - next);
                let (part, rest) = echoes.split_at(count);
                echoes = rest;
                self.take(simd, (view, &mut resolver), motion, next, count, (&mut lanes, &mut volley), part);
                next += count;
            }
        }
    }

    /// Takes up to 64 firings.
    #[allow(clippy::too_many_arguments, reason = "what a volley is made of")]
    #[inline(always)]
    fn take<S: Simd>(
        &self,
        simd: S,
        (view, resolver): (&View<'_>, &mut Resolver<'_>),
        motion: usize,
        first: usize,
        count: usize,
        (lanes, volley): (&mut FiringLanes, &mut Volley),
        mut echoes: Echoes<'_>,
    ) {
        let sight = self.scanner.sight();
        self.firings.fill(first, count, lanes);
        volley.clear();
        for lane in 0..count {
            let firing = lanes.lane(lane);
            let (pose, share) = self.pose(motion, firing.time_s);
            let turn = pose.rotation();
            let origin = (pose.translation() - view.origin_in_world) + turn * firing.origin;
            volley.set(lane, origin, turn * firing.direction, share, sight.range[1]);
        }
        volley.cast(simd, view, &sight);
        let mut normals = [0.0; LANES];
        let Scanner { config, bias } = self.scanner;
        let is_exact = config.noise.is_none() && config.spreads.is_empty();
        if !is_exact {
            fill_standard_normal(self.execution.level, &self.noise, first as u32, &mut normals[..count]);
        }
        let limits = [config.range_min_m, config.range_max_m].map(|limit| limit as f32);
        for lane in 0..count {
            let firing = lanes.lane(lane);
            let met = volley.range(lane);
            let truth = met.unwrap_or(f64::INFINITY);
            // Two independent ones are one whose variance is the sum.
            let (own, z) = (f64::from(config.noise.stddev()), normals[lane]);
            let spread = Spread::stddev_at(config.spreads, truth);
            let more = crate::simd::sqrt(own * own + spread * spread) - own;
            let bias = if spread > 0.0 { bias + more as f32 * z } else { *bias };
            let range = config.noise.apply_to_range(truth as f32, bias, z, limits);
            let is_measured = range.is_finite();
            if let Some(ranges) = &mut echoes.ranges {
                ranges[lane] = range;
            }
            if let Some(points) = &mut echoes.points {
                // Without noise to more than a range in f32 says.
                let range = if is_exact { truth } else { f64::from(range) };
                let point = if is_measured { firing.origin + firing.direction * range } else { DVec3::NAN };
                points[lane] = point.as_vec3().to_array();
            }
            if let Some(intensities) = &mut echoes.intensities {
                let intensity = volley.slot(lane).filter(|_| is_measured);
                intensities[lane] = intensity.map_or(0.0, |slot| resolver.laser_retro(slot));
            }
            if let Some(times) = &mut echoes.times {
                times[lane] = firing.time_s;
            }
            if let Some(lasers) = &mut echoes.lasers {
                lasers[lane] = firing.laser;
            }
            if let Some(truth) = &mut echoes.truth {
                let met = volley.struck(view, resolver, lane);
                truth.put(lane, &met.map_or(OfRay::NOTHING, |met| self.truth_of(&firing, &met)));
            }
        }
    }

    fn truth_of(&self, firing: &Firing, met: &Struck) -> OfRay {
        OfRay {
            depth: (firing.origin + firing.direction * met.range).x as f32,
            range: met.range as f32,
            normal: met.normal.as_vec3().to_array(),
            instance: met.instance,
            class: self.scene.instances()[met.instance as usize].class,
            incidence: libm::acos(met.cos_incidence.clamp(-1.0, 1.0)) as f32,
        }
    }

    /// Where the sensor is at a time, and what share of the motion is over then.
    fn pose(&self, motion: usize, time_s: f64) -> (Pose, f64) {
        match self.motions {
            Motions::Still(moment) => (moment.world_from_sensor, 0.0),
            Motions::Between(keyframes) => {
                let [from, to] = [&keyframes[motion], &keyframes[motion + 1]];
                let share = share(from, to, time_s);
                (from.at.world_from_sensor.interpolate(&to.at.world_from_sensor, share), share)
            }
        }
    }
}

/// The share of the way between two keyframes that is over at a time.
fn share(from: &Keyframe<'_>, to: &Keyframe<'_>, time_s: f64) -> f64 {
    ((time_s - from.time_s) / (to.time_s - from.time_s)).clamp(0.0, MOST_SHARE)
}

/// How many of the first indices a condition holds for.
fn partition(count: usize, holds: impl Fn(usize) -> bool) -> usize {
    let (mut low, mut high) = (0, count);
    while low < high {
        let middle = low + (high - low) / 2;
        if holds(middle) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    low
}

impl Sensor for Scanner<'_> {
    type Output<'a> = Echoes<'a>;

    fn workspace_len(&self, scene: &Scene<'_>, capture: &Capture<'_>) -> usize {
        let views = match capture.shutter {
            Shutter::Moving(keyframes) if keyframes.len() > 2 => MOST_PIECES,
            _ => 1,
        };
        views * view_lines(scene.instances().len(), 1)
    }

    fn sense(
        &self,
        scene: &Scene<'_>,
        capture: &Capture<'_>,
        workspace: &mut Workspace<'_>,
        output: Echoes<'_>,
    ) -> Result<(), SenseError> {
        output.check(self.most_firings())?;
        let frame_time_s = self.config.frame_time_ns as f64 * 1e-9;
        let motions = Motions::of(scene, &capture.shutter, frame_time_s)?;
        let execution = workspace.execution;
        let Cutter(memory) = workspace.cut(self.workspace_len(scene, capture))?;
        let firings = self.in_frame(capture.frame);
        // Whole volleys, so that they do not depend on how pieces are cut.
        let in_piece = firings.count.div_ceil(MOST_PIECES).next_multiple_of(LANES).max(LANES);
        let mut frame = Frame {
            scanner: self,
            scene,
            execution,
            noise: Stream {
                seed: self.config.seed,
                sensor: self.config.sensor,
                frame: capture.frame,
                channel: Stream::RANGE,
            },
            firings,
            motions,
            view: None,
            in_piece,
            pieces: firings.count.div_ceil(in_piece),
            stride: view_lines(scene.instances().len(), 1),
        };
        let (echoes, mut none) = output.split_at(firings.count);
        none.fill_with_nothing(self.most_firings() - firings.count);
        let (shared, memory) =
            if motions.count() == 1 { (memory, &mut [][..]) } else { (&mut [][..], memory) };
        if motions.count() == 1 {
            frame.view = Some(frame.view(0, shared));
        }
        let pieces = Pieces { in_piece, stride: frame.stride, memory, echoes };
        for_each_row(execution, 0..frame.pieces, pieces, &|piece, part: Pieces<'_>| {
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
    in_piece: usize,
    stride: usize,
    memory: &'a mut [CacheLine],
    echoes: Echoes<'a>,
}

impl SplitRows for Pieces<'_> {
    fn split_rows(self, pieces: usize) -> (Self, Self) {
        let Self { in_piece, stride, memory, echoes } = self;
        let at = (pieces * stride).min(memory.len());
        let (memory, memory_rest) = memory.split_at_mut(at);
        let (echoes, echoes_rest) = echoes.split_at(pieces * in_piece);
        (
            Self { in_piece, stride, memory, echoes },
            Self { in_piece, stride, memory: memory_rest, echoes: echoes_rest },
        )
    }
}
