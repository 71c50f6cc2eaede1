//! The dots of structured light in a frame: their places, and the disparities at which they are found.

use super::look::{CHUNK, LINES, Looker};
use crate::device::depth_model::{DepthDevice, Dots, Look, dot, find_dot, squares};
use crate::execution::{Execution, SplitRows, for_each_row};
use crate::memory::{Cutter, lines};
use crate::noise::Stream;
use crate::simd::{WIDTH, dispatch};
use crate::trace::grid::tiling::Tiling;
use fearless_simd::{Select, Simd, SimdBase, f32x16};

/// The dots of a frame, and the disparities at which they are found.
#[derive(Clone, Copy)]
pub(super) struct DotPattern<'a> {
    dots: Dots,
    size: [usize; 2],
    /// Column and row of the dot of each square.
    places: &'a [[u16; 2]],
    /// The disparity of each dot; 0 if the dot is not found.
    found: &'a [f32],
}

/// An output split into pieces of `piece` values.
struct Chunks<'a, T> {
    values: &'a mut [T],
    piece: usize,
}

impl<T: Send> SplitRows for Chunks<'_, T> {
    fn split_rows(self, pieces: usize) -> (Self, Self) {
        let (upper, lower) = self.values.split_at_mut((pieces * self.piece).min(self.values.len()));
        (Self { values: upper, piece: self.piece }, Self { values: lower, piece: self.piece })
    }
}

impl<'a> DotPattern<'a> {
    /// Returns the number of cache lines that a frame needs.
    pub(super) fn workspace_len(size: [usize; 2]) -> usize {
        let (pixels, squares) = (size.iter().product::<usize>(), squares(size).iter().product::<usize>());
        lines(pixels * size_of::<f32>())
            + lines(squares * size_of::<[u16; 2]>())
            + lines(squares * size_of::<f32>())
    }

    /// Finds the dots of a frame, if the device measures by dots.
    pub(super) fn find(
        looker: &Looker<'_>,
        device: &DepthDevice,
        execution: Execution,
        memory: &mut Cutter<'a>,
    ) -> Option<Self> {
        let Look::Dots(dots) = device.look else { return None };
        let size @ [width, height] = looker.size;
        let [across, down] = squares(size);
        let disparity: &mut [f32] = memory.take(width * height);
        let places: &mut [[u16; 2]] = memory.take(across * down);
        let found: &mut [f32] = memory.take(across * down);

        let chunks = Chunks { values: &mut *disparity, piece: CHUNK * width };
        for_each_row(execution, 0..height.div_ceil(CHUNK), chunks, &|chunk, output: Chunks<'_, f32>| {
            dispatch!(execution.level, simd => simd.vectorize(
                #[inline(always)]
                || disparities(simd, looker, (device, dots), chunk, output.values)
            ));
        });
        let pattern = Stream { frame: 0, ..looker.stream(Stream::DOTS) };
        let rows = Chunks { values: &mut *places, piece: across };
        for_each_row(execution, 0..down, rows, &|y, output: Chunks<'_, [u16; 2]>| {
            for (x, place) in output.values.iter_mut().enumerate() {
                *place = dot(&pattern, across, [x, y]).map(|at| at as u16);
            }
        });
        let (disparity, places) = (&*disparity, &*places);
        let rows = Chunks { values: &mut *found, piece: across };
        for_each_row(execution, 0..down, rows, &|y, output: Chunks<'_, f32>| {
            for (place, found) in places[y * across..].iter().zip(output.values) {
                *found = find_dot(place.map(usize::from), size, places, disparity);
            }
        });
        Some(Self { dots, size, places, found })
    }

    /// Returns the depths of up to sixteen pixels of a row.
    #[inline(always)]
    pub(super) fn depths<S: Simd>(&self, simd: S, [column, row, count]: [usize; 3]) -> f32x16<S> {
        let mut depths = [0.0; WIDTH];
        for (lane, depth) in depths.iter_mut().enumerate().take(count) {
            *depth = self.dots.depth([column + lane, row], self.size, self.places, self.found);
        }
        f32x16::load_array(simd, depths)
    }
}

/// Computes the disparities of some rows of a picture before dots are searched; 0 where there is no depth.
#[inline(always)]
fn disparities<S: Simd>(
    simd: S,
    looker: &Looker<'_>,
    (device, dots): (&DepthDevice, Dots),
    chunk: usize,
    output: &mut [f32],
) {
    let [width, height] = looker.size;
    let (first_row, end_row) = (chunk * CHUNK, height.min((chunk + 1) * CHUNK));
    for tile_row in (first_row..end_row).step_by(LINES) {
        for tile in 0..Tiling::Square.across(width) {
            let samples = Tiling::Square.samples(width, [tile, tile_row / LINES]);
            let offsets = looker.offsets(simd, device, samples);
            for line in 0..LINES.min(end_row - tile_row) {
                let [column, row, count] = [tile * WIDTH, tile_row + line, WIDTH.min(width - tile * WIDTH)];
                let [depths, _] = looker.look(simd, device, [column, row, count], (&offsets, line));
                let is_there = depths.abs().simd_lt(f32x16::splat(simd, f32::INFINITY));
                let disparity = f32x16::splat(simd, dots.disparity_at_1m) / depths;
                let disparity: [f32; WIDTH] = is_there.select(disparity, f32x16::splat(simd, 0.0)).into();
                let first = (row - first_row) * width + column;
                output[first..first + count].copy_from_slice(&disparity[..count]);
            }
        }
    }
}
