//! Flat charts of the directions of a table, on which boxes and triangles are bounded.
//!
//! The first coordinate of a chart should increase with the column and the second with the row. How closely they do
//! determines how tight bounds are, but bounds are always valid.

mod ahead;
mod around;
mod stretch;

use super::super::projection::{Points, bounds_of, max, min};
use crate::simd::sqrt;
use ahead::{
    ARC, boxes_in_perspective, boxes_in_stereographic, points_in_perspective, points_in_stereographic,
};
pub(super) use around::TURN;
use around::{boxes_in_cylindrical, triangles_in_cylindrical, turn_of};
use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x16, mask32x16};
use glam::{DMat3, DVec3};
pub(super) use stretch::Stretch;

/// An upper bound on the rounding error of a direction, in radians.
const MARGIN: f32 = 4e-6;
/// A coordinate outside all charts.
const BEYOND: f32 = 1e9;

/// The map from directions to the plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ChartKind {
    /// y/x and z/x, for directions within 65° of the axis. Straight lines stay straight, and the bounds of boxes are
    /// tight.
    Perspective,
    /// y/(1 + x) and z/(1 + x), stereographic, for directions within 150° of the axis, such as those of a fisheye lens.
    Stereographic,
    /// Azimuth around z, and tangent of half the elevation: for the rings of a lidar, and anything else.
    Cylindrical,
}

/// A chart and its axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Chart {
    pub(super) kind: ChartKind,
    /// Rows of the matrix from the sensor's axes to the chart's, which may include a reflection.
    rows: [[f32; 3]; 3],
    axes: [[f64; 3]; 3],
    /// The stretch of a perspective or stereographic chart.
    stretch: Option<Stretch>,
}

/// Sixteen windows of a chart, from the least to the greatest of each coordinate. Azimuths may continue past the seam.
pub(super) struct Windows<S: Simd> {
    pub(super) u: [f32x16<S>; 2],
    pub(super) v: [f32x16<S>; 2],
    /// The windows that are not empty.
    pub(super) some: mask32x16<S>,
}

#[inline(always)]
fn rotate<S: Simd>(rows: &[[f32; 3]; 3], point: &Points<S>) -> Points<S> {
    let [x, y, z] = *point;
    [
        (x * rows[0][0] + y * rows[0][1]) + z * rows[0][2],
        (x * rows[1][0] + y * rows[1][1]) + z * rows[1][2],
        (x * rows[2][0] + y * rows[2][1]) + z * rows[2][2],
    ]
}

/// The least and the greatest of three values.
#[inline(always)]
fn spread_of<S: Simd>(values: &[f32x16<S>; 3]) -> [f32x16<S>; 2] {
    [min(min(values[0], values[1]), values[2]), max(max(values[0], values[1]), values[2])]
}

impl Chart {
    pub(super) fn new(kind: ChartKind, axes: [DVec3; 3]) -> Self {
        Self {
            kind,
            rows: axes.map(|axis| axis.as_vec3().to_array()),
            axes: axes.map(|axis| axis.to_array()),
            stretch: None,
        }
    }

    /// The same chart with a stretch.
    pub(super) fn stretched(self, stretch: Stretch) -> Self {
        Self { stretch: Some(stretch), ..self }
    }

    /// Chart coordinates of a direction of length 1.
    pub(super) fn coordinates(&self, direction: DVec3) -> [f32; 2] {
        let point = DMat3::from_cols_array_2d(&self.axes).transpose() * direction;
        let [u, v] = match self.kind {
            ChartKind::Perspective => [point.y / point.x, point.z / point.x],
            ChartKind::Stereographic => [point.y / (1.0 + point.x), point.z / (1.0 + point.x)],
            ChartKind::Cylindrical => {
                let level = sqrt(point.x * point.x + point.y * point.y);
                [turn_of(point.x, point.y), point.z / (level + 1.0)]
            }
        };
        let [u, v] = self.stretch.map_or([u, v], |stretch| stretch.point([u, v]));
        [u as f32, v as f32]
    }

    /// Windows that contain the boxes.
    #[inline(always)]
    pub(super) fn windows_of_boxes<S: Simd>(&self, simd: S, low: &Points<S>, high: &Points<S>) -> Windows<S> {
        let (mut centre, mut half) = (*low, *low);
        for axis in 0..3 {
            centre[axis] = (low[axis] + high[axis]) * 0.5;
            half[axis] = (high[axis] - low[axis]) * 0.500_001;
        }
        // Upper bound on the rounding error of the rotated box.
        let far = |axis: usize| centre[axis].abs() + half[axis];
        let slack = max(max(far(0), far(1)), far(2)) * 1e-6;
        centre = rotate(&self.rows, &centre);
        let mut sizes = self.rows;
        for value in sizes.as_flattened_mut() {
            *value = value.abs();
        }
        let reach = rotate(&sizes, &half);
        let (mut low, mut high) = (centre, centre);
        for axis in 0..3 {
            half[axis] = reach[axis] + slack;
            low[axis] = centre[axis] - half[axis];
            high[axis] = centre[axis] + half[axis];
        }
        let windows = match self.kind {
            ChartKind::Perspective => boxes_in_perspective(simd, &low, &high),
            ChartKind::Stereographic => boxes_in_stereographic(simd, &low, &high),
            ChartKind::Cylindrical => boxes_in_cylindrical(simd, &low, &high),
        };
        match &self.stretch {
            Some(stretch) => stretch.windows(simd, &windows),
            None => windows,
        }
    }

    /// Windows that contain the triangles.
    #[inline(always)]
    pub(super) fn windows_of_triangles<S: Simd>(
        &self,
        simd: S,
        corners: &[Points<S>; 3],
        valid: mask32x16<S>,
    ) -> Windows<S> {
        let turned = [
            rotate(&self.rows, &corners[0]),
            rotate(&self.rows, &corners[1]),
            rotate(&self.rows, &corners[2]),
        ];
        let (mut windows, sure) = match self.kind {
            ChartKind::Perspective | ChartKind::Stereographic => self.triangles_ahead(simd, &turned),
            ChartKind::Cylindrical => triangles_in_cylindrical(simd, &turned),
        };
        if (valid & !sure).any_true() {
            let (low, high) = bounds_of(corners);
            let loose = self.windows_of_boxes(simd, &low, &high);
            for end in 0..2 {
                windows.u[end] = sure.select(windows.u[end], loose.u[end]);
                windows.v[end] = sure.select(windows.v[end], loose.v[end]);
            }
            windows.some = sure | loose.some;
        }
        windows.some &= valid;
        windows
    }

    /// The windows of triangles, and a mask of those that are valid: all corners must be well in front, and triangles
    /// must be small if the chart bends their edges.
    #[inline(always)]
    fn triangles_ahead<S: Simd>(&self, simd: S, corners: &[Points<S>; 3]) -> (Windows<S>, mask32x16<S>) {
        let zero = f32x16::splat(simd, 0.0);
        let (mut u, mut v) = ([zero; 3], [zero; 3]);
        let mut sure = mask32x16::splat(simd, true);
        for (index, corner) in corners.iter().enumerate() {
            let (at, ahead) = if self.kind == ChartKind::Perspective {
                points_in_perspective(simd, corner)
            } else {
                points_in_stereographic(simd, corner)
            };
            sure &= ahead;
            [u[index], v[index]] = at;
        }
        let (mut across, mut down) = (spread_of(&u), spread_of(&v));
        let square = {
            let (across, down) = (across[1] - across[0], down[1] - down[0]);
            across * across + down * down
        };
        let bulge = if self.kind == ChartKind::Perspective {
            0.0
        } else {
            sure &= square.simd_lt(f32x16::splat(simd, 0.04));
            ARC
        };
        let margin = if let Some(stretch) = &self.stretch {
            for corner in 0..3 {
                let (at, known) = stretch.points([u[corner], v[corner]]);
                sure &= known;
                [u[corner], v[corner]] = at;
            }
            (across, down) = (spread_of(&u), spread_of(&v));
            stretch.margin(square, bulge)
        } else {
            // An error of direction moves a point by at most 1 + u² + v² times as much.
            let (far_u, far_v) = (max(-across[0], across[1]), max(-down[0], down[1]));
            ((far_u * far_u + far_v * far_v) + 1.0) * MARGIN + square * bulge
        };
        let u = [across[0] - margin, across[1] + margin];
        let v = [down[0] - margin, down[1] + margin];
        (Windows { u, v, some: sure }, sure)
    }
}
