//! Frames of rays from one point, traced band by band.

mod band;
mod bands;
pub(crate) mod place;
mod shutter;
pub(crate) mod tiling;

pub(crate) use band::{Band, BandWork};
pub(crate) use shutter::check_shutter;

use super::error::SenseError;
use super::image::{Target, walk};
use super::packet::Faces;
use crate::execution::{Execution, SplitRows, for_each_row};
use crate::memory::{Cutter, lines};
use crate::moment::{Moment, Shutter};
use crate::optics::rays::{
    AngleSteps, PinholeRays, Projection, RayGrid, Rays, SphericalRays, TableRays, each,
};
use crate::optics::{Optics, SphericalGrid};
use crate::scene::Scene;
use crate::simd::{WIDTH, dispatch, least};
use crate::trace::grid::bands::Bands;
use crate::trace::packet::scratch::SpecularScratch;
use crate::trace::placed::memory::view_lines;
use crate::trace::placed::view::View;
use band::{BandOutput, BandPart};
use core::cell::RefCell;
use fearless_simd::Simd;
use shutter::ray_grid_of;

/// The criteria for what is visible.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sight {
    pub(crate) faces: Faces,
    /// The least and the greatest t.
    pub(crate) range: [f64; 2],
    /// Nothing is traced if no surface is within this many metres of the sensor.
    pub(crate) within: f64,
}

/// A frame to be traced: its rays, and the poses of everything when they are cast.
pub(crate) struct Frame<'a> {
    optics: &'a Optics<'a>,
    ray_grid: RayGrid,
    /// The column of the grid of angles with which the frame begins.
    first_column: u32,
    execution: Execution,
    when: When<'a>,
}

#[allow(clippy::large_enum_variant, reason = "one a frame, and there may be no heap")]
enum When<'a> {
    /// All rays see one view.
    Once(View<'a>),
    /// Each band makes its own views, one after the other.
    Slices { scene: &'a Scene<'a>, shutter: Shutter<'a>, visibility: u32 },
}

impl<'a> Frame<'a> {
    /// Returns the number of cache lines that creating and tracing a frame needs.
    pub(crate) fn workspace_len(scene: &Scene<'_>, optics: &Optics<'_>, shutter: &Shutter<'_>) -> usize {
        if optics.check().is_err() {
            return 0; // and no frame
        }
        let ray_grid = Self::ray_grid_of(optics, shutter);
        let views = if shutter.slices().is_empty() { 1 } else { Bands::new(&ray_grid).count };
        view_lines(scene.instances().len(), views) + traced_len(scene, optics, &ray_grid, 0)
    }

    /// The same for a frame of some [columns](Frame::of_columns).
    pub(crate) fn columns_workspace_len(
        scene: &Scene<'_>,
        optics: &Optics<'_>,
        columns: &core::ops::Range<u32>,
    ) -> usize {
        let ray_grid = ray_grid_of_columns(optics, columns);
        view_lines(scene.instances().len(), 1) + traced_len(scene, optics, &ray_grid, columns.start)
    }

    /// The grid of blocks in which the rays are traced.
    pub(crate) fn ray_grid_of(optics: &Optics<'_>, shutter: &Shutter<'_>) -> RayGrid {
        // If the grid is invalid, nothing will be traced.
        ray_grid_of(optics, shutter).unwrap_or(optics.ray_grid())
    }

    /// Checks rays, shutter and moments, and places the instances that `visibility` selects.
    pub(crate) fn new(
        scene: &'a Scene<'a>,
        optics: &'a Optics<'a>,
        shutter: &Shutter<'a>,
        visibility: u32,
        execution: Execution,
        memory: &mut Cutter<'a>,
    ) -> Result<Self, SenseError> {
        optics.check()?;
        let ray_grid = ray_grid_of(optics, shutter)?;
        check_shutter(scene, shutter, ray_grid.height as u32)?;
        let when = match *shutter {
            Shutter::Global(ref moment) => {
                When::Once(View::new(scene, moment, visibility, memory.views(scene.instances().len(), 1)))
            }
            // Moving shutters were refused above.
            Shutter::Slices(_) | Shutter::Moving(_) => When::Slices { scene, shutter: *shutter, visibility },
        };
        Ok(Self { optics, ray_grid, first_column: 0, execution, when })
    }

    /// Creates a frame of some columns of a grid of angles at one moment, both of which have been checked. The rays are
    /// the same as those of the whole grid, to the last bit.
    pub(crate) fn of_columns(
        scene: &'a Scene<'a>,
        optics: &'a Optics<'a>,
        (columns, moment): (&core::ops::Range<u32>, &Moment<'a>),
        visibility: u32,
        execution: Execution,
        memory: &mut Cutter<'a>,
    ) -> Self {
        let views = memory.views(scene.instances().len(), 1);
        Self {
            optics,
            ray_grid: ray_grid_of_columns(optics, columns),
            first_column: columns.start,
            execution,
            when: When::Once(View::new(scene, moment, visibility, views)),
        }
    }

    pub(crate) fn ray_grid(&self) -> &RayGrid {
        &self.ray_grid
    }

    fn scene(&self) -> &Scene<'a> {
        match &self.when {
            When::Once(view) => &view.scene,
            When::Slices { scene, .. } => scene,
        }
    }

    /// The view of all rays, if they are cast at one moment.
    pub(crate) fn view(&self) -> Option<&View<'a>> {
        match &self.when {
            When::Once(view) => Some(view),
            When::Slices { .. } => None,
        }
    }

    /// The number of rays of a row of blocks.
    pub(crate) fn rays_in_row(&self) -> usize {
        (self.ray_grid.width as usize) << self.ray_grid.shift_y
    }

    /// Returns false if no surface is within this many metres of the sensor. The test is conservative: it may return
    /// true although none is.
    pub(crate) fn may_be_within(&self, radius: f64) -> bool {
        match &self.when {
            When::Once(view) => view.may_be_within(radius),
            When::Slices { .. } => true,
        }
    }

    /// Traces all rays and passes each band to `work`.
    pub(crate) fn trace<O: SplitRows, W: BandWork<O>>(
        &self,
        sight: &Sight,
        memory: &mut Cutter<'_>,
        output: O,
        work: &W,
    ) {
        let ray_grid = self.ray_grid;
        let rays = rays_of(self.optics, (ray_grid, self.first_column), self.execution, memory);
        let bands = Bands::new(&ray_grid);
        let (instances, views) = match &self.when {
            When::Once(_) => (0, None),
            When::Slices { scene, .. } => {
                let instances = scene.instances().len();
                (instances, Some(memory.views(instances, bands.count)))
            }
        };
        let output = BandOutput {
            views,
            instances,
            inverse: memory.take(bands.blocks),
            slot: memory.take(bands.blocks),
            farthest: memory.take(bands.farthest_len(&ray_grid)),
            rooms: memory.take(rooms(self.scene(), &bands)),
            output,
            farthest_stride: bands.farthest_stride,
            block_rows: bands.block_rows,
            blocks_across: ray_grid.blocks_across(),
        };
        for_each_row(self.execution, 0..bands.count, output, &|band, mut output: BandOutput<'_, O>| {
            let first = (band * bands.block_rows) << ray_grid.shift_y;
            let end = (((band + 1) * bands.block_rows) << ray_grid.shift_y).min(ray_grid.height as usize);
            let first_row = first as i32;
            match &self.when {
                When::Once(view) => {
                    let rows = [first_row, end as i32 - 1];
                    let part = BandPart { rows, first_row, fresh_from: 0, open_from: i32::MAX };
                    self.trace_part(view, &rays, sight, &part, &mut output, work);
                }
                When::Slices { scene, shutter, visibility } => {
                    let Some(mut views) = output.views.take() else { return };
                    let slices = shutter.slices();
                    for index in shutter.covering(first as u32..end as u32) {
                        let lines = &slices[index].lines;
                        let fresh_from = index.checked_sub(1).map_or(0, |before| slices[before].lines.end);
                        let open_from = slices.get(index + 1).map_or(u32::MAX, |next| next.lines.start);
                        let start = if work.is_mean() { lines.start } else { lines.start.max(fresh_from) };
                        let rows = [start.max(first as u32) as i32, lines.end.min(end as u32) as i32 - 1];
                        if rows[0] > rows[1] {
                            continue;
                        }
                        let view = View::new(scene, &slices[index].at, *visibility, views.reborrow());
                        let open_from = i32::try_from(open_from).unwrap_or(i32::MAX);
                        let part = BandPart { rows, first_row, fresh_from: fresh_from as i32, open_from };
                        self.trace_part(&view, &rays, sight, &part, &mut output, work);
                    }
                }
            }
        });
    }

    /// Traces the rows of a band that are captured at one moment.
    fn trace_part<O: SplitRows, W: BandWork<O>>(
        &self,
        view: &View<'_>,
        rays: &Rays<'_>,
        sight: &Sight,
        part: &BandPart,
        output: &mut BandOutput<'_, O>,
        work: &W,
    ) {
        let ray_grid = self.ray_grid;
        let BandPart { rows, first_row, fresh_from, open_from } = *part;
        let [first, last] = rows.map(|row| (row >> ray_grid.shift_y) as usize);
        let before = (first - (first_row >> ray_grid.shift_y) as usize) * output.blocks_across;
        let blocks = (last - first + 1) * output.blocks_across;
        let mut target = Target {
            inverse: &mut output.inverse[before..][..blocks],
            slot: &mut output.slot[before..][..blocks],
            farthest: &mut output.farthest[..blocks + WIDTH],
        };
        let room = RefCell::new(output.rooms.get_mut(..1).unwrap_or_default());
        let output = &mut output.output;
        let is_near = sight.within == f64::INFINITY || view.may_be_within(sight.within);
        dispatch!(self.execution.level, simd => {
            target.clear((1.0 / sight.range[1]) as f32);
            if is_near {
                if let Rays::Table(table) = rays && table.has_missing() {
                    leave_out(rays, rows, &mut target);
                }
                each!(*rays, rule => draw(simd, view, rule.with_rows(rows), rows, sight, &mut target));
            }
            let band = Band { view, rays: *rays, rows, first_row, fresh_from, open_from, target, room };
            finish(simd, &band, output, work);
        });
    }
}

/// The blocks of some columns of a grid.
fn ray_grid_of_columns(optics: &Optics<'_>, columns: &core::ops::Range<u32>) -> RayGrid {
    RayGrid::new(columns.end - columns.start, optics.ray_grid().height as u32)
}

/// The number of cache lines for tracing a grid that begins at the given column of the optics.
fn traced_len(scene: &Scene<'_>, optics: &Optics<'_>, ray_grid: &RayGrid, first_column: u32) -> usize {
    let bands = Bands::new(ray_grid);
    // 1/t and slots need one cache line per block each.
    let blocks = 2 * bands.blocks + lines(bands.farthest_len(ray_grid) * size_of::<f32>());
    rays_len(optics, ray_grid, first_column)
        + blocks
        + lines(rooms(scene, &bands) * size_of::<SpecularScratch>())
}

/// The number of scratch memories for rays beyond mirrors and panes: one per band, or 0 if they are not needed.
fn rooms(scene: &Scene<'_>, bands: &Bands) -> usize {
    if scene.has_mirrors_or_panes() { bands.count } else { 0 }
}

/// The rays of a grid that begins at the given column of the optics.
pub(crate) fn rays_of<'a, 'm: 'a>(
    optics: &Optics<'a>,
    (ray_grid, first_column): (RayGrid, u32),
    execution: Execution,
    memory: &mut Cutter<'m>,
) -> Rays<'a> {
    match optics {
        Optics::Pinhole(lens) => Rays::Pinhole(PinholeRays::new(lens, ray_grid)),
        Optics::Spherical(grid) => {
            Rays::Spherical(spherical(grid, (ray_grid, first_column), execution, memory))
        }
        Optics::Table(table) => Rays::Table(TableRays::new(table)),
    }
}

/// The number of cache lines that the tables of these rays need.
pub(crate) fn rays_len(optics: &Optics<'_>, ray_grid: &RayGrid, first_column: u32) -> usize {
    match optics {
        Optics::Spherical(_) => SphericalRays::table_len(ray_grid, first_column),
        Optics::Pinhole(_) | Optics::Table(_) => 0,
    }
}

/// The angles of a spinning lidar, with their tables.
fn spherical<'a>(
    grid: &SphericalGrid,
    (ray_grid, first_column): (RayGrid, u32),
    execution: Execution,
    memory: &mut Cutter<'a>,
) -> SphericalRays<'a> {
    let azimuth = AngleSteps { first: grid.first_azimuth_rad, step: grid.azimuth_step_rad };
    let elevation = AngleSteps { first: grid.first_elevation_rad, step: grid.elevation_step_rad };
    let tables = memory.take(SphericalRays::table_len(&ray_grid, first_column));
    dispatch!(execution.level, simd => simd.vectorize(
        #[inline(always)]
        || SphericalRays::new(simd, (ray_grid, first_column), azimuth, elevation, tables)
    ))
}

/// Makes lanes without a ray hit nothing, by setting their limit to 0 m.
fn leave_out(rays: &Rays<'_>, rows: [i32; 2], target: &mut Target<'_>) {
    let ray_grid = rays.ray_grid();
    let across = ray_grid.blocks_across();
    let first_row = (rows[0] >> ray_grid.shift_y) as usize;
    for block in 0..target.inverse.len() {
        let mut lanes = rays.missing(block % across, first_row + block / across);
        if lanes == 0 {
            continue;
        }
        while lanes != 0 {
            target.inverse[block][lanes.trailing_zeros() as usize] = f32::INFINITY;
            lanes &= lanes - 1;
        }
        target.farthest[block] = least(target.inverse[block]);
    }
}

/// Calls [`BandWork::finish`]. It is separate from [`draw`], so that the stack does not hold the variables of both.
#[inline(never)]
fn finish<S: Simd, O, W: BandWork<O>>(simd: S, band: &Band<'_>, output: &mut O, work: &W) {
    simd.vectorize(
        #[inline(always)]
        || work.finish(simd, band, output),
    );
}

/// Calls [`walk`], compiled once for each kind of grid and SIMD level, independent of how the band is processed
/// afterwards.
#[inline(never)]
fn draw<S: Simd, P: Projection>(
    simd: S,
    view: &View<'_>,
    projection: P,
    rows: [i32; 2],
    sight: &Sight,
    target: &mut Target<'_>,
) {
    simd.vectorize(
        #[inline(always)]
        || walk(simd, view, projection, rows, sight.faces, sight.range, target),
    );
}
