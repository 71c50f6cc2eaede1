//! Filtered texture look-up: trilinear between mip levels, several samples along the longer side of the
//! footprint, so that tags neither alias nor blur when seen at a slant.

use super::Colours;
use crate::scene::{Material, Scene, Texture};
use crate::simd::{LANES, Lanes, floor, sqrt_f32};
use crate::trace::surface::Surfaces;

/// Most samples along the footprint, as Ogre's default anisotropy of 8.
const MAX_ANISOTROPY: f32 = 8.0;

/// Mean colours over the pixels' footprints, RGB in [0, 1], of the lanes whose bits are set.
#[inline(always)]
pub(super) fn sample_lanes(
    scene: &Scene<'_>,
    material: &Material,
    surfaces: &Surfaces,
    mut lanes: u64,
    colours: &mut Colours,
) {
    let texture = &scene.textures[material.texture as usize];
    let taps = Taps::new(texture, material.texture_repeat, surfaces);
    while lanes != 0 {
        let lane = lanes.trailing_zeros() as usize;
        lanes &= lanes - 1;
        let [red, green, blue, _] = taps.mean(lane, Level::first(scene, texture));
        colours[0][lane] = red;
        colours[1][lane] = green;
        colours[2][lane] = blue;
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

    /// Mean of the samples of a lane, in [0, 1].
    #[inline(always)]
    fn mean(&self, lane: usize, first: Level<'_>) -> [f32; 4] {
        let fine = (0..self.level[lane]).fold(first, |level, _| level.next());
        let coarse = fine.next();
        let blend = self.blend[lane];
        let samples = self.samples[lane] as f32;
        let mut sum = [0.0; 4];
        for index in 0..self.samples[lane] {
            let along = index as f32 + 0.5 - samples * 0.5;
            let at = [0, 1].map(|axis| self.middle[axis][lane] + self.step[axis][lane] * along);
            let mut colour = bilinear(&fine, at);
            if blend > 0.0 {
                colour = mix(colour, bilinear(&coarse, at), blend);
            }
            for channel in 0..4 {
                sum[channel] += colour[channel];
            }
        }
        let scale = 1.0 / (255.0 * samples);
        sum.map(|channel| channel * scale)
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

/// One mip level, and those that follow it.
#[derive(Clone, Copy)]
struct Level<'a> {
    texels: &'a [[u8; 4]],
    width: usize,
    height: usize,
}

impl<'a> Level<'a> {
    #[inline(always)]
    fn first(scene: &Scene<'a>, texture: &Texture) -> Self {
        Self {
            texels: &scene.texels[texture.first_texel as usize..],
            width: texture.width as usize,
            height: texture.height as usize,
        }
    }

    /// The next coarser one. After the last it may not be looked into.
    #[inline(always)]
    fn next(self) -> Self {
        Self {
            texels: self.texels.get(self.width * self.height..).unwrap_or_default(),
            width: (self.width / 2).max(1),
            height: (self.height / 2).max(1),
        }
    }
}

/// The colour at (u, v), 0 to 255. Row 0 is the top, v = 1; texel centres lie at half integers; the picture
/// repeats.
#[inline(always)]
fn bilinear(level: &Level<'_>, [u, v]: [f32; 2]) -> [f32; 4] {
    let (left, right_of, right) = neighbours(u, level.width);
    let (top, below, down) = neighbours(1.0 - v, level.height);
    let texel = |x: usize, y: usize| {
        let [red, green, blue, alpha] = level.texels[y * level.width + x];
        [f32::from(red), f32::from(green), f32::from(blue), f32::from(alpha)]
    };
    let upper = mix(texel(left, top), texel(right_of, top), right);
    let lower = mix(texel(left, below), texel(right_of, below), right);
    mix(upper, lower, down)
}

/// The two texels out of `size` whose centres lie around `coordinate`, and how far it is from the first.
#[inline(always)]
fn neighbours(coordinate: f32, size: usize) -> (usize, usize, f32) {
    let at = coordinate * size as f32 - 0.5;
    let first = floor_f32(at);
    let mut index = first as usize;
    if first < 0.0 || index >= size {
        index = (first as i64).rem_euclid(size as i64) as usize;
    }
    (index, if index + 1 == size { 0 } else { index + 1 }, at - first)
}

/// The largest whole number not above x, for |x| < 2³¹.
#[inline(always)]
fn floor_f32(x: f32) -> f32 {
    let whole = x as i32 as f32;
    if whole > x { whole - 1.0 } else { whole }
}

#[inline(always)]
fn mix(from: [f32; 4], to: [f32; 4], part: f32) -> [f32; 4] {
    let mut mixed = from;
    for channel in 0..4 {
        mixed[channel] += (to[channel] - from[channel]) * part;
    }
    mixed
}
