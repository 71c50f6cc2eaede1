//! The outputs of a scanner's frame.

use super::firing::Firing;
use crate::execution::split_at;
use crate::trace::error::check_output;
use crate::trace::truth::OfRay;
use crate::trace::{SenseError, Truth};
use glam::DVec3;

/// The output buffers of a scanner's frame, in the order of the firings.
///
/// Times, lasers and ground truth have [`Scanner::most_firings`](super::Scanner::most_firings) elements. Ranges, points
/// and intensities have that many for each of the scanner's [returns](super::Returns); those of a firing are adjacent.
/// If a frame has fewer firings, the remaining elements are NaN.
#[derive(Debug, Default)]
#[non_exhaustive]
pub struct Echoes<'a> {
    /// Measured ranges in metres from the origin of the firing; +∞ where nothing is in range, −∞ where something is too
    /// near (REP-117).
    pub ranges: Option<&'a mut [f32]>,
    /// The measured points in metres, in the frame of the sensor at the time of the firing; NaN where there is no
    /// range.
    pub points: Option<&'a mut [[f32; 3]]>,
    /// Intensities as defined by [`Intensity`](super::Intensity); 0 where there is no range.
    pub intensities: Option<&'a mut [f32]>,
    /// Times of the firings in seconds after the beginning of the frame.
    pub times: Option<&'a mut [f64]>,
    /// The numbers of the lasers that fire, counted from 0; `u32::MAX` for firings that a frame does not have.
    pub lasers: Option<&'a mut [u32]>,
    /// Ground truth for the ray in the middle of each beam. Flow is not available.
    pub truth: Option<Truth<'a>>,
}

impl<'a> Echoes<'a> {
    outputs! {
        /// Sets the buffer for ranges.
        ranges: &'a mut [f32],
        /// Sets the buffer for points.
        points: &'a mut [[f32; 3]],
        /// Sets the buffer for intensities.
        intensities: &'a mut [f32],
        /// Sets the buffer for times.
        times: &'a mut [f64],
        /// Sets the buffer for the numbers of the lasers.
        lasers: &'a mut [u32],
        /// Sets the buffers for ground truth.
        truth: Truth<'a>,
    }
}

impl Echoes<'_> {
    /// Splits off the parts of the first firings, each with this number of returns.
    pub(super) fn split_at(self, firings: usize, returns: usize) -> (Self, Self) {
        let (ranges, ranges_rest) = split_at(self.ranges, firings * returns);
        let (points, points_rest) = split_at(self.points, firings * returns);
        let (intensities, intensities_rest) = split_at(self.intensities, firings * returns);
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

    pub(super) fn check(&self, firings: usize, returns: usize) -> Result<(), SenseError> {
        let echoes = firings * returns;
        check_output("ranges", self.ranges.as_ref().map(|ranges| ranges.len()), echoes)?;
        check_output("points", self.points.as_ref().map(|points| points.len()), echoes)?;
        check_output("intensities", self.intensities.as_ref().map(|values| values.len()), echoes)?;
        check_output("times", self.times.as_ref().map(|times| times.len()), firings)?;
        check_output("lasers", self.lasers.as_ref().map(|lasers| lasers.len()), firings)?;
        let Some(truth) = &self.truth else { return Ok(()) };
        if truth.flow.is_some() || truth.flow_back.is_some() {
            return Err(SenseError::FlowOfFirings);
        }
        truth.check_len(firings)
    }

    /// Writes a return.
    #[inline(always)]
    pub(super) fn put(&mut self, index: usize, range: f32, point: DVec3, intensity: f32) {
        if let Some(ranges) = &mut self.ranges {
            ranges[index] = range;
        }
        if let Some(points) = &mut self.points {
            points[index] = point.as_vec3().to_array();
        }
        if let Some(intensities) = &mut self.intensities {
            intensities[index] = intensity;
        }
    }

    /// Writes the time and the laser of a firing.
    #[inline(always)]
    pub(super) fn put_firing(&mut self, index: usize, firing: &Firing) {
        if let Some(times) = &mut self.times {
            times[index] = firing.time_s;
        }
        if let Some(lasers) = &mut self.lasers {
            lasers[index] = firing.laser;
        }
    }

    /// Fills the elements of firings that the frame does not have.
    pub(super) fn fill_with_nothing(&mut self, firings: usize) {
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
