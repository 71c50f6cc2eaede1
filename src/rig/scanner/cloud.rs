//! Clouds in the layouts of the scanners' drivers.

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

/// The results of a frame: one time and laser per firing; the others have one entry per return.
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

/// A scan that is written to a cloud.
pub(super) struct Scan<'a> {
    pub(super) found: &'a Found,
    /// Number of firings.
    pub(super) firings: usize,
    /// Number of returns of each firing.
    pub(super) returns: usize,
    pub(super) layout: CloudLayout,
    /// Time at which it ends.
    pub(super) stamp_ns: u64,
    /// Duration in seconds; `None` if all beams were measured at one moment.
    pub(super) taken_s: Option<f64>,
}

impl Scan<'_> {
    /// Returns true if a return is included in the cloud.
    #[inline]
    fn is_point(&self, point: &[f32; 3], intensity: f32) -> bool {
        !point[0].is_nan() & (f64::from(intensity) >= self.layout.min_intensity)
    }

    /// Returns the number of returns that are included in the cloud.
    fn points(&self) -> usize {
        let echoes = self.firings * self.returns;
        let returns = self.found.points[..echoes].iter().zip(&self.found.intensities[..echoes]);
        returns.filter(|(point, intensity)| self.is_point(point, **intensity)).count()
    }

    /// Iterates over the firings: time, laser, and points with intensities.
    fn firings(&self) -> impl Iterator<Item = (f64, u32, &[[f32; 3]], &[f32])> {
        let found = self.found;
        let returns =
            found.points.chunks_exact(self.returns).zip(found.intensities.chunks_exact(self.returns));
        let firings = found.times[..self.firings].iter().zip(&found.lasers).zip(returns);
        firings.map(|((time, laser), (points, intensities))| {
            (if self.taken_s.is_some() { *time } else { 0.0 }, *laser, points, intensities)
        })
    }

    /// Returns the time at which it began.
    fn begin_ns(&self) -> u64 {
        self.stamp_ns.saturating_sub((self.taken_s.unwrap_or(0.0) * 1e9).round() as u64)
    }

    /// Returns the time of a firing, in seconds after the beginning.
    fn time_s(&self, firing: usize) -> f64 {
        if self.taken_s.is_some() { self.found.times[firing] } else { 0.0 }
    }
}

/// Consecutive places for points. A point is written to the next place, and is either kept or overwritten by the next
/// one. So only the position of the next place depends on whether a return is included, which is faster than a branch.
struct Places<'a> {
    bytes: &'a mut [u8],
    at: usize,
}

impl<'a> Places<'a> {
    fn of(bytes: &'a mut [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    /// Returns the next place, or `None` if all are filled.
    #[inline]
    fn next<const STEP: usize>(&mut self) -> Option<&mut [u8; STEP]> {
        self.bytes.get_mut(self.at..)?.first_chunk_mut()
    }

    /// Keeps the point in the current place if `is_kept`.
    #[inline]
    fn keep<const STEP: usize>(&mut self, is_kept: bool) {
        self.at += if is_kept { STEP } else { 0 };
    }
}

/// The layout of a driver's clouds.
pub(super) trait CloudForm {
    /// Returns the encoding of its points.
    fn encoding(&self) -> Encoding;

    /// Returns the number of streams, for this number of returns per firing.
    fn streams(&self, returns: usize) -> usize {
        let _ = returns;
        1
    }

    /// Writes the part of a scan that belongs to a stream to a frame. Returns `None` if no frame is needed or
    /// available.
    fn write(&self, scan: &Scan<'_>, stream: usize, outlet: &Outlet) -> Option<Frame>;
}

/// Returns the layout of a scanner's driver: its maker's, or Velodyne's by default.
pub(super) fn form_of(head: &Head, intensity: Intensity) -> Box<dyn CloudForm> {
    match head {
        Head::Preset(preset) if preset.maker == Maker::Ouster => Box::new(ouster::OusterCloud::of(preset)),
        Head::Preset(preset) if preset.maker == Maker::Livox => Box::new(livox::LivoxCloud::of(intensity)),
        _ => Box::new(velodyne::VelodyneCloud::of(&head.elevations(), head.in_row())),
    }
}
