//! Scans of a turning lidar: each slice is a group of columns, with a moment of its own.
//!
//! The columns of a slice form a small grid with the directions of the whole one, which is traced like a scan of one
//! moment. Its beams are first written side by side into the workspace, so that threads share no memory, and are copied
//! to their columns at the end.

use super::{Lidar, LidarBeams, Lines, Scan};
use crate::execution::{Execution, SplitRows, for_each_row};
use crate::memory::{CacheLine, Cutter, lines};
use crate::moment::{Capture, Slice};
use crate::optics::Optics;
use crate::scene::Scene;
use crate::simd::dispatch;
use crate::trace::Truth;
use crate::trace::grid::Frame;
use core::ops::Range;
use fearless_simd::Simd;

/// The largest number of pieces into which slices are divided. Each needs memory for a separate view. Results do not
/// depend on this number.
const MOST_PIECES: usize = 16;

/// The division of a scan's slices into pieces.
struct SlicePlan<'a> {
    lidar: &'a Lidar,
    scene: &'a Scene<'a>,
    optics: Optics<'static>,
    slices: &'a [Slice<'a>],
    /// The number of slices of a piece; the last may have fewer.
    in_piece: usize,
    pieces: usize,
    /// The number of cache lines in which any slice can be traced.
    stride: usize,
}

impl<'a> SlicePlan<'a> {
    fn new(lidar: &'a Lidar, scene: &'a Scene<'a>, slices: &'a [Slice<'a>]) -> Self {
        let in_piece = slices.len().div_ceil(MOST_PIECES).max(1);
        let (optics, pieces) = (lidar.optics(), slices.len().div_ceil(in_piece));
        let mut plan = Self { lidar, scene, optics, slices, in_piece, pieces, stride: 0 };
        for slice in 0..slices.len() {
            let columns = plan.columns(slice);
            if !columns.is_empty() {
                plan.stride = plan.stride.max(Frame::columns_workspace_len(scene, &plan.optics, &columns));
            }
        }
        plan
    }

    /// Returns the columns of a slice that no earlier slice has.
    fn columns(&self, slice: usize) -> Range<u32> {
        self.end_before(slice)..self.slices[slice].lines.end
    }

    /// Returns the number of columns of all slices before this one.
    fn end_before(&self, slice: usize) -> u32 {
        slice.checked_sub(1).map_or(0, |before| self.slices[before].lines.end)
    }

    /// Returns the slices of a piece.
    fn of_piece(&self, piece: usize) -> Range<usize> {
        let end = self.slices.len();
        (piece * self.in_piece).min(end)..((piece + 1) * self.in_piece).min(end)
    }

    fn rows(&self) -> usize {
        self.lidar.config.vertical.samples as usize
    }

    /// Returns the number of beams of all slices before this one.
    fn beams_before(&self, slice: usize) -> usize {
        self.end_before(slice) as usize * self.rows()
    }

    /// Traces the beams of a slice; ranges stay true.
    fn trace(
        &self,
        capture: &Capture<'_>,
        slice: usize,
        execution: Execution,
        memory: &mut [CacheLine],
        scan: Scan<'_>,
    ) {
        let (columns, mut memory) = (self.columns(slice), Cutter(memory));
        let of = (&columns, &self.slices[slice].at);
        let frame = Frame::of_columns(
            self.scene,
            &self.optics,
            of,
            self.lidar.config.visibility,
            execution,
            &mut memory,
        );
        let sight = self.lidar.sight();
        let rows_in_block = 1 << frame.ray_grid().shift_y;
        let lines = Lines { scan, samples: columns.len(), rows_in_block };
        frame.trace(
            &sight,
            &mut memory,
            lines,
            &LidarBeams { lidar: self.lidar, capture, sight, is_whole: false },
        );
    }
}

/// Returns the number of cache lines that a scan needs.
pub(super) fn workspace_len(lidar: &Lidar, scene: &Scene<'_>, slices: &[Slice<'_>]) -> usize {
    let samples = lidar.config.horizontal.samples;
    let ends = || slices.iter().map(|slice| slice.lines.end);
    if ends().any(|end| end > samples) || !ends().is_sorted() {
        return 0; // and no scan
    }
    let plan = SlicePlan::new(lidar, scene, slices);
    let measured = 2 * lines(lidar.beams() * size_of::<f32>());
    plan.pieces * plan.stride + measured + Truth::elsewhere_len(lidar.beams())
}

/// Takes a scan by slices of columns. Slices and outputs must have been checked.
pub(super) fn sense(
    lidar: &Lidar,
    scene: &Scene<'_>,
    (capture, slices): (&Capture<'_>, &[Slice<'_>]),
    execution: Execution,
    memory: &mut Cutter<'_>,
    mut output: Scan<'_>,
) {
    let (plan, beams) = (SlicePlan::new(lidar, scene, slices), lidar.beams());
    let mut traced = Scan {
        ranges: output.ranges.is_some().then(|| memory.take(beams)),
        points: None,
        intensities: output.intensities.is_some().then(|| memory.take(beams)),
        truth: output.truth.as_ref().map(|truth| truth.elsewhere(memory, beams)),
    };
    let memory = memory.take(plan.pieces * plan.stride);
    let pieces = SlicePieces { plan: &plan, next: 0, memory, scan: traced.reborrow() };
    for_each_row(execution, 0..plan.pieces, pieces, &|piece, part: SlicePieces<'_, '_>| {
        let SlicePieces { memory, mut scan, .. } = part;
        for slice in plan.of_piece(piece) {
            let (own, rest) = scan.split_at(plan.columns(slice).len() * plan.rows());
            scan = rest;
            if !plan.columns(slice).is_empty() {
                plan.trace(capture, slice, execution.alone(), memory, own);
            }
        }
    });
    gather(&plan, &traced, &mut output);
    if let Some(ranges) = output.ranges {
        dispatch!(execution.level, simd => simd.vectorize(
            #[inline(always)]
            || lidar.measure_lines(simd, capture.frame, 0, ranges),
        ));
    }
}

/// The memory of some pieces, and the outputs of their beams.
struct SlicePieces<'p, 'a> {
    plan: &'p SlicePlan<'p>,
    /// The number of the first piece.
    next: usize,
    memory: &'a mut [CacheLine],
    scan: Scan<'a>,
}

impl SplitRows for SlicePieces<'_, '_> {
    fn split_rows(self, pieces: usize) -> (Self, Self) {
        let Self { plan, next, .. } = self;
        let from = |piece: usize| plan.beams_before(plan.of_piece(piece).start);
        let (memory, memory_rest) = self.memory.split_at_mut(pieces * plan.stride);
        let (scan, scan_rest) = self.scan.split_at(from(next + pieces) - from(next));
        (
            Self { plan, next, memory, scan },
            Self { plan, next: next + pieces, memory: memory_rest, scan: scan_rest },
        )
    }
}

/// Copies the beams of all slices to their columns.
fn gather(plan: &SlicePlan<'_>, traced: &Scan<'_>, output: &mut Scan<'_>) {
    put(plan, traced.ranges.as_deref(), output.ranges.as_deref_mut());
    put(plan, traced.intensities.as_deref(), output.intensities.as_deref_mut());
    let (Some(traced), Some(output)) = (&traced.truth, &mut output.truth) else { return };
    put(plan, traced.depth.as_deref(), output.depth.as_deref_mut());
    put(plan, traced.range.as_deref(), output.range.as_deref_mut());
    put(plan, traced.normal.as_deref(), output.normal.as_deref_mut());
    put(plan, traced.instance.as_deref(), output.instance.as_deref_mut());
    put(plan, traced.class.as_deref(), output.class.as_deref_mut());
    put(plan, traced.incidence.as_deref(), output.incidence.as_deref_mut());
}

/// Copies one output, if it is requested.
fn put<T: Copy>(plan: &SlicePlan<'_>, traced: Option<&[T]>, output: Option<&mut [T]>) {
    let (Some(traced), Some(output)) = (traced, output) else { return };
    for slice in 0..plan.slices.len() {
        let columns = plan.columns(slice);
        let lines = output.chunks_mut(plan.lidar.config.horizontal.samples as usize);
        let parts = traced[plan.beams_before(slice)..].chunks(columns.len().max(1));
        for (line, part) in lines.zip(parts) {
            line[columns.start as usize..columns.end as usize].copy_from_slice(&part[..columns.len()]);
        }
    }
}
