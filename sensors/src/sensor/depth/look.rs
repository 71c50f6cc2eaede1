//! Sampling of the true depths: along a pixel's own ray, beside it, or as a mixture of light from around it.

use super::surface::is_same_surface;
use crate::device::depth_model::{Around, DepthDevice, FREQUENCIES, Look, ModulatedLight, Sampling};
use crate::noise::{Stream, normal_lines};
use crate::optics::rays::Rays;
use crate::simd::WIDTH;
use crate::trace::grid::tiling::{BLOCKS, Tiling};
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, f32x16, i32x16};

/// Rows of pixels whose random numbers are drawn together.
pub(super) const LINES: usize = Tiling::Square.size()[1];
/// Rows of pixels that a thread takes at a time.
pub(super) const CHUNK: usize = 8 * LINES;

const ACROSS: [f32; WIDTH] =
    [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0];

/// Standard normal numbers for the four lines of a tile. For lateral noise they are offsets to the right and down; for
/// time of flight there is one for each modulation frequency.
pub(super) type Offsets<S> = Option<[[f32x16<S>; BLOCKS]; FREQUENCIES]>;

/// The true depths of a frame, and the rays of its pixels.
#[derive(Clone, Copy)]
pub(super) struct Looker<'a> {
    pub(super) rays: Rays<'a>,
    /// Width and height of the picture.
    pub(super) size: [usize; 2],
    /// The angle from one pixel to the next in the middle of the picture, in radians.
    pub(super) pixel_rad: f32,
    /// Seed, sensor and frame of the random numbers.
    pub(super) numbers: Stream,
    /// Depths (ranges for time of flight) and cosines of incidence.
    pub(super) seen: &'a [[f32; 2]],
}

impl<'a> Looker<'a> {
    /// Creates a looker. `numbers` holds the seed, sensor and frame of its random numbers.
    pub(super) fn new(rays: &Rays<'a>, size: [usize; 2], numbers: Stream, seen: &'a [[f32; 2]]) -> Self {
        let middle = size.map(|size| size as i32 / 2);
        let step = rays.neighbours(middle[0], middle[1]).steps()[0];
        Self { rays: *rays, size, pixel_rad: step.length() as f32, numbers, seen }
    }

    pub(super) fn stream(&self, channel: u16) -> Stream {
        Stream { channel, ..self.numbers }
    }

    /// Draws the random numbers for the lines of a tile, if the device needs any.
    #[inline(always)]
    pub(super) fn offsets<S: Simd>(
        &self,
        simd: S,
        device: &DepthDevice,
        samples: [u32; BLOCKS],
    ) -> Offsets<S> {
        let mut numbers = [[f32x16::splat(simd, 0.0); BLOCKS]; FREQUENCIES];
        let (first, count) = if device.has_noisy_phases() {
            (Stream::PHASE, FREQUENCIES)
        } else {
            device.look.shift()?;
            (Stream::SHIFT, 2)
        };
        for index in 0..count {
            numbers[index] = normal_lines(simd, &self.stream(first + index as u16), samples);
        }
        Some(numbers)
    }

    /// Returns the true depths, and the cosines of incidence there, of up to sixteen pixels of a row. They are given by
    /// the column and row of the first, and their number.
    #[inline(always)]
    pub(super) fn look<S: Simd>(
        &self,
        simd: S,
        device: &DepthDevice,
        [column, row, count]: [usize; 3],
        (offsets, line): (&Offsets<S>, usize),
    ) -> [f32x16<S>; 2] {
        let look = &device.look;
        if let Look::Light(light) = look {
            return self.light(simd, (device, *light), [column, row, count], (offsets, line));
        }
        let at = row * self.size[0] + column;
        let [depths, cosines] = load(simd, &self.seen[at..at + count]);
        let (Some(shift), Some([right, down, _])) = (look.shift(), offsets) else { return [depths, cosines] };
        let stddevs = shift.stddevs(simd, cosines);
        let x = f32x16::load_array_ref(simd, &ACROSS) + (stddevs * right[line] + column as f32);
        let y = stddevs * down[line] + row as f32;
        match shift.sampling {
            Sampling::Nearest => self.nearest(simd, [x, y])[0],
            Sampling::Bilinear => self.between(simd, [x, y]),
            Sampling::Edges => {
                let [beside, [columns, rows]] = self.nearest(simd, [x, y]);
                let right = columns - (f32x16::load_array_ref(simd, &ACROSS) + column as f32);
                let apart = (right.abs() + (rows - row as f32).abs()) * self.steps(simd);
                let is_same = is_same_surface(simd, [depths, cosines], beside, apart);
                [is_same.select(depths, beside[0]), is_same.select(cosines, beside[1])]
            }
        }
    }

    /// Returns the angle from one pixel to the next, in radians.
    #[inline(always)]
    pub(super) fn steps<S: Simd>(&self, simd: S) -> f32x16<S> {
        f32x16::splat(simd, self.pixel_rad)
    }

    /// Returns the depths and cosines at the pixels nearest to these places in the picture, and the columns and rows of
    /// these pixels.
    #[inline(always)]
    fn nearest<S: Simd>(&self, simd: S, [x, y]: [f32x16<S>; 2]) -> [[f32x16<S>; 2]; 2] {
        let [width, height] = self.size;
        let columns = inside(simd, x, width).round_ties_even();
        let rows = inside(simd, y, height).round_ties_even();
        let first = rows.to_int::<i32x16<S>>() * width as i32;
        let pixels: [i32; WIDTH] = (first + columns.to_int::<i32x16<S>>()).into();
        let mut seen = [[0.0; 2]; WIDTH];
        for lane in 0..WIDTH {
            seen[lane] = self.seen[pixels[lane] as u32 as usize];
        }
        [load(simd, &seen), [columns, rows]]
    }

    /// Interpolates depths bilinearly between the four rays around; the cosines are those of the nearest.
    #[inline(always)]
    fn between<S: Simd>(&self, simd: S, [x, y]: [f32x16<S>; 2]) -> [f32x16<S>; 2] {
        let [width, height] = self.size;
        let [[depths, cosines], _] = self.nearest(simd, [x, y]);
        let x: [f32; WIDTH] = inside(simd, x, width).into();
        let y: [f32; WIDTH] = inside(simd, y, height).into();
        let mut depths: [f32; WIDTH] = depths.into();
        for lane in 0..WIDTH {
            let (left, top) = (x[lane] as usize, y[lane] as usize);
            let (right, bottom) = ((left + 1).min(width - 1), (top + 1).min(height - 1));
            let across = x[lane] - left as f32;
            let along = |row: usize| {
                let [a, b] = [left, right].map(|column| self.seen[row * width + column][0]);
                a + (b - a) * across
            };
            let (above, below) = (along(top), along(bottom));
            let depth = above + (below - above) * (y[lane] - top as f32);
            if depth.is_finite() {
                depths[lane] = depth;
            }
        }
        [f32x16::load_array(simd, depths), cosines]
    }

    /// Returns the depths that time of flight measures from light that mixes over neighbouring pixels, and the cosines
    /// of the pixels themselves.
    #[inline(always)]
    fn light<S: Simd>(
        &self,
        simd: S,
        (device, light): (&DepthDevice, ModulatedLight),
        [column, row, count]: [usize; 3],
        (offsets, line): (&Offsets<S>, usize),
    ) -> [f32x16<S>; 2] {
        let [width, height] = self.size;
        // No light comes from outside the picture.
        let mut values = [[[f32::INFINITY; WIDTH + 2]; 2]; 3];
        for (y, values) in values.iter_mut().enumerate() {
            let Some(row) = (row + y).checked_sub(1).filter(|row| *row < height) else { continue };
            for x in 0..count + 2 {
                if let Some(column) = (column + x).checked_sub(1).filter(|column| *column < width) {
                    let [range, cosine] = self.seen[row * width + column];
                    (values[0][x], values[1][x]) = (range, cosine);
                }
            }
        }
        let vector =
            |y: usize, what: usize, x: usize| f32x16::from_slice(simd, &values[y][what][x..x + WIDTH]);
        let mut around: Around<S> = [[[f32x16::splat(simd, 0.0); 2]; 3]; 3];
        for y in 0..3 {
            for x in 0..3 {
                around[y][x] = [vector(y, 0, x), vector(y, 1, x)];
            }
        }
        let forward = self.forward(simd, [column, row, count]);
        let [range, cosine] = around[1][1];
        let mut noise = (f32x16::splat(simd, 0.0), [f32x16::splat(simd, 0.0); FREQUENCIES]);
        if let Some(numbers) = offsets {
            let stddevs = device.phase_stddevs(simd, range * forward, cosine);
            noise = (stddevs / forward, numbers.map(|lines| lines[line]));
        }
        [light.ranges(simd, &around, noise) * forward, cosine]
    }

    /// Returns the ratio of depth to range of some pixels of a row; 1 in the lanes beyond them.
    #[inline(always)]
    pub(super) fn forward<S: Simd>(&self, simd: S, [column, row, count]: [usize; 3]) -> f32x16<S> {
        let mut forward = [1.0; WIDTH];
        for (lane, forward) in forward.iter_mut().enumerate().take(count) {
            *forward = self.rays.direction((column + lane) as i32, row as i32).normalize().x as f32;
        }
        f32x16::load_array(simd, forward)
    }
}

/// Clamps places to the picture, from the first pixel to the last.
#[inline(always)]
fn inside<S: Simd>(simd: S, places: f32x16<S>, size: usize) -> f32x16<S> {
    places.max(f32x16::splat(simd, 0.0)).min(f32x16::splat(simd, (size - 1) as f32))
}

/// Loads up to sixteen depths and cosines; 0 in the lanes beyond.
#[inline(always)]
pub(super) fn load<S: Simd>(simd: S, seen: &[[f32; 2]]) -> [f32x16<S>; 2] {
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
