//! The second pass over a frame: applies the device model to true depths.

use super::borders::{Borders, MOST_ROWS};
use super::contrast::Contrast;
use super::look::{CHUNK, LINES, Looker, load};
use super::pattern::DotPattern;
use super::rows::{Places, millimetres};
use super::{DepthCamera, POINT_STEP};
use crate::device::depth_model::{DepthDevice, Sampling};
use crate::execution::{Execution, SplitRows, for_each_row, split_at};
use crate::noise::{Stream, normal_lines};
use crate::simd::{WIDTH, dispatch};
use crate::trace::grid::tiling::{BLOCKS, Tiling};
use fearless_simd::{Select, Simd, SimdBase, f32x16};

/// The outputs of measured depths, split between rows of pixels.
pub(super) struct Measured<'a> {
    pub(super) depth_32fc1: Option<&'a mut [f32]>,
    pub(super) depth_16uc1: Option<&'a mut [u16]>,
    /// The point cloud, of which only coordinates are written.
    pub(super) points: Option<&'a mut [u8]>,
    pub(super) xyz: Option<&'a mut [[f32; 3]]>,
    /// The width of the picture.
    pub(super) width: usize,
}

impl SplitRows for Measured<'_> {
    fn split_rows(self, chunks: usize) -> (Self, Self) {
        let width = self.width;
        let pixels = chunks * CHUNK * width;
        let (depth_32fc1, lower_32fc1) = split_at(self.depth_32fc1, pixels);
        let (depth_16uc1, lower_16uc1) = split_at(self.depth_16uc1, pixels);
        let (points, lower_points) = split_at(self.points, pixels * POINT_STEP);
        let (xyz, lower_xyz) = split_at(self.xyz, pixels);
        (
            Self { depth_32fc1, depth_16uc1, points, xyz, width },
            Self {
                depth_32fc1: lower_32fc1,
                depth_16uc1: lower_16uc1,
                points: lower_points,
                xyz: lower_xyz,
                width,
            },
        )
    }
}

const _: () = assert!(CHUNK <= MOST_ROWS * LINES);

/// Computes measured depths from the true ones.
pub(super) struct Developer<'a> {
    pub(super) camera: &'a DepthCamera<'a>,
    pub(super) device: &'a DepthDevice,
    pub(super) looker: Looker<'a>,
    /// The projected dots that were found, if the device measures by dots.
    pub(super) pattern: Option<DotPattern<'a>>,
    /// The contrast by which the second eye matches pixels, if the device models it.
    pub(super) contrast: Option<Contrast<'a>>,
}

impl Developer<'_> {
    pub(super) fn develop(&self, execution: Execution, output: Measured<'_>) {
        let [_, height] = self.looker.size;
        for_each_row(execution, 0..height.div_ceil(CHUNK), output, &|chunk, mut output: Measured<'_>| {
            dispatch!(execution.level, simd => simd.vectorize(
                #[inline(always)]
                || self.chunk(simd, chunk, &mut output)
            ));
        });
    }

    #[inline(always)]
    fn chunk<S: Simd>(&self, simd: S, chunk: usize, output: &mut Measured<'_>) {
        let [width, height] = self.looker.size;
        let (first_row, end_row) = (chunk * CHUNK, height.min((chunk + 1) * CHUNK));
        let stream = self.looker.stream(Stream::DEPTH);
        let is_noisy = self.device.is_noisy();
        let looks_at_edges = self.device.look.shift().is_some_and(|shift| shift.sampling == Sampling::Edges);
        let tile_rows = first_row / LINES..end_row.div_ceil(LINES);
        let ends =
            (looks_at_edges && self.pattern.is_none()).then(|| Borders::find(simd, &self.looker, tile_rows));
        for tile_row in (first_row..end_row).step_by(LINES) {
            for tile in 0..Tiling::Square.across(width) {
                let samples = Tiling::Square.samples(width, [tile, tile_row / LINES]);
                let mut noise = [f32x16::splat(simd, 0.0); BLOCKS];
                if is_noisy {
                    noise = normal_lines(simd, &stream, samples);
                }
                let mut found_by = [f32x16::splat(simd, 0.0); BLOCKS];
                if self.contrast.is_some() {
                    found_by = normal_lines(simd, &self.looker.stream(Stream::MATCH), samples);
                }
                let mut offsets = None;
                if ends.as_ref().is_none_or(|ends| ends.are_near([tile, tile_row / LINES])) {
                    offsets = self.looker.offsets(simd, self.device, samples);
                }
                for line in 0..LINES.min(end_row - tile_row) {
                    let place = [tile * WIDTH, tile_row + line, WIDTH.min(width - tile * WIDTH)];
                    let [mut truth, cosines] = match &self.pattern {
                        Some(pattern) => {
                            let at = place[1] * width + place[0];
                            let [_, cosines] = load(simd, &self.looker.seen[at..at + place[2]]);
                            [pattern.depths(simd, place), cosines]
                        }
                        None => self.looker.look(simd, self.device, place, (&offsets, line)),
                    };
                    if let Some(contrast) = &self.contrast {
                        let seen = [truth, cosines / self.looker.forward(simd, place)];
                        let (is_found, noisier) = contrast.find(simd, place, seen, found_by[line]);
                        truth = is_found.select(truth, truth + f32x16::splat(simd, f32::NAN));
                        noise[line] *= noisier;
                    }
                    let noisy = self.device.measure(simd, truth, cosines, noise[line]);
                    let depths = self.camera.limited(simd, truth, noisy);
                    self.write(simd, depths, place, first_row, output);
                }
            }
        }
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
        if let Some(output) = &mut output.depth_16uc1 {
            output[first..first + count].copy_from_slice(&millimetres(simd, depths)[..count]);
        }
        if output.points.is_none() && output.xyz.is_none() {
            return;
        }
        let places = Places::new(simd, &self.looker.rays, [column, row], depths);
        if let Some(points) = &mut output.points {
            places.write_places(&mut points[first * POINT_STEP..][..count * POINT_STEP]);
        }
        if let Some(xyz) = &mut output.xyz {
            places.write(&mut xyz[first..][..count]);
        }
    }
}
