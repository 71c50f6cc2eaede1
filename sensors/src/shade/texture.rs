//! Filtered texture look-up: trilinear between mip levels, with several samples along the longer side of the footprint,
//! so that fiducial tags neither alias nor blur when seen at a slant.
//!
//! Tried without gain: reading a texel of every lane of a tile in advance, instead of a prefetch.

use super::surface::Footprint;
use super::texels::{Reading, look_up_neighbours, mix, mix_texels};
use crate::scene::{NO_TEXTURE, Scene, Texture};
use crate::simd::WIDTH;
use fearless_simd::{Bytes, Select, Simd, SimdBase, SimdFloat, SimdInt, SimdMask, f32x16, mask32x16, u32x16};

/// Greatest number of samples along the footprint, equal to Ogre's default anisotropy of 8.
const MAX_ANISOTROPY: f32 = 8.0;

/// Greatest number of mip levels of a texture.
const MOST_LEVELS: usize = 32;

/// Reads one texture after the other; caches the properties of the last one.
pub(super) struct Sampler {
    texture: u32,
    first_texel: usize,
    /// Size of level 0, and the number of the coarsest level.
    size: [f32; 2],
    coarsest: f32,
    /// The levels; entries after the last level repeat it.
    levels: [Level; MOST_LEVELS],
}

/// A mip level.
#[derive(Clone, Copy)]
struct Level {
    offset: u32,
    width: u32,
    height: u32,
}

impl Sampler {
    pub(super) const fn new() -> Self {
        let level = Level { offset: 0, width: 1, height: 1 };
        Self {
            texture: NO_TEXTURE,
            first_texel: 0,
            size: [1.0; 2],
            coarsest: 0.0,
            levels: [level; MOST_LEVELS],
        }
    }

    /// Selects a texture of the scene.
    #[inline(always)]
    pub(super) fn turn_to(&mut self, scene: &Scene<'_>, texture: u32) {
        if self.texture != texture {
            self.texture = texture;
            self.measure(&scene.textures[texture as usize]);
        }
    }

    fn measure(&mut self, texture: &Texture) {
        self.first_texel = texture.first_texel as usize;
        self.size = [texture.width as f32, texture.height as f32];
        self.coarsest = (texture.levels - 1) as f32;
        let (mut width, mut height, mut offset) = (texture.width, texture.height, 0);
        // The faces of a cube have borders.
        let (faces, border) = if texture.is_cube() { (6, 2) } else { (1, 0) };
        for (index, place) in self.levels.iter_mut().enumerate() {
            *place = Level { offset, width: width + border, height: height + border };
            if index as u32 + 1 < texture.levels {
                offset += faces * place.width * place.height;
                (width, height) = ((width / 2).max(1), (height / 2).max(1));
            }
        }
    }

    /// Mean values over the footprints of sixteen pixels, RGB in [0, 1]. Only lanes in `mine` are used, of which there
    /// must be at least one.
    #[inline(always)]
    pub(super) fn sample<S: Simd>(
        &self,
        simd: S,
        scene: &Scene<'_>,
        footprint: &Footprint<S>,
        mine: mask32x16<S>,
        reading: Reading,
    ) -> [f32x16<S>; 3] {
        self.sample_face::<S, false>(simd, scene, (u32x16::splat(simd, 0), footprint), mine, reading)
    }

    /// [`Sampler::sample`] of an image, or, if it is a `CUBE`, of these faces.
    #[inline(always)]
    pub(super) fn sample_face<S: Simd, const CUBE: bool>(
        &self,
        simd: S,
        scene: &Scene<'_>,
        (face, footprint): (u32x16<S>, &Footprint<S>),
        mine: mask32x16<S>,
        reading: Reading,
    ) -> [f32x16<S>; 3] {
        let texels = &scene.texels[self.first_texel..];
        let taps = self.taps(simd, footprint);
        let mixed = (taps.blend.simd_gt(0.0) & mine).any_true();
        let mut fine = self.pick(simd, taps.level, mine);
        let mut coarse = self.pick(simd, taps.level + 1, mine);
        if CUBE {
            fine.offset += face * fine.width * fine.height;
            coarse.offset += face * coarse.width * coarse.height;
        }
        // The loop runs for the greatest number of samples of any lane; others finish before.
        let zero = f32x16::splat(simd, 0.0);
        let counts = mine.select(taps.samples, zero);
        let most = simd.reduce_max_f32x16(counts);
        let [u, v] = footprint.uv;
        let mut sum = [zero; 3];
        let mut index = 0.0;
        while index < most {
            let along = f32x16::splat(simd, index + 0.5) - counts * 0.5;
            let (u, v) = (u + taps.step[0] * along, v + taps.step[1] * along);
            let mut colour = fine.bilinear::<CUBE>(simd, texels, [u, v], mine, reading);
            if mixed {
                let other = coarse.bilinear::<CUBE>(simd, texels, [u, v], mine, reading);
                for channel in 0..3 {
                    colour[channel] = mix(colour[channel], other[channel], taps.blend);
                }
            }
            let counts_on = f32x16::splat(simd, index).simd_lt(counts);
            for channel in 0..3 {
                sum[channel] += counts_on.select(colour[channel], zero);
            }
            index += 1.0;
        }
        let scale = f32x16::splat(simd, 1.0) / (counts * 255.0);
        [sum[0] * scale, sum[1] * scale, sum[2] * scale]
    }

    /// Selects the mip levels and sample positions for each lane. Values that are not finite become finite.
    #[inline(always)]
    fn taps<S: Simd>(&self, simd: S, footprint: &Footprint<S>) -> Taps<S> {
        let one = f32x16::splat(simd, 1.0);
        let [width, height] = self.size;
        let [right, down] = &footprint.steps;
        let along_row = length(right[0] * width, right[1] * height);
        let along_column = length(down[0] * width, down[1] * height);
        let steep = along_row.simd_lt(along_column);
        let major = steep.select(along_column, along_row);
        let minor = steep.select(along_row, along_column);

        // The number of samples is the ratio of the footprint's length to its width; a magnified texture needs only
        // one.
        let ratio = major / greater(minor, one);
        let ratio = greater(lesser(ratio, f32x16::splat(simd, MAX_ANISOTROPY)), one);
        let samples = (ratio + 0.5).floor();
        let per_sample = one / samples;
        let level = log2(simd, greater(major * per_sample, one));
        let level = lesser(level, f32x16::splat(simd, self.coarsest));
        let whole = level.floor();
        Taps {
            step: [
                steep.select(down[0], right[0]) * per_sample,
                steep.select(down[1], right[1]) * per_sample,
            ],
            samples,
            level: whole.to_int(),
            blend: level - whole,
        }
    }

    /// Gets the mip level for each of sixteen lanes.
    #[inline(always)]
    fn pick<S: Simd>(&self, simd: S, level: u32x16<S>, mine: mask32x16<S>) -> LaneLevels<S> {
        let mut levels = [0; WIDTH];
        level.store_array(&mut levels);
        // Usually the level is the same for all lanes.
        let first = levels[mine.to_bitmask().trailing_zeros() as usize % WIDTH];
        if (level.simd_ne(u32x16::splat(simd, first)) & mine).any_true() {
            let (mut offset, mut width, mut height) = ([0; WIDTH], [0; WIDTH], [0; WIDTH]);
            for lane in 0..WIDTH {
                let level = &self.levels[levels[lane] as usize % MOST_LEVELS];
                (offset[lane], width[lane], height[lane]) = (level.offset, level.width, level.height);
            }
            LaneLevels {
                offset: u32x16::load_array(simd, offset),
                width: u32x16::load_array(simd, width),
                height: u32x16::load_array(simd, height),
            }
        } else {
            let level = &self.levels[first as usize % MOST_LEVELS];
            LaneLevels {
                offset: u32x16::splat(simd, level.offset),
                width: u32x16::splat(simd, level.width),
                height: u32x16::splat(simd, level.height),
            }
        }
    }
}

/// The mip levels and sample positions for each lane.
struct Taps<S: Simd> {
    /// Offset from one sample to the next, along the longer side of the footprint.
    step: [f32x16<S>; 2],
    samples: f32x16<S>,
    /// The finer of the two mip levels.
    level: u32x16<S>,
    /// Weight of the next coarser level.
    blend: f32x16<S>,
}

/// The mip levels that sixteen lanes read.
struct LaneLevels<S: Simd> {
    offset: u32x16<S>,
    width: u32x16<S>,
    height: u32x16<S>,
}

impl<S: Simd> LaneLevels<S> {
    /// The colours at (u, v), 0 to 255. Row 0 is the top, v = 1; texel centres are at half-integers; the image repeats,
    /// or, if it is that of a `CUBE`, ends with its border.
    #[inline(always)]
    fn bilinear<const CUBE: bool>(
        &self,
        simd: S,
        texels: &[[u8; 4]],
        [u, v]: [f32x16<S>; 2],
        mine: mask32x16<S>,
        reading: Reading,
    ) -> [f32x16<S>; 3] {
        let from_top = f32x16::splat(simd, 1.0) - v;
        let (left, right_of, right) =
            if CUBE { within(simd, u, self.width) } else { neighbours(simd, u, self.width) };
        let (top, below, down) =
            if CUBE { within(simd, from_top, self.height) } else { neighbours(simd, from_top, self.height) };
        let (top, below) = (self.offset + top * self.width, self.offset + below * self.width);
        let wrapping = (right_of.simd_ne(left + 1) & mine).to_bitmask();
        let [top_left, top_right] = look_up_neighbours(simd, texels, [top + left, top + right_of], wrapping);
        let [below_left, below_right] =
            look_up_neighbours(simd, texels, [below + left, below + right_of], wrapping);
        let upper = mix_texels(simd, [top_left, top_right], right, reading);
        let lower = mix_texels(simd, [below_left, below_right], right, reading);
        let mut mixed = upper;
        for channel in 0..3 {
            mixed[channel] = mix(upper[channel], lower[channel], down);
        }
        mixed
    }
}

/// The two texels out of `size` whose centres are around each coordinate, and the distance from the first to it.
#[inline(always)]
fn neighbours<S: Simd>(simd: S, coordinate: f32x16<S>, size: u32x16<S>) -> (u32x16<S>, u32x16<S>, f32x16<S>) {
    let zero = f32x16::splat(simd, 0.0);
    let one = u32x16::splat(simd, 1);
    let part = coordinate - coordinate.floor();
    // A value that is not finite becomes 0.
    let part = part.simd_ge(zero).select(part, zero);
    let at = part * size.to_float::<f32x16<S>>() - 0.5;
    let first = at.floor();
    let last = size - one;
    let index = first.simd_lt(zero).select(last, first.max_precise(zero).to_int::<u32x16<S>>());
    // Rounding may have increased the fraction to 1.
    let index = index.simd_gt(last).select(last, index);
    let next = index.simd_eq(last).select(u32x16::splat(simd, 0), index + one);
    (index, next, at - first)
}

/// The same for an image of `size` texels with its border, which ends at 0 and 1.
#[inline(always)]
fn within<S: Simd>(simd: S, coordinate: f32x16<S>, size: u32x16<S>) -> (u32x16<S>, u32x16<S>, f32x16<S>) {
    let part = lesser(greater(coordinate, f32x16::splat(simd, 0.0)), f32x16::splat(simd, 1.0));
    let at = part * (size.to_float::<f32x16<S>>() - 2.0) + 0.5;
    let first = at.floor();
    let index = first.to_int::<u32x16<S>>();
    (index, index + 1, at - first)
}

#[inline(always)]
fn length<S: Simd>(x: f32x16<S>, y: f32x16<S>) -> f32x16<S> {
    (x * x + y * y).sqrt()
}

/// Binary logarithm of x ≥ 1, linear between powers of two. The bits are the same on every machine, and the error is at
/// most 0.09, which only slightly changes the blend between two levels.
#[inline(always)]
fn log2<S: Simd>(simd: S, x: f32x16<S>) -> f32x16<S> {
    let bits: u32x16<S> = x.bitcast();
    let exponent = (bits >> 23).to_float::<f32x16<S>>() - 127.0;
    let mantissa: f32x16<S> =
        ((bits & u32x16::splat(simd, 0x007f_ffff)) | u32x16::splat(simd, 0x3f80_0000)).bitcast();
    exponent + (mantissa - 1.0)
}

/// The minimum; `limit` for NaN.
#[inline(always)]
fn lesser<S: Simd>(x: f32x16<S>, limit: f32x16<S>) -> f32x16<S> {
    x.simd_lt(limit).select(x, limit)
}

/// The maximum; `limit` for NaN.
#[inline(always)]
fn greater<S: Simd>(x: f32x16<S>, limit: f32x16<S>) -> f32x16<S> {
    x.simd_gt(limit).select(x, limit)
}
