//! Points of measured ranges.

use super::LidarConfig;

/// The number of columns whose sines and cosines are kept at a time.
const COLUMNS: usize = 64;

/// Returns a place for the ranges in the memory of the points, from which [`fill`] takes them.
pub(super) fn room_for_ranges(points: &mut [[f32; 3]]) -> &mut [f32] {
    let beams = points.len();
    &mut points.as_flattened_mut()[..beams]
}

/// Computes the points of a whole scan. Without `ranges`, they lie in [`room_for_ranges`].
pub(super) fn fill(config: &LidarConfig, ranges: Option<&[f32]>, points: &mut [[f32; 3]]) {
    // Each point holds its range until it is computed. Within the memory of the points, ranges move to the right, so
    // the last one goes first.
    for beam in (0..points.len()).rev() {
        let range = ranges.map_or_else(|| points.as_flattened()[beam], |ranges| ranges[beam]);
        points[beam][0] = range;
    }
    let samples = config.horizontal.samples as usize;
    for first in (0..samples).step_by(COLUMNS) {
        let columns = first..samples.min(first + COLUMNS);
        let mut turns = [(0.0, 0.0); COLUMNS];
        for (column, turn) in columns.clone().zip(&mut turns) {
            *turn = libm::sincos(config.horizontal.angle(column as u32));
        }
        for (row, line) in points.chunks_mut(samples).enumerate() {
            let (sin_elevation, cos_elevation) = libm::sincos(config.vertical.angle(row as u32));
            for (point, (sin_azimuth, cos_azimuth)) in line[columns.clone()].iter_mut().zip(turns) {
                let range = f64::from(point[0]);
                let across = range * cos_elevation;
                let at = [across * cos_azimuth, across * sin_azimuth, range * sin_elevation];
                *point = if range.is_finite() { at.map(|part| part as f32) } else { [f32::NAN; 3] };
            }
        }
    }
}
