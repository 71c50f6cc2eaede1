//! Clouds, as the drivers of scanners send them.

mod livox;
mod ouster;
mod velodyne;

use super::head::Head;
use crate::description::model::CloudLayout;
use crate::rig::outlet::Outlet;
use crate::rig::sink::Frame;
use belvedere_bridge::Encoding;
use belvedere_sensors::scanner::Intensity;
use belvedere_sensors::scanner::presets::Maker;

/// What a frame has found: times and lasers one a firing, of the others as many as there are returns.
#[derive(Default)]
pub(super) struct Found {
    pub(super) ranges: Vec<f32>,
    pub(super) points: Vec<[f32; 3]>,
    pub(super) intensities: Vec<f32>,
    pub(super) times: Vec<f64>,
    pub(super) lasers: Vec<u32>,
}

impl Found {
    pub(super) fn resize(&mut self, firings: usize, returns: usize) {
        self.ranges.resize(firings * returns, 0.0);
        self.points.resize(firings * returns, [0.0; 3]);
        self.intensities.resize(firings * returns, 0.0);
        self.times.resize(firings, 0.0);
        self.lasers.resize(firings, 0);
    }
}

/// A scan that is to be sent.
pub(super) struct Scan<'a> {
    pub(super) found: &'a Found,
    /// How many firings it has.
    pub(super) firings: usize,
    /// Of each firing.
    pub(super) returns: usize,
    pub(super) layout: CloudLayout,
    /// When it ends.
    pub(super) stamp_ns: u64,
    /// How long it took, in seconds; none if it was taken at one moment.
    pub(super) taken_s: Option<f64>,
}

impl Scan<'_> {
    /// Whether a return is of something that is to be shown.
    #[inline]
    fn is_point(&self, point: &[f32; 3], intensity: f32) -> bool {
        !point[0].is_nan() & (f64::from(intensity) >= self.layout.min_intensity)
    }

    /// How many of its returns are.
    fn points(&self) -> usize {
        let echoes = self.firings * self.returns;
        let returns = self.found.points[..echoes].iter().zip(&self.found.intensities[..echoes]);
        returns.filter(|(point, intensity)| self.is_point(point, **intensity)).count()
    }

    /// Each firing's time, laser, and points with intensities.
    fn firings(&self) -> impl Iterator<Item = (f64, u32, &[[f32; 3]], &[f32])> {
        let found = self.found;
        let returns =
            found.points.chunks_exact(self.returns).zip(found.intensities.chunks_exact(self.returns));
        let firings = found.times[..self.firings].iter().zip(&found.lasers).zip(returns);
        firings.map(|((time, laser), (points, intensities))| {
            (if self.taken_s.is_some() { *time } else { 0.0 }, *laser, points, intensities)
        })
    }

    /// When it began.
    fn begin_ns(&self) -> u64 {
        self.stamp_ns.saturating_sub((self.taken_s.unwrap_or(0.0) * 1e9).round() as u64)
    }

    /// When a firing was, in seconds after the beginning.
    fn time_s(&self, firing: usize) -> f64 {
        if self.taken_s.is_some() { self.found.times[firing] } else { 0.0 }
    }
}

/// Places of the points that are shown, one after the other: what is written to one is kept, or written over by the next.
/// So nothing depends on whether a return is shown but where the next one goes, which costs less than a branch.
struct Places<'a> {
    bytes: &'a mut [u8],
    at: usize,
}

impl<'a> Places<'a> {
    fn of(bytes: &'a mut [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    /// The next; none when all are kept.
    #[inline]
    fn next<const STEP: usize>(&mut self) -> Option<&mut [u8; STEP]> {
        self.bytes.get_mut(self.at..)?.first_chunk_mut()
    }

    /// Keeps what is there, or not.
    #[inline]
    fn keep<const STEP: usize>(&mut self, is_kept: bool) {
        self.at += if is_kept { STEP } else { 0 };
    }
}

/// How a driver lays out its clouds.
pub(super) trait CloudForm {
    /// What its points are.
    fn encoding(&self) -> Encoding;

    /// In how many streams they go, of so many returns a firing.
    fn streams(&self, returns: usize) -> usize {
        let _ = returns;
        1
    }

    /// Puts a scan, or what of it goes into a stream, into a frame of that; none if there is none.
    fn write(&self, scan: &Scan<'_>, stream: usize, outlet: &Outlet) -> Option<Frame>;
}

/// That of the driver of a scanner: its maker's, or Velodyne's.
pub(super) fn form_of(head: &Head, intensity: Intensity) -> Box<dyn CloudForm> {
    match head {
        Head::Preset(preset) if preset.maker == Maker::Ouster => Box::new(ouster::OusterCloud::of(preset)),
        Head::Preset(preset) if preset.maker == Maker::Livox => Box::new(livox::LivoxCloud::of(intensity)),
        _ => Box::new(velodyne::VelodyneCloud::of(&head.elevations(), head.in_row())),
    }
}
