//! Frames of rays from one point, band by band.

use super::bands::Bands;
use super::error::SenseError;
use super::image::{Target, walk};
use super::memory::view_lines;
use super::packet::Faces;
use super::view::{View, ViewMemory, check_moment};
use crate::execution::{Execution, SplitRows, for_each_row};
use crate::memory::{Cutter, lines};
use crate::moment::{Shutter, Slice};
use crate::optics::rays::{Fan, PinholeFan, Projection, Rays, SphericalFan, Steps, TableFan, each};
use crate::optics::{Optics, SphericalGrid};
use crate::scene::Scene;
use crate::simd::WIDTH;
use fearless_simd::{Simd, dispatch};

/// What counts as seen.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sight {
    pub(crate) faces: Faces,
    /// Least and most t.
    pub(crate) range: [f64; 2],
    /// Nothing is traced where no surface comes within so many metres of the sensor.
    pub(crate) within: f64,
}

/// What is done with each band once it has been traced.
pub(crate) trait BandWork<O>: Sync {
    /// Works on a band of traced rays, inside `simd.vectorize`. `output` is cut by rows of blocks; it begins with the
    /// band's [`first_row`](Band::first_row).
    fn finish<S: Simd>(&self, simd: S, band: &Band<'_>, output: &mut O);

    /// Whether lines are wanted from every slice that has them, and not from the first alone.
    fn is_mean(&self) -> bool {
        false
    }
}

/// A traced band of a grid, or the part of it that is taken at one moment.
pub(crate) struct Band<'a> {
    pub(crate) view: &'a View<'a>,
    pub(crate) rays: Rays<'a>,
    /// First and last row of the grid.
    pub(crate) rows: [i32; 2],
    /// The row that the output begins with.
    pub(crate) first_row: i32,
    /// Rows from here on are in no slice before this one.
    pub(crate) fresh_from: i32,
    /// Rows from here on are in a later slice, too.
    pub(crate) open_from: i32,
    pub(crate) target: Target<'a>,
}

impl Band<'_> {
    /// First and last row of blocks.
    pub(crate) fn block_rows(&self) -> core::ops::RangeInclusive<usize> {
        let shift = self.rays.fan().shift_y;
        (self.rows[0] >> shift) as usize..=(self.rows[1] >> shift) as usize
    }

    /// A row of blocks, counted from the first of the output.
    #[inline(always)]
    pub(crate) fn row_in_output(&self, block_row: usize) -> usize {
        block_row - (self.first_row >> self.rays.fan().shift_y) as usize
    }
}

/// A frame to be traced: its rays, and where everything is when they are cast.
pub(crate) struct Frame<'a> {
    optics: &'a Optics<'a>,
    fan: Fan,
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

/// The blocks that the rays of a frame are traced in: such that each lies in one slice.
fn fan_of(optics: &Optics<'_>, shutter: &Shutter<'_>) -> Result<Fan, SenseError> {
    let fan = optics.fan();
    let height = fan.height as u32;
    let mask = (1 << fan.shift_y) - 1;
    let cuts = |line: u32| line & mask != 0 && line != height;
    match shutter.slices().iter().position(|slice| cuts(slice.lines.start) || cuts(slice.lines.end)) {
        None => Ok(fan),
        Some(slice) if matches!(optics, Optics::Table(_)) => Err(SenseError::Slices {
            slice,
            rule: "begin and end at multiples of four lines, as the table of rays is in blocks of 4 × 4",
        }),
        Some(_) => Ok(fan.by_rows()),
    }
}

/// That there is a moment for each of so many lines, with all poses.
pub(crate) fn check_shutter(scene: &Scene<'_>, shutter: &Shutter<'_>, height: u32) -> Result<(), SenseError> {
    let slices = match shutter {
        Shutter::Global(moment) => return check_moment(scene, moment),
        Shutter::Slices(slices) => *slices,
    };
    let (mut start, mut end) = (0, 0);
    for (slice, Slice { lines, at }) in slices.iter().enumerate() {
        let wrong = |rule| Err(SenseError::Slices { slice, rule });
        if lines.start >= lines.end || lines.end > height {
            return wrong("have one line at least, and none beyond the frame's");
        }
        if lines.start < start || lines.end < end {
            return wrong("neither begin nor end before the slice before it");
        }
        if lines.start > end {
            return wrong("begin no later than where the lines before it end");
        }
        check_moment(scene, at)?;
        (start, end) = (lines.start, lines.end);
    }
    if end < height {
        return Err(SenseError::Slices { slice: slices.len(), rule: "be there: the last lines are in none" });
    }
    Ok(())
}

impl<'a> Frame<'a> {
    /// Cache lines that it takes to make a frame and to trace it.
    pub(crate) fn workspace_len(scene: &Scene<'_>, optics: &Optics<'_>, shutter: &Shutter<'_>) -> usize {
        if optics.check().is_err() {
            return 0; // and no frame
        }
        let fan = Self::fan_of(optics, shutter);
        let bands = Bands::new(&fan);
        let views = if shutter.slices().is_empty() { 1 } else { bands.count };
        let tables = match optics {
            Optics::Spherical(_) => SphericalFan::table_len(&fan),
            Optics::Pinhole(_) | Optics::Table(_) => 0,
        };
        // 1/t and slots take a line a block each.
        let traced = tables + 2 * bands.blocks + lines(bands.farthest_len(&fan) * size_of::<f32>());
        view_lines(scene.instances().len(), views) + traced
    }

    /// The blocks that the rays are traced in.
    pub(crate) fn fan_of(optics: &Optics<'_>, shutter: &Shutter<'_>) -> Fan {
        // Where it cannot be, nothing will be traced.
        fan_of(optics, shutter).unwrap_or(optics.fan())
    }

    /// Checks rays, shutter and moments, and places what `visibility` lets the sensor see.
    pub(crate) fn new(
        scene: &'a Scene<'a>,
        optics: &'a Optics<'a>,
        shutter: &Shutter<'a>,
        visibility: u32,
        execution: Execution,
        memory: &mut Cutter<'a>,
    ) -> Result<Self, SenseError> {
        optics.check()?;
        let fan = fan_of(optics, shutter)?;
        check_shutter(scene, shutter, fan.height as u32)?;
        let when = match *shutter {
            Shutter::Global(ref moment) => {
                When::Once(View::new(scene, moment, visibility, memory.views(scene.instances().len(), 1)))
            }
            Shutter::Slices(_) => When::Slices { scene, shutter: *shutter, visibility },
        };
        Ok(Self { optics, fan, execution, when })
    }

    pub(crate) fn fan(&self) -> &Fan {
        &self.fan
    }

    /// What all rays see, if it is seen at one moment.
    pub(crate) fn view(&self) -> Option<&View<'a>> {
        match &self.when {
            When::Once(view) => Some(view),
            When::Slices { .. } => None,
        }
    }

    /// Rays of a row of blocks.
    pub(crate) fn rays_in_row(&self) -> usize {
        (self.fan.width as usize) << self.fan.shift_y
    }

    /// False if no surface comes within so many metres of the sensor. True may be said of too much.
    pub(crate) fn may_be_within(&self, radius: f64) -> bool {
        match &self.when {
            When::Once(view) => view.may_be_within(radius),
            When::Slices { .. } => true,
        }
    }

    /// Traces all rays and hands each band to `work`.
    pub(crate) fn trace<O: SplitRows, W: BandWork<O>>(
        &self,
        sight: &Sight,
        memory: &mut Cutter<'_>,
        output: O,
        work: &W,
    ) {
        let fan = self.fan;
        let rays = match self.optics {
            Optics::Pinhole(lens) => Rays::Pinhole(PinholeFan::new(lens, fan)),
            Optics::Spherical(grid) => Rays::Spherical(spherical(grid, fan, self.execution, memory)),
            Optics::Table(table) => Rays::Table(TableFan::new(table)),
        };
        let bands = Bands::new(&fan);
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
            farthest: memory.take(bands.farthest_len(&fan)),
            output,
            farthest_stride: bands.farthest_stride,
            block_rows: bands.block_rows,
            blocks_across: fan.blocks_across(),
        };
        for_each_row(self.execution, 0..bands.count, output, &|band, mut output: BandOutput<'_, O>| {
            let first = (band * bands.block_rows) << fan.shift_y;
            let end = (((band + 1) * bands.block_rows) << fan.shift_y).min(fan.height as usize);
            let first_row = first as i32;
            match &self.when {
                When::Once(view) => {
                    let rows = [first_row, end as i32 - 1];
                    let part = Part { rows, first_row, fresh_from: 0, open_from: i32::MAX };
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
                        let part = Part { rows, first_row, fresh_from: fresh_from as i32, open_from };
                        self.trace_part(&view, &rays, sight, &part, &mut output, work);
                    }
                }
            }
        });
    }

    /// Traces rows of a band that are taken at one moment.
    fn trace_part<O: SplitRows, W: BandWork<O>>(
        &self,
        view: &View<'_>,
        rays: &Rays<'_>,
        sight: &Sight,
        part: &Part,
        output: &mut BandOutput<'_, O>,
        work: &W,
    ) {
        let fan = self.fan;
        let Part { rows, first_row, fresh_from, open_from } = *part;
        let [first, last] = rows.map(|row| (row >> fan.shift_y) as usize);
        let before = (first - (first_row >> fan.shift_y) as usize) * output.blocks_across;
        let blocks = (last - first + 1) * output.blocks_across;
        let mut target = Target {
            inverse: &mut output.inverse[before..][..blocks],
            slot: &mut output.slot[before..][..blocks],
            farthest: &mut output.farthest[..blocks + WIDTH],
        };
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
            let band = Band { view, rays: *rays, rows, first_row, fresh_from, open_from, target };
            simd.vectorize(
                #[inline(always)]
                || work.finish(simd, &band, output),
            );
        });
    }
}

/// Rows of a band, as [`Band`] has them.
struct Part {
    rows: [i32; 2],
    first_row: i32,
    fresh_from: i32,
    open_from: i32,
}

/// The angles of a spinning lidar, with their tables.
fn spherical<'a>(
    grid: &SphericalGrid,
    fan: Fan,
    execution: Execution,
    memory: &mut Cutter<'a>,
) -> SphericalFan<'a> {
    let azimuth = Steps { first: grid.first_azimuth_rad, step: grid.azimuth_step_rad };
    let elevation = Steps { first: grid.first_elevation_rad, step: grid.elevation_step_rad };
    let tables = memory.take(SphericalFan::table_len(&fan));
    dispatch!(execution.level, simd => simd.vectorize(
        #[inline(always)]
        || SphericalFan::new(fan, azimuth, elevation, tables)
    ))
}

/// Sees to it that lanes without a ray hit nothing: nothing is nearer than 0 m.
fn leave_out(rays: &Rays<'_>, rows: [i32; 2], target: &mut Target<'_>) {
    let fan = rays.fan();
    let across = fan.blocks_across();
    let first_row = (rows[0] >> fan.shift_y) as usize;
    for block in 0..target.inverse.len() {
        let mut lanes = rays.missing(block % across, first_row + block / across);
        if lanes == 0 {
            continue;
        }
        while lanes != 0 {
            target.inverse[block][lanes.trailing_zeros() as usize] = f32::INFINITY;
            lanes &= lanes - 1;
        }
        target.update_farthest(block);
    }
}

/// [`walk`], compiled once for each kind of grid and SIMD level, whatever is done with the band afterwards.
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

/// A part of the memory and of the output, cut between bands.
struct BandOutput<'a, O> {
    /// Of one view for each band, if bands make their own.
    views: Option<ViewMemory<'a>>,
    instances: usize,
    inverse: &'a mut [[f32; WIDTH]],
    slot: &'a mut [[u32; WIDTH]],
    farthest: &'a mut [f32],
    output: O,
    farthest_stride: usize,
    block_rows: usize,
    blocks_across: usize,
}

impl<O: SplitRows> SplitRows for BandOutput<'_, O> {
    fn split_rows(self, bands: usize) -> (Self, Self) {
        let Self { instances, farthest_stride, block_rows, blocks_across, .. } = self;
        let (views, views_rest) = self.views.map(|views| views.split(bands, instances)).unzip();
        let blocks = bands * block_rows * blocks_across;
        let (inverse, inverse_rest) = self.inverse.split_at_mut(blocks);
        let (slot, slot_rest) = self.slot.split_at_mut(blocks);
        let (farthest, farthest_rest) = self.farthest.split_at_mut(bands * farthest_stride);
        let (output, output_rest) = self.output.split_rows(bands * block_rows);
        (
            Self {
                views,
                instances,
                inverse,
                slot,
                farthest,
                output,
                farthest_stride,
                block_rows,
                blocks_across,
            },
            Self {
                views: views_rest,
                instances,
                inverse: inverse_rest,
                slot: slot_rest,
                farthest: farthest_rest,
                output: output_rest,
                farthest_stride,
                block_rows,
                blocks_across,
            },
        )
    }
}
