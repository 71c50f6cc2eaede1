//! Selection of the chart for a table.

use super::super::RayGrid;
use super::chart::{Chart, ChartKind, Stretch, TURN};
use crate::simd::{WIDTH, sqrt};
use glam::{DMat3, DVec3};

/// Cosine of the greatest angle from the axis of a perspective chart, 65°.
const COS_PERSPECTIVE: f64 = 0.4226;
/// Cosine of the greatest angle from the axis of a stereographic chart, 150°.
const COS_STEREOGRAPHIC: f64 = -0.866;
/// An axis with a greater cosine to one of the sensor's axes is replaced by that axis.
const COS_SAME: f64 = 0.999_99;

/// A chart, and the way in which columns run on it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layout {
    pub(super) chart: Chart,
    /// True if the columns close to a ring.
    pub(super) ring: bool,
}

impl Layout {
    /// The number of a column at a coordinate: on a ring, numbers continue past the seam.
    pub(super) fn column(&self, rays: &TableDirections<'_>, column: i32, u: f32) -> i32 {
        if !self.ring {
            return column;
        }
        let width = rays.ray_grid.width;
        // Within an eighth of a turn of the column's position.
        let about = (u / TURN + 0.5) * width as f32 - 0.5;
        let turns = libm::roundf((about - column as f32) / width as f32);
        column + turns as i32 * width
    }
}

/// The directions of a table.
pub(super) struct TableDirections<'a> {
    pub(super) ray_grid: RayGrid,
    pub(super) blocks: &'a [[[f32; WIDTH]; 3]],
    /// The lanes of each block without a ray, as one bit each.
    pub(super) missing: &'a [u16],
}

impl TableDirections<'_> {
    fn place(&self, column: i32, row: i32) -> (usize, usize) {
        let ray_grid = &self.ray_grid;
        let block = (row >> ray_grid.shift_y) as usize * ray_grid.blocks_across()
            + (column >> ray_grid.shift_x) as usize;
        (block, ray_grid.lane(column, row))
    }

    /// Returns true if the ray exists.
    pub(super) fn has(&self, column: i32, row: i32) -> bool {
        let (block, lane) = self.place(column, row);
        self.missing[block] >> lane & 1 == 0
    }

    /// The direction of a ray. If it does not exist, another ray's direction, or straight ahead.
    pub(super) fn direction(&self, column: i32, row: i32) -> DVec3 {
        let (block, lane) = self.place(column, row);
        let [x, y, z] = &self.blocks[block];
        DVec3::new(x[lane].into(), y[lane].into(), z[lane].into())
    }

    /// Calls `work` with the column, row and direction of each ray that exists.
    pub(super) fn for_each(&self, mut work: impl FnMut(i32, i32, DVec3)) {
        for row in 0..self.ray_grid.height {
            for column in 0..self.ray_grid.width {
                if self.has(column, row) {
                    work(column, row, self.direction(column, row));
                }
            }
        }
    }

    /// The axis of a perspective or stereographic chart, if all directions are within the given angle of it. The
    /// sensor's own axis nearest to the middle is preferred, since the boxes of the sensor are aligned with it.
    fn axis_ahead(&self, cosine: f64) -> Option<DVec3> {
        let mut sum = DVec3::ZERO;
        self.for_each(|_, _, direction| sum += direction);
        let near = |axis: DVec3| {
            let mut least = f64::INFINITY;
            self.for_each(|_, _, direction| least = least.min(direction.dot(axis)));
            least >= cosine
        };
        [nearest_axis(sum), unit(sum)?].into_iter().find(|axis| near(*axis))
    }

    pub(super) fn perspective(&self) -> Option<Layout> {
        Some(self.ahead(ChartKind::Perspective, self.axis_ahead(COS_PERSPECTIVE)?))
    }

    pub(super) fn stereographic(&self) -> Option<Layout> {
        Some(self.ahead(ChartKind::Stereographic, self.axis_ahead(COS_STEREOGRAPHIC)?))
    }

    /// A chart around an axis, rotated so that columns run along its first coordinate.
    fn ahead(&self, kind: ChartKind, axis: DVec3) -> Layout {
        let [across, down] = self.steps().map(|step| step - axis * axis.dot(step));
        let along_column = unit(down).map(|down| down.cross(axis));
        let u = unit(across).or(along_column).unwrap_or_else(|| axis.any_orthonormal_vector());
        let straight = settled(u);
        let u = if straight.dot(axis) == 0.0 { straight } else { u };
        let v = axis.cross(u);
        let v = if v.dot(down) < 0.0 { -v } else { v };
        Layout { chart: Chart::new(kind, [axis, u, v]), ring: false }
    }

    /// The same chart with a stretch that makes columns and rows as straight as possible.
    pub(super) fn stretched(&self, layout: &Layout) -> Option<Layout> {
        let wide = self.ray_grid.width >= self.ray_grid.height;
        let stretch = Stretch::fit(self.ray_grid.width * self.ray_grid.height, |take| {
            self.for_each(|column, row, direction| {
                let [u, v] = layout.chart.coordinates(direction).map(f64::from);
                if wide { take([u, v], f64::from(column)) } else { take([v, u], f64::from(row)) }
            });
        })?;
        Some(Layout { chart: layout.chart.stretched(stretch), ..*layout })
    }

    /// The differences from the first to the last column, summed over rows, and from the first to the last row, summed
    /// over columns.
    fn steps(&self) -> [DVec3; 2] {
        let [right, bottom] = [self.ray_grid.width - 1, self.ray_grid.height - 1];
        let step = |from: [i32; 2], to: [i32; 2]| {
            let both = self.has(from[0], from[1]) && self.has(to[0], to[1]);
            if both { self.direction(to[0], to[1]) - self.direction(from[0], from[1]) } else { DVec3::ZERO }
        };
        let across = (0..=bottom).map(|row| step([0, row], [right, row])).sum();
        let down = (0..=right).map(|column| step([column, 0], [column, bottom])).sum();
        // A circular image may not reach any edge; use neighbours in its middle instead.
        if across == DVec3::ZERO || down == DVec3::ZERO {
            let [x, y] = [right / 2, bottom / 2];
            let next = |first: i32, last: i32| (first + 1).min(last);
            return [step([x, y], [next(x, right), y]), step([x, y], [x, next(y, bottom)])];
        }
        [across, down]
    }

    /// A chart around the axis that the rows encircle.
    pub(super) fn cylindrical(&self) -> Layout {
        let (width, height) = (self.ray_grid.width, self.ray_grid.height);
        // Steps along rows are perpendicular to the axis, so the axis is the direction in which they are smallest.
        let mut steps = DMat3::ZERO;
        for row in 0..height {
            for column in 1..width {
                if !(self.has(column, row) && self.has(column - 1, row)) {
                    continue;
                }
                let step = self.direction(column, row) - self.direction(column - 1, row);
                steps += DMat3::from_cols(step * step.x, step * step.y, step * step.z);
            }
        }
        let axis = settled(least_axis(&steps));
        let axis = if axis.dot(self.steps()[1]) < 0.0 { -axis } else { axis };
        // The seam is opposite to the middle, between two columns.
        let (mut middle, mut turn) = (DVec3::ZERO, 0.0);
        for row in 0..height {
            middle += self.direction((width - 1) / 2, row) + self.direction(width / 2, row);
            for column in 1..width {
                turn += self.direction(column - 1, row).cross(self.direction(column, row)).dot(axis);
            }
        }
        let across = |direction: DVec3| unit(direction - axis * axis.dot(direction));
        let ahead = across(middle).unwrap_or_else(|| axis.any_orthonormal_vector());
        let left = axis.cross(ahead);
        let left = if turn < 0.0 { -left } else { left };
        let chart = Chart::new(ChartKind::Cylindrical, [ahead, left, axis]);
        let ends = [0, width - 1].map(|column| across(self.direction(column, height / 2)));
        let ring = match ends {
            // Less than two and a half columns short of a full turn.
            [Some(first), Some(last)] => {
                let most = 2.5 * core::f64::consts::TAU / f64::from(width);
                width >= 16 && first.dot(last) > 1.0 - 0.5 * most * most
            }
            _ => false,
        };
        Layout { chart, ring }
    }
}

/// The unit vector in the direction of `vector`, or `None` if it has almost no length.
fn unit(vector: DVec3) -> Option<DVec3> {
    let length = sqrt(vector.length_squared());
    (length > 1e-6).then(|| vector / length)
}

/// The axis of the sensor that is nearest to a vector.
fn nearest_axis(vector: DVec3) -> DVec3 {
    let size = vector.abs();
    let axis = if size.x >= size.y && size.x >= size.z {
        DVec3::X
    } else if size.y >= size.z {
        DVec3::Y
    } else {
        DVec3::Z
    };
    if axis.dot(vector) < 0.0 { -axis } else { axis }
}

/// Normalises a vector, and replaces it by one of the sensor's axes if they differ only by rounding.
fn settled(vector: DVec3) -> DVec3 {
    let nearest = nearest_axis(vector);
    let vector = unit(vector).unwrap_or(nearest);
    if vector.dot(nearest) > COS_SAME { nearest } else { vector }
}

/// The axis along which a sum of squares is least: an eigenvector, computed by repeatedly squaring its complement to
/// the trace.
fn least_axis(squares: &DMat3) -> DVec3 {
    let trace = |matrix: &DMat3| matrix.x_axis.x + matrix.y_axis.y + matrix.z_axis.z;
    let mut power = DMat3::IDENTITY * (trace(squares) + 1e-30) - *squares;
    for _ in 0..24 {
        power *= 1.0 / trace(&power);
        power *= power;
    }
    let mut axis = power.z_axis;
    for other in [power.x_axis, power.y_axis] {
        if other.length_squared() > axis.length_squared() * 1.01 {
            axis = other;
        }
    }
    axis
}
