//! Scanners with a grid of pixels, scanned one after the other or all at once, such as flash lidars.

use super::firing::{Firing, FiringLanes};
use crate::ParameterError;
use crate::simd::sin_cos;
use core::f64::consts::{PI, TAU};
use glam::DVec3;

/// Pixels over a field of view, evenly spaced in angle: row by row from the top down, each from left to right. The
/// number of a row is reported as that of its laser.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Raster {
    /// The number of columns and rows of pixels.
    pub pixels: [u32; 2],
    /// The field of view between the outer edges of the pixels, in radians: up to 2π horizontally and π vertically.
    pub field_rad: [f64; 2],
    /// The time from one pixel to the next in its row, in nanoseconds; 0 if all pixels of a row fire at once.
    pub pixel_time_ns: u64,
    /// The time from the beginning of one row to that of the next, in nanoseconds. If it and `pixel_time_ns` are 0, all
    /// pixels fire at once (a flash).
    pub row_time_ns: u64,
}

impl Raster {
    pub(super) fn check(&self, frame_time_ns: u64) -> Result<(), ParameterError> {
        let wrong = |parameter, value, rule| Err(ParameterError::new("scanner", parameter, value, rule));
        if let Some(none) = self.pixels.into_iter().find(|pixels| *pixels == 0) {
            return wrong("pixels", f64::from(none), "1 or more");
        }
        for (angle, most) in self.field_rad.into_iter().zip([TAU, PI]) {
            if !(angle > 0.0 && angle <= most) {
                return wrong("field_rad", angle, "more than 0, up to 2π across and π up");
            }
        }
        let [across, up] = self.pixels.map(|pixels| u128::from(pixels) - 1);
        let row = across * u128::from(self.pixel_time_ns);
        if up > 0 && row > u128::from(self.row_time_ns) {
            return wrong("row_time_ns", self.row_time_ns as f64, "at least the time of all pixels of a row");
        }
        if up * u128::from(self.row_time_ns) + row >= u128::from(frame_time_ns) {
            return wrong("frame_time_ns", frame_time_ns as f64, "more than the time of all rows");
        }
        Ok(())
    }

    /// Returns the number of pixels.
    pub(super) fn firings(&self) -> u64 {
        u64::from(self.pixels[0]) * u64::from(self.pixels[1])
    }

    /// Returns the time of a firing, in seconds after the beginning of the frame.
    pub(super) fn time_s(&self, index: usize) -> f64 {
        let across = u64::from(self.pixels[0]);
        let (row, column) = (index as u64 / across, index as u64 % across);
        (row * self.row_time_ns + column * self.pixel_time_ns) as f64 * 1e-9
    }

    /// Returns the angle of the first pixel's centre along an axis, in radians to the left or up, and the step to the
    /// next pixel. Axis 0 is horizontal, 1 is vertical.
    pub fn angles(&self, axis: usize) -> [f64; 2] {
        let step = self.field_rad[axis] / f64::from(self.pixels[axis]);
        [0.5 * (self.field_rad[axis] - step), step]
    }

    #[inline(always)]
    pub(super) fn fill(&self, (first, count): (usize, usize), lanes: &mut FiringLanes) {
        let ([left, across], [top, down]) = (self.angles(0), self.angles(1));
        for lane in 0..count {
            let index = first + lane;
            let (row, column) = (index / self.pixels[0] as usize, index % self.pixels[0] as usize);
            let (sin, cos) = sin_cos(left - across * column as f64);
            let (up, level) = sin_cos(top - down * row as f64);
            let direction = DVec3::new(cos * level, sin * level, up);
            let time_s = self.time_s(index);
            lanes.set(lane, &Firing { time_s, origin: DVec3::ZERO, direction, laser: row as u32 });
        }
    }
}
