//! Filtered texture look-up: trilinear between mip levels, several samples along the longer side of the
//! footprint, so that tags neither alias nor blur when seen at a slant.

use super::Colours;
use crate::scene::tree::WIDTH;
use crate::scene::{Material, Scene, Texture};
use crate::simd::{LANES, Lanes, floor, sqrt_f32};
use crate::trace::surface::Surfaces;
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdInt, f32x16, u32x16};

/// Most samples along the footprint, as Ogre's default anisotropy of 8.
const MAX_ANISOTROPY: f32 = 8.0;

/// Mean colours over the pixels' footprints, RGB in [0, 1], of the lanes whose bits are set; others in their rows of
/// sixteen are overwritten with whatever.
#[inline(always)]
pub(super) fn sample_lanes<S: Simd>(
    simd: S,
    scene: &Scene<'_>,
    material: &Material,
    surfaces: &Surfaces,
    lanes: u64,
    colours: &mut Colours,
) {
    let texture = &scene.textures[material.texture as usize];
    let taps = Taps::new(texture, material.texture_repeat, surfaces);
    let levels = Levels::new(scene, texture);
    for first in (0..LANES).step_by(WIDTH) {
        let mine = (lanes >> first) as u32 & 0xffff;
        if mine == 0 {
            continue;
        }
        let mean = taps.mean(simd, first, mine, &levels);
        for channel in 0..3 {
            colours[channel][first..first + WIDTH].copy_from_slice(&mean[channel]);
        }
    }
}

/// Where and how finely each lane looks into its texture.
struct Taps {
    /// (u, v) of the middle of the footprint, less whole repetitions.
    middle: [Lanes<f32>; 2],
    /// From one sample to the next, along the longer side of the footprint.
    step: [Lanes<f32>; 2],
    samples: Lanes<u32>,
    /// The finer of the two mip levels.
    level: Lanes<u32>,
    /// Share of the next coarser one.
    blend: Lanes<f32>,
}

impl Taps {
    #[inline(always)]
    fn new(texture: &Texture, repeat: [f32; 2], surfaces: &Surfaces) -> Self {
        let mut taps = Self {
            middle: [[0.0; LANES]; 2],
            step: [[0.0; LANES]; 2],
            samples: [1; LANES],
            level: [0; LANES],
            blend: [0.0; LANES],
        };
        for axis in 0..2 {
            // Whole repetitions are taken away in f64: the rest keeps its digits in f32.
            let repeat = f64::from(repeat[axis]);
            for lane in 0..LANES {
                let coordinate = surfaces.uv[axis][lane] * repeat;
                taps.middle[axis][lane] = (coordinate - floor(coordinate)) as f32;
            }
        }
        let [[right_u, right_v], [down_u, down_v]] = &surfaces.footprint;
        let (width, height) = (texture.width as f32, texture.height as f32);
        let coarsest = (texture.levels - 1) as f32;
        for lane in 0..LANES {
            let [right_u, down_u] = [right_u[lane] * repeat[0], down_u[lane] * repeat[0]];
            let [right_v, down_v] = [right_v[lane] * repeat[1], down_v[lane] * repeat[1]];
            let right = length(right_u * width, right_v * height);
            let down = length(down_u * width, down_v * height);
            let (major, minor) = if right < down { (down, right) } else { (right, down) };

            // As many samples as the footprint is long in terms of its width; a magnified texture needs but one.
            let ratio = major / if minor > 1.0 { minor } else { 1.0 };
            let ratio = if ratio < MAX_ANISOTROPY { ratio } else { MAX_ANISOTROPY };
            let ratio = if ratio > 1.0 { ratio } else { 1.0 };
            let samples = (ratio + 0.5) as i32;
            let per_sample = 1.0 / samples as f32;
            let width = major * per_sample;
            let level = log2(if width > 1.0 { width } else { 1.0 });
            let level = if level < coarsest { level } else { coarsest };

            taps.step[0][lane] = if right < down { down_u } else { right_u } * per_sample;
            taps.step[1][lane] = if right < down { down_v } else { right_v } * per_sample;
            taps.samples[lane] = samples as u32;
            taps.level[lane] = level as i32 as u32;
            taps.blend[lane] = level - level as i32 as f32;
        }
        taps
    }

    /// Means of the samples of sixteen lanes, in [0, 1]; only those that are `mine` count.
    #[inline(always)]
    fn mean<S: Simd>(&self, simd: S, first: usize, mine: u32, levels: &Levels<'_>) -> [[f32; WIDTH]; 3] {
        let sixteen = |lanes: &Lanes<f32>| {
            let mut part = [0.0; WIDTH];
            part.copy_from_slice(&lanes[first..first + WIDTH]);
            f32x16::load_array(simd, part)
        };
        // Step 1: of the samples, the most that any lane has; others finish before.
        let (mut most, mut mixed) = (0, false);
        let (mut counts, mut level, mut next) = ([0.0; WIDTH], [0; WIDTH], [0; WIDTH]);
        for lane in 0..WIDTH {
            let count = if mine >> lane & 1 != 0 { self.samples[first + lane] } else { 0 };
            most = most.max(count);
            mixed |= count > 0 && self.blend[first + lane] > 0.0;
            counts[lane] = count as f32;
            level[lane] = self.level[first + lane];
            next[lane] = level[lane] + 1;
        }
        let fine = levels.pick(simd, &level);
        let coarse = levels.pick(simd, &next);
        let counts = f32x16::load_array(simd, counts);
        let blend = sixteen(&self.blend);
        let (u, v) = (sixteen(&self.middle[0]), sixteen(&self.middle[1]));
        let (step_u, step_v) = (sixteen(&self.step[0]), sixteen(&self.step[1]));

        // Step 2: sample after sample.
        let zero = f32x16::splat(simd, 0.0);
        let mut sum = [zero; 3];
        for index in 0..most {
            let along = (f32x16::splat(simd, index as f32) + 0.5) - counts * 0.5;
            let (u, v) = (u + step_u * along, v + step_v * along);
            let mut colour = fine.bilinear(simd, u, v);
            if mixed {
                let other = coarse.bilinear(simd, u, v);
                for channel in 0..3 {
                    colour[channel] = mix(colour[channel], other[channel], blend);
                }
            }
            let counts_on = f32x16::splat(simd, index as f32).simd_lt(counts);
            for channel in 0..3 {
                sum[channel] += counts_on.select(colour[channel], zero);
            }
        }
        let scale = f32x16::splat(simd, 1.0) / (counts * 255.0);
        let mut mean = [[0.0; WIDTH]; 3];
        for channel in 0..3 {
            (sum[channel] * scale).store_array(&mut mean[channel]);
        }
        mean
    }
}

#[inline(always)]
fn length(x: f32, y: f32) -> f32 {
    sqrt_f32(x * x + y * y)
}

/// Binary logarithm of x ≥ 1, linear between powers of two: exact bits everywhere, and within 0.09 of the truth,
/// which moves the blend between two levels a little and nothing else.
#[inline(always)]
fn log2(x: f32) -> f32 {
    let bits = x.to_bits();
    let exponent = (bits >> 23) as f32 - 127.0;
    let mantissa = f32::from_bits(bits & 0x007f_ffff | 0x3f80_0000);
    exponent + (mantissa - 1.0)
}

/// Most mip levels of a texture.
const MOST_LEVELS: usize = 32;

/// The mip levels of a texture.
struct Levels<'a> {
    texels: &'a [[u8; 4]],
    /// First texel of each; those after the last are the last again.
    offset: [u32; MOST_LEVELS],
    width: [u32; MOST_LEVELS],
    height: [u32; MOST_LEVELS],
}

impl<'a> Levels<'a> {
    #[inline(always)]
    fn new(scene: &Scene<'a>, texture: &Texture) -> Self {
        let mut levels = Self {
            texels: &scene.texels[texture.first_texel as usize..],
            offset: [0; MOST_LEVELS],
            width: [texture.width; MOST_LEVELS],
            height: [texture.height; MOST_LEVELS],
        };
        let (mut offset, mut width, mut height) = (0, texture.width, texture.height);
        for level in 0..MOST_LEVELS {
            levels.offset[level] = offset;
            levels.width[level] = width;
            levels.height[level] = height;
            if level as u32 + 1 < texture.levels {
                offset += width * height;
                (width, height) = ((width / 2).max(1), (height / 2).max(1));
            }
        }
        levels
    }

    /// A level for each of sixteen lanes.
    #[inline(always)]
    fn pick<S: Simd>(&self, simd: S, level: &[u32; WIDTH]) -> LaneLevels<'a, S> {
        let (mut offset, mut width, mut height) = ([0; WIDTH], [0; WIDTH], [0; WIDTH]);
        for lane in 0..WIDTH {
            let level = level[lane] as usize % MOST_LEVELS;
            offset[lane] = self.offset[level];
            width[lane] = self.width[level];
            height[lane] = self.height[level];
        }
        LaneLevels {
            texels: self.texels,
            offset: u32x16::load_array(simd, offset),
            width: u32x16::load_array(simd, width),
            height: u32x16::load_array(simd, height),
        }
    }
}

/// The mip levels that sixteen lanes look into.
struct LaneLevels<'a, S: Simd> {
    texels: &'a [[u8; 4]],
    offset: u32x16<S>,
    width: u32x16<S>,
    height: u32x16<S>,
}

impl<S: Simd> LaneLevels<'_, S> {
    /// The colours at (u, v), 0 to 255. Row 0 is the top, v = 1; texel centres lie at half integers; the picture
    /// repeats.
    #[inline(always)]
    fn bilinear(&self, simd: S, u: f32x16<S>, v: f32x16<S>) -> [f32x16<S>; 3] {
        let (left, right_of, right) = neighbours(simd, u, self.width);
        let (top, below, down) = neighbours(simd, f32x16::splat(simd, 1.0) - v, self.height);
        let (top, below) = (self.offset + top * self.width, self.offset + below * self.width);
        let upper = mix_texels(simd, self.texels(simd, top + left), self.texels(simd, top + right_of), right);
        let lower =
            mix_texels(simd, self.texels(simd, below + left), self.texels(simd, below + right_of), right);
        let mut mixed = upper;
        for channel in 0..3 {
            mixed[channel] = mix(upper[channel], lower[channel], down);
        }
        mixed
    }

    #[inline(always)]
    fn texels(&self, simd: S, index: u32x16<S>) -> u32x16<S> {
        let mut indices = [0; WIDTH];
        index.store_array(&mut indices);
        let mut texels = [0; WIDTH];
        for lane in 0..WIDTH {
            // Lanes that do not count may look anywhere.
            texels[lane] = u32::from_le_bytes(*self.texels.get(indices[lane] as usize).unwrap_or(&[0; 4]));
        }
        u32x16::load_array(simd, texels)
    }
}

/// The two texels out of `size` whose centres lie around each coordinate, and how far it is from the first.
#[inline(always)]
fn neighbours<S: Simd>(simd: S, coordinate: f32x16<S>, size: u32x16<S>) -> (u32x16<S>, u32x16<S>, f32x16<S>) {
    let zero = f32x16::splat(simd, 0.0);
    let one = u32x16::splat(simd, 1);
    let part = coordinate - coordinate.floor();
    // What is not finite becomes 0.
    let part = part.simd_ge(zero).select(part, zero);
    let at = part * size.to_float::<f32x16<S>>() - 0.5;
    let first = at.floor();
    let last = size - one;
    let index = first.simd_lt(zero).select(last, first.max_precise(zero).to_int::<u32x16<S>>());
    // Rounding may have made of the part a whole.
    let index = index.simd_gt(last).select(last, index);
    let next = index.simd_eq(last).select(u32x16::splat(simd, 0), index + one);
    (index, next, at - first)
}

#[inline(always)]
fn mix<S: Simd>(from: f32x16<S>, to: f32x16<S>, part: f32x16<S>) -> f32x16<S> {
    from + (to - from) * part
}

/// Red, green and blue of texels, mixed.
#[inline(always)]
fn mix_texels<S: Simd>(simd: S, from: u32x16<S>, to: u32x16<S>, part: f32x16<S>) -> [f32x16<S>; 3] {
    let low = u32x16::splat(simd, 0xff);
    let mut mixed = [part; 3];
    for (channel, mixed) in mixed.iter_mut().enumerate() {
        let shift = 8 * channel as u32;
        let from = ((from >> shift) & low).to_float::<f32x16<S>>();
        let to = ((to >> shift) & low).to_float::<f32x16<S>>();
        *mixed = mix(from, to, part);
    }
    mixed
}
