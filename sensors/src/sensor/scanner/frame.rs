//! Taking a frame of a scanner: firing by firing, 64 rays at a time.

use super::Scanner;
use super::ScannerConfig;
use super::beam::{BeamRays, MOST_RAYS};
use super::echoes::Echoes;
use super::firing::{Firing, FiringLanes};
use super::intensity::reflected;
use super::motions::Motions;
use super::pattern::FrameFirings;
use super::returns::{Echo, Echoing, MAX_RETURNS};
use super::weather::{MOST_IN_AIR, Weather};
use crate::execution::Execution;
use crate::memory::{CacheLine, Cutter, lines};
use crate::noise::{Stream, fill_standard_normal};
use crate::scene::Scene;
use crate::simd::LANES;
use crate::trace::hit::resolve::Resolver;
use crate::trace::packet::moving::{MovingHit, MovingPacket, Ways};
use crate::trace::packet::paths::{Behind, Found, Paths, SURFACES_BEYOND};
use crate::trace::packet::scratch::MovingScratch;
use crate::trace::packet::specular::{Beyond, Shares};
use crate::trace::placed::view::View;
use crate::trace::truth::OfRay;
use core::ops::Range;
use fearless_simd::Simd;
use glam::DVec3;

/// A frame that is being taken.
pub(super) struct ScannerFrame<'a> {
    pub(super) scanner: &'a Scanner<'a>,
    pub(super) scene: &'a Scene<'a>,
    pub(super) execution: Execution,
    /// The random number stream of range noise.
    pub(super) noise: Stream,
    pub(super) firings: FrameFirings<'a>,
    pub(super) motions: Motions<'a>,
    /// The view of all firings, if there is only one motion.
    pub(super) view: Option<View<'a>>,
    /// The number of firings of a piece; the last may have fewer.
    pub(super) in_piece: usize,
    /// Whether the scene has mirrors or panes.
    pub(super) has_mirrors: bool,
}

/// The working memory for up to 64 firings.
struct VolleyScratch<'m> {
    lanes: FiringLanes,
    volley: MovingPacket,
    ways: Ways<'m>,
    /// A standard normal for each return.
    normals: [f32; LANES * MAX_RETURNS],
    /// The echoes of one firing.
    echoing: Echoing<MOST_ECHOES>,
    /// The hits seen by specular reflection and transmission; empty if the scene has no mirrors or panes.
    found: &'m mut [Found<LANES>],
    /// The paths of the rays that are followed beyond mirrors and panes.
    paths: &'m mut [Paths<LANES>],
}

/// The largest number of echoes of a firing: for each ray its hit and the hits beyond mirrors and panes, then those of
/// the air and one pulse of another lidar.
const MOST_ECHOES: usize = MOST_RAYS * (1 + SURFACES_BEYOND) + MOST_IN_AIR + 1;

impl<'m> VolleyScratch<'m> {
    #[inline(always)]
    fn new(
        room: &'m mut MovingScratch,
        found: &'m mut [Found<LANES>],
        paths: &'m mut [Paths<LANES>],
    ) -> Self {
        Self {
            lanes: const { FiringLanes::new() },
            volley: const { MovingPacket::new() },
            ways: Ways::new(room),
            normals: [0.0; LANES * MAX_RETURNS],
            echoing: const { Echoing::new() },
            found,
            paths,
        }
    }
}

/// The data from which the returns of beams are computed: firings, hits of their rays, normal numbers, and memory for
/// echoes.
type BeamBench<'b> =
    (&'b FiringLanes, &'b MovingPacket, &'b [f32; LANES * MAX_RETURNS], &'b mut Echoing<MOST_ECHOES>);

impl<'a> ScannerFrame<'a> {
    /// Returns the first of some firings that does not belong to a motion, or the end of the firings.
    fn end_of(&self, motion: usize, firings: Range<usize>) -> usize {
        match self.motions.next_s(motion) {
            Some(next_s) => {
                firings.start
                    + partition(firings.len(), |index| self.firings.time_s(firings.start + index) < next_s)
            }
            None => firings.end,
        }
    }

    /// Returns the number of cache lines that a piece needs in addition to its views.
    pub(super) fn piece_len(has_mirrors: bool) -> usize {
        let beyond = lines(size_of::<Found<LANES>>()) + lines(size_of::<Paths<LANES>>());
        lines(size_of::<MovingScratch>()) + if has_mirrors { beyond } else { 0 }
    }

    /// Returns the view of a motion.
    pub(super) fn view<'m>(&self, motion: usize, memory: &'m mut [CacheLine]) -> View<'m>
    where
        'a: 'm,
    {
        let memory = Cutter(memory).views(self.scene.instances().len(), 1);
        let last_s = self.firings.time_s(self.firings.count.saturating_sub(1));
        self.motions.view(self.scene, (motion, last_s), self.scanner.config.visibility, memory)
    }

    /// Takes the firings of a piece.
    #[inline(always)]
    pub(super) fn take_piece<S: Simd>(
        &self,
        simd: S,
        piece: usize,
        memory: &mut [CacheLine],
        mut echoes: Echoes<'_>,
    ) {
        let end = ((piece + 1) * self.in_piece).min(self.firings.count);
        let mut next = (piece * self.in_piece).min(end);
        let mut memory = Cutter(memory);
        let Some(room) = memory.take(1).first_mut() else { return };
        let glazed = usize::from(self.has_mirrors);
        let mut scratch = VolleyScratch::new(room, memory.take(glazed), memory.take(glazed));
        let Cutter(memory) = memory;
        let returns = self.scanner.returns();
        while next < end {
            let motion = self.motions.at(self.firings.time_s(next));
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
                let (part, rest) = echoes.split_at(count, returns);
                echoes = rest;
                self.take(simd, (view, &mut resolver), motion, next..next + count, &mut scratch, part);
                next += count;
            }
        }
    }

    /// Takes up to 64 firings.
    #[inline(always)]
    fn take<S: Simd>(
        &self,
        simd: S,
        (view, resolver): (&View<'_>, &mut Resolver<'_>),
        motion: usize,
        firings: Range<usize>,
        scratch: &mut VolleyScratch<'_>,
        mut echoes: Echoes<'_>,
    ) {
        let sight = self.scanner.sight();
        let (first, count, returns) = (firings.start, firings.len(), self.scanner.returns());
        self.firings.fill(first, count, &mut scratch.lanes);
        if !self.scanner.is_exact() {
            let normals = &mut scratch.normals[..count * returns];
            fill_standard_normal(self.execution.level, &self.noise, (first * returns) as u32, normals);
        }
        // As many firings as the 64 rays of a volley suffice for.
        let (mut lane, most) = (0, LANES / self.scanner.bundle.rays);
        while lane < count {
            let lanes = lane..count.min(lane + most);
            self.aim(view, motion, lanes.clone(), scratch);
            scratch.volley.cast(simd, view, &sight, &mut scratch.ways);
            let tools = (&scratch.lanes, &scratch.volley, &scratch.normals, &mut scratch.echoing);
            if let (Some(paths), Some(found)) = (scratch.paths.first_mut(), scratch.found.first_mut()) {
                let tools = (tools, &mut scratch.ways, Beyond::new(paths, found));
                self.measure_mirrored(simd, (view, resolver), first, lanes.clone(), tools, &mut echoes);
            } else if self.scanner.is_line {
                self.measure_lines(resolver, lanes.clone(), scratch, &mut echoes);
            } else {
                self.measure_beams((view, resolver), first, lanes.clone(), tools, &[], &mut echoes);
            }
            if let Some(truth) = &mut echoes.truth {
                for (lane, ray) in lanes.clone().zip((0..LANES).step_by(self.scanner.bundle.rays)) {
                    let met = scratch.volley.struck(view, resolver, ray);
                    let firing = scratch.lanes.lane(lane);
                    truth.put(lane, &met.map_or(OfRay::NOTHING, |met| self.truth_of(&firing, &met)));
                }
            }
            lane = lanes.end;
        }
        for lane in 0..count {
            echoes.put_firing(lane, &scratch.lanes.lane(lane));
        }
    }

    /// Sets up the rays of some firings; those of a firing are adjacent.
    #[inline(always)]
    fn aim(&self, view: &View<'_>, motion: usize, firings: Range<usize>, scratch: &mut VolleyScratch<'_>) {
        let VolleyScratch { lanes, volley, .. } = scratch;
        let (bundle, farthest) = (&self.scanner.bundle, self.scanner.config.range_max_m);
        volley.clear();
        for (number, lane) in firings.enumerate() {
            let firing = lanes.lane(lane);
            let (pose, share) = self.motions.pose(motion, firing.time_s);
            let turn = pose.rotation();
            let origin = (pose.translation() - view.origin_in_world) + turn * firing.origin;
            let ahead = turn * firing.direction;
            if bundle.rays == 1 {
                volley.set(number, origin, ahead, share, farthest);
                continue;
            }
            let axes = BeamRays::axes(&firing).map(|axis| turn * axis);
            for ray in 0..bundle.rays {
                let [origin, direction] = bundle.ray(ray, origin, ahead, axes);
                volley.set(number * bundle.rays + ray, origin, direction, share, farthest);
            }
        }
    }

    /// Measures single rays whose power does not matter.
    #[inline(always)]
    fn measure_lines(
        &self,
        resolver: &mut Resolver<'_>,
        firings: Range<usize>,
        scratch: &VolleyScratch<'_>,
        echoes: &mut Echoes<'_>,
    ) {
        let (volley, wants_intensities) = (&scratch.volley, echoes.intensities.is_some());
        for lane in firings {
            let met = volley.range(lane).unwrap_or(f64::INFINITY);
            let range = self.scanner.measured(met, scratch.normals[lane], 0.0);
            let slot = volley.slot(lane).filter(|_| wants_intensities && range.is_finite());
            let intensity = slot.map_or(0.0, |slot| resolver.laser_retro(slot));
            echoes.put(lane, range, self.point(&scratch.lanes.lane(lane), met, range), intensity);
        }
    }

    /// Measures beams in a scene with mirrors or panes. This is a separate function because following rays beyond them
    /// takes 200 KB of stack.
    #[inline(never)]
    fn measure_mirrored<S: Simd>(
        &self,
        simd: S,
        (view, resolver): (&View<'_>, &mut Resolver<'_>),
        first: usize,
        firings: Range<usize>,
        (scratch, ways, mut beyond): (BeamBench<'_>, &mut Ways<'_>, Beyond<'_, LANES>),
        echoes: &mut Echoes<'_>,
    ) {
        let mut volley = const { MovingPacket::new() };
        beyond.set_out((view, resolver), scratch.1);
        let behind = beyond.look(simd, (view, resolver), &self.scanner.sight(), (&mut volley, ways));
        self.measure_beams((view, resolver), first, firings, scratch, behind, echoes);
    }

    /// Computes the returns of beams.
    fn measure_beams(
        &self,
        (view, resolver): (&View<'_>, &mut Resolver<'_>),
        first: usize,
        firings: Range<usize>,
        (lanes, volley, normals, echoing): BeamBench<'_>,
        behind: &[Behind],
        echoes: &mut Echoes<'_>,
    ) {
        let Scanner { config, bundle, least, .. } = self.scanner;
        let returns = self.scanner.returns();
        for (number, lane) in firings.enumerate() {
            let rays = number * bundle.rays..(number + 1) * bundle.rays;
            echoing.clear();
            self.listen((view, resolver), volley, rays.clone(), echoing);
            self.listen_beyond(resolver, behind, &rays, echoing);
            self.listen_to_air(volley, (first + lane) as u32, rays.start..rays.start + bundle.own, echoing);
            self.listen_to_others((first + lane) as u32, echoing);
            let firing = lanes.lane(lane);
            let found = echoing.returns(config.returns, config.pulse_m, *least);
            for (place, echo) in found[..returns].iter().enumerate() {
                let index = lane * returns + place;
                let met = echo.map_or(f64::INFINITY, |echo| echo.range);
                let spread = echo.map_or(0.0, |echo| self.scanner.spread(&echo));
                let range = self.scanner.measured(met, normals[index], spread);
                let intensity = echo.filter(|_| range.is_finite());
                let intensity = intensity.map_or(0.0, |echo| config.intensity.of(&echo));
                echoes.put(index, range, self.point(&firing, met, range), intensity);
            }
        }
    }

    /// Adds the echoes of surfaces that the rays of one firing hit directly.
    fn listen(
        &self,
        (view, resolver): (&View<'_>, &mut Resolver<'_>),
        volley: &MovingPacket,
        rays: Range<usize>,
        echoing: &mut Echoing<MOST_ECHOES>,
    ) {
        let Scanner { config, bundle, air, is_lit, .. } = self.scanner;
        let first = rays.start;
        for ray in rays {
            let (Some(range), Some(slot)) = (volley.range(ray), volley.slot(ray)) else { continue };
            let met = if *is_lit { volley.struck(view, resolver, ray) } else { None };
            let mut share = bundle.share(ray - first);
            if self.has_mirrors {
                share *= Shares::of(view, resolver.hit(slot).instance.instance).scattered();
            }
            let weight = met.map_or(share, |met| {
                let reflected = reflected(self.scene, met.instance, met.cos_incidence);
                share * reflected * air.clearness(range) / (range * range)
            });
            let signal = config.intensity.signal(range, weight, resolver.laser_retro(slot));
            echoing.push(Echo { range, weight, signal });
        }
    }

    /// Adds the echoes of surfaces that one firing hits through panes and in mirrors.
    fn listen_beyond(
        &self,
        resolver: &mut Resolver<'_>,
        behind: &[Behind],
        rays: &Range<usize>,
        echoing: &mut Echoing<MOST_ECHOES>,
    ) {
        let Scanner { config, bundle, air, is_lit, .. } = self.scanner;
        for met in behind.iter().filter(|met| rays.contains(&met.lane())) {
            let Behind { range, light, .. } = *met;
            let mut weight = light * bundle.share(met.lane() - rays.start);
            if *is_lit {
                let reflected = reflected(self.scene, met.instance, met.cos_incidence());
                weight *= reflected * air.clearness(range) / (range * range);
            }
            let signal = config.intensity.signal(range, weight, resolver.laser_retro(met.slot));
            echoing.push(Echo { range, weight, signal });
        }
    }

    /// Adds the pulse of another lidar that one firing receives, if any.
    fn listen_to_others(&self, firing: u32, echoing: &mut Echoing<MOST_ECHOES>) {
        let ScannerConfig { crosstalk, intensity, range_max_m, .. } = self.scanner.config;
        if let Some(range) = crosstalk.heard(&self.noise, firing, range_max_m) {
            let weight = 1.0 / (range * range);
            echoing.push(Echo { range, weight, signal: intensity.signal(range, weight, 0.0) });
        }
    }

    /// Adds the echoes of the air (fog, rain and snow) to one firing.
    fn listen_to_air(
        &self,
        volley: &MovingPacket,
        firing: u32,
        rays: Range<usize>,
        echoing: &mut Echoing<MOST_ECHOES>,
    ) {
        let Scanner { config, air, .. } = self.scanner;
        if config.weather == Weather::CLEAR {
            return;
        }
        let ranges = rays.map(|ray| volley.range(ray).unwrap_or(config.range_max_m));
        let passing = |range| ranges.clone().filter(|met| *met > range).count() as f64 / ranges.len() as f64;
        let farthest = ranges.clone().fold(0.0, f64::max);
        let mut push = |[range, weight]: [f64; 2]| {
            let signal = config.intensity.signal(range, weight, 0.0);
            echoing.push(Echo { range, weight, signal });
        };
        if let Some(fog) = air.fog(passing) {
            push(fog);
        }
        let within = [config.range_min_m, farthest];
        air.for_each_drop(self.execution.level, &self.noise, firing, within, push);
    }

    /// Returns the measured point in the frame of the sensor. Without noise it is more accurate than the `f32` range.
    #[inline(always)]
    fn point(&self, firing: &Firing, met: f64, range: f32) -> DVec3 {
        if !range.is_finite() {
            return DVec3::NAN;
        }
        firing.origin + firing.direction * if self.scanner.is_exact() { met } else { f64::from(range) }
    }

    fn truth_of(&self, firing: &Firing, met: &MovingHit) -> OfRay {
        OfRay {
            depth: (firing.origin + firing.direction * met.range).x as f32,
            range: met.range as f32,
            normal: met.normal.as_vec3().to_array(),
            instance: met.instance,
            class: self.scene.instances()[met.instance as usize].class,
            incidence: libm::acos(met.cos_incidence.clamp(-1.0, 1.0)) as f32,
        }
    }
}

/// Returns for how many of the first indices a condition holds.
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
