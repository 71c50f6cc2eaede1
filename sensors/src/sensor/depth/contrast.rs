//! Brightness of pixels and its contrast, by which a stereo camera matches them.

use crate::device::LUMA;
use crate::device::depth_model::{Matcher, REACH};
use crate::memory::{Cutter, lines};
use crate::shade::Colours;
use crate::simd::WIDTH;
use fearless_simd::{Select, Simd, SimdBase, f32x16, mask32x16};

/// The number of pixels to each side of a pixel that its window needs: its reach, and one more for the differences.
const BESIDE: usize = REACH + 1;

/// The brightnesses of a frame in the workspace, in row-major order, each 0 … 1.
pub(super) struct Brightness<'a>(pub(super) &'a mut [f32]);

impl<'a> Brightness<'a> {
    /// Returns the number of cache lines for this number of pixels.
    pub(super) const fn workspace_len(pixels: usize) -> usize {
        lines(pixels * size_of::<f32>())
    }

    pub(super) fn new(pixels: usize, memory: &mut Cutter<'a>) -> Self {
        Self(memory.take(pixels))
    }

    /// Writes the brightnesses of `count` lanes of a tile, beginning at the pixel `first`.
    #[inline(always)]
    pub(super) fn write(&mut self, colours: &Colours, lane: usize, (first, count): (usize, usize)) {
        for (x, value) in self.0[first..first + count].iter_mut().enumerate() {
            let [red, green, blue] = [0, 1, 2].map(|channel| colours[channel][lane + x]);
            let light = red * LUMA[0] + green * LUMA[1] + blue * LUMA[2];
            // NaN becomes dark.
            *value = if light > 0.0 { light.min(1.0) } else { 0.0 };
        }
    }
}

/// The data by which pixels are matched.
#[derive(Clone, Copy)]
pub(super) struct Contrast<'a> {
    pub(super) matcher: Matcher,
    pub(super) brightness: &'a [f32],
    pub(super) size: [usize; 2],
}

impl Contrast<'_> {
    /// Returns which of up to sixteen pixels of a row are matched, and the factor by which their noise grows.
    ///
    /// `seen` holds their depths, and their cosines of incidence relative to those of a plane parallel to the picture;
    /// `normals` holds a standard normal number for each. Pixels without a depth count as matched.
    #[inline(always)]
    pub(super) fn find<S: Simd>(
        &self,
        simd: S,
        place: [usize; 3],
        seen: [f32x16<S>; 2],
        normals: f32x16<S>,
    ) -> (mask32x16<S>, f32x16<S>) {
        let (is_found, noisier) = self.matcher.find(simd, self.squares(simd, place), seen, normals);
        let has_none = !seen[0].abs().simd_lt(f32x16::splat(simd, f32::INFINITY));
        (is_found | has_none, has_none.select(f32x16::splat(simd, 1.0), noisier))
    }

    /// Sums squared differences between the left and right neighbours over the windows of some pixels of a row. Outside
    /// the picture, its edge pixels are repeated.
    #[inline(always)]
    fn squares<S: Simd>(&self, simd: S, [column, row, count]: [usize; 3]) -> f32x16<S> {
        let [width, height] = self.size;
        let mut sum = f32x16::splat(simd, 0.0);
        for y in 0..=2 * REACH {
            let line = (row + y).saturating_sub(REACH).min(height - 1);
            let line = &self.brightness[line * width..][..width];
            let mut values = [0.0; WIDTH + 2 * BESIDE];
            match column.checked_sub(BESIDE).and_then(|first| line.get(first..first + values.len())) {
                Some(inside) => values.copy_from_slice(inside),
                None => {
                    for (x, value) in values.iter_mut().enumerate().take(count + 2 * BESIDE) {
                        *value = line[(column + x).saturating_sub(BESIDE).min(width - 1)];
                    }
                }
            }
            for x in 0..=2 * REACH {
                let [left, right] =
                    [x, x + 2].map(|first| f32x16::from_slice(simd, &values[first..first + WIDTH]));
                let difference = right - left;
                sum += difference * difference;
            }
        }
        sum
    }
}
