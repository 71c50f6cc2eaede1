//! The second pass over a frame: what the device makes of what is seen.

use super::rows::{millimetres, write_xyz};
use super::seen::Seen;
use super::{DepthCamera, POINT_STEP};
use crate::device::depth::DepthDevice;
use crate::execution::{Execution, SplitRows, for_each_row, split_at};
use crate::noise::{Stream, normal_lines};
use crate::optics::rays::Rays;
use crate::simd::{WIDTH, dispatch};
use crate::trace::tiling::{BLOCKS, Tiling};
use fearless_simd::{Simd, SimdBase, SimdFloat, f32x16, i32x16};

/// Rows of pixels whose random numbers are drawn together.
const LINES: usize = Tiling::Square.size()[1];
/// Rows of tiles that one thread takes at a time.
const CHUNK: usize = 8;

const ACROSS: [f32; WIDTH] =
    [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0];

/// Where measured depths go, cut between rows of pixels.
pub(super) struct Measured<'a> {
    pub(super) depth_32fc1: Option<&'a mut [f32]>,
    pub(super) depth_16uc1: Option<&'a mut [u16]>,
    /// Points, of which coordinates are written and nothing else.
    pub(super) points: Option<&'a mut [u8]>,
    /// Pixels across.
    pub(super) width: usize,
}

impl SplitRows for Measured<'_> {
    fn split_rows(self, chunks: usize) -> (Self, Self) {
        let width = self.width;
        let pixels = chunks * CHUNK * LINES * width;
        let (depth_32fc1, lower_32fc1) = split_at(self.depth_32fc1, pixels);
        let (depth_16uc1, lower_16uc1) = split_at(self.depth_16uc1, pixels);
        let (points, lower_points) = split_at(self.points, pixels * POINT_STEP);
        (
            Self { depth_32fc1, depth_16uc1, points, width },
            Self { depth_32fc1: lower_32fc1, depth_16uc1: lower_16uc1, points: lower_points, width },
        )
    }
}

/// Makes a frame of what is seen.
pub(super) struct Developer<'a> {
    pub(super) camera: &'a DepthCamera<'a>,
    pub(super) device: &'a DepthDevice,
    pub(super) rays: Rays<'a>,
    /// Number of the frame.
    pub(super) frame: u64,
    pub(super) seen: Seen<'a>,
}

impl Developer<'_> {
    pub(super) fn develop(&self, execution: Execution, output: Measured<'_>) {
        let [_, height] = self.camera.camera.size();
        let chunks = height.div_ceil(CHUNK * LINES);
        for_each_row(execution, 0..chunks, output, &|chunk, mut output: Measured<'_>| {
            dispatch!(execution.level, simd => simd.vectorize(
                #[inline(always)]
                || self.chunk(simd, chunk, &mut output)
            ));
        });
    }

    fn stream(&self, channel: u16) -> Stream {
        let camera = &self.camera.config.camera;
        Stream { seed: camera.seed, sensor: camera.sensor, frame: self.frame, channel }
    }

    #[inline(always)]
    fn chunk<S: Simd>(&self, simd: S, chunk: usize, output: &mut Measured<'_>) {
        let [width, height] = self.camera.camera.size();
        let first_row = chunk * CHUNK * LINES;
        let rows = first_row..height.min(first_row + CHUNK * LINES);
        let streams = [Stream::DEPTH, Stream::SHIFT, Stream::SHIFT + 1].map(|channel| self.stream(channel));
        let is_noisy = self.device.is_noisy();
        for tile_row in rows.clone().step_by(LINES) {
            for tile in 0..Tiling::Square.across(width) {
                let samples = Tiling::Square.samples(width, [tile, tile_row / LINES]);
                let nothing = [f32x16::splat(simd, 0.0); BLOCKS];
                let (mut noise, mut right, mut down) = (nothing, nothing, nothing);
                if is_noisy {
                    noise = normal_lines(simd, &streams[0], samples);
                }
                if self.device.lateral().is_some() {
                    right = normal_lines(simd, &streams[1], samples);
                    down = normal_lines(simd, &streams[2], samples);
                }
                for line in 0..LINES.min(rows.end - tile_row) {
                    let (column, row) = (tile * WIDTH, tile_row + line);
                    let count = WIDTH.min(width - column);
                    let at = row * width + column;
                    let [mut truth, mut cosines] = load(simd, &self.seen.0[at..at + count]);
                    if let Some(shift) = self.device.lateral() {
                        let stddevs = shift.stddevs(simd, cosines);
                        let offset = [stddevs * right[line], stddevs * down[line]];
                        [truth, cosines] = self.beside(simd, [column, row], offset);
                    }
                    let noisy = self.device.measure(simd, truth, cosines, noise[line]);
                    let depths = self.camera.limited(simd, truth, noisy);
                    self.write(simd, depths, [column, row, count], first_row, output);
                }
            }
        }
    }

    /// What sixteen pixels from one on see so far to the right and down of their own rays: depths and cosines.
    #[inline(always)]
    fn beside<S: Simd>(
        &self,
        simd: S,
        [column, row]: [usize; 2],
        [right, down]: [f32x16<S>; 2],
    ) -> [f32x16<S>; 2] {
        let [width, height] = self.camera.camera.size();
        let x = f32x16::load_array_ref(simd, &ACROSS) + (right + column as f32);
        let columns = whole(simd, x, width);
        let rows = whole(simd, down + row as f32, height);
        let pixels: [i32; WIDTH] = (rows * width as i32 + columns).into();
        let mut seen = [[0.0; 2]; WIDTH];
        for lane in 0..WIDTH {
            seen[lane] = self.seen.0[pixels[lane] as u32 as usize];
        }
        load(simd, &seen)
    }

    /// Writes the depths of some pixels of a row into a part of the frame that begins with `first_row`.
    #[inline(always)]
    fn write<S: Simd>(
        &self,
        simd: S,
        depths: f32x16<S>,
        [column, row, count]: [usize; 3],
        first_row: usize,
        output: &mut Measured<'_>,
    ) {
        let first = (row - first_row) * output.width + column;
        if let Some(output) = &mut output.depth_32fc1 {
            let shown: [f32; WIDTH] = self.camera.shown(simd, depths).into();
            output[first..first + count].copy_from_slice(&shown[..count]);
        }
        let depths: [f32; WIDTH] = depths.into();
        if let Some(output) = &mut output.depth_16uc1 {
            output[first..first + count].copy_from_slice(&millimetres(&depths)[..count]);
        }
        if let Some(points) = &mut output.points {
            let points = points[first * POINT_STEP..][..count * POINT_STEP].chunks_exact_mut(POINT_STEP);
            for (lane, point) in points.enumerate() {
                let ray = self.rays.direction((column + lane) as i32, row as i32);
                write_xyz(point, ray, depths[lane]);
            }
        }
    }
}

/// The nearest whole numbers from 0 on, and below a size.
#[inline(always)]
fn whole<S: Simd>(simd: S, values: f32x16<S>, size: usize) -> i32x16<S> {
    let (zero, last) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, (size - 1) as f32));
    values.max(zero).min(last).round_ties_even().to_int()
}

/// Up to sixteen depths and cosines; 0 in the lanes beyond.
#[inline(always)]
fn load<S: Simd>(simd: S, seen: &[[f32; 2]]) -> [f32x16<S>; 2] {
    if let Some(seen) = seen.as_flattened().first_chunk::<{ 2 * WIDTH }>() {
        let [first, second] = [0, 1].map(|half| f32x16::from_slice(simd, &seen[half * WIDTH..][..WIDTH]));
        let (depths, cosines) = simd.deinterleave_f32x16(first, second);
        return [depths, cosines];
    }
    let (mut depths, mut cosines) = ([0.0; WIDTH], [0.0; WIDTH]);
    for (lane, &[depth, cosine]) in seen.iter().enumerate().take(WIDTH) {
        (depths[lane], cosines[lane]) = (depth, cosine);
    }
    [f32x16::load_array(simd, depths), f32x16::load_array(simd, cosines)]
}
