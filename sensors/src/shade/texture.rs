//! Filtered texture look-up: trilinear between mip levels, several samples along the longer side of the
//! footprint, so that tags neither alias nor blur when seen at a slant.

use super::Colours;
use crate::scene::{Material, Scene, Texture};
use crate::simd::{floor, sqrt_f32};
use crate::trace::surface::Surfaces;

/// Most samples along the footprint, as Ogre's default anisotropy of 8.
const MAX_ANISOTROPY: f32 = 8.0;
/// From a byte's range to [0, 1].
const TO_UNIT: f32 = 1.0 / 255.0;

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
    let repeat = material.texture_repeat;
    while lanes != 0 {
        let lane = lanes.trailing_zeros() as usize;
        lanes &= lanes - 1;
        // Whole repetitions are taken away in f64: the rest keeps its digits in f32.
        let uv: [f32; 2] = core::array::from_fn(|axis| {
            let coordinate = surfaces.uv[axis][lane] * f64::from(repeat[axis]);
            (coordinate - floor(coordinate)) as f32
        });
        let footprint = [0, 1].map(|side| {
            let [u, v] = &surfaces.footprint[side];
            [u[lane] * repeat[0], v[lane] * repeat[1]]
        });
        let colour = sample(scene, texture, uv, footprint);
        for channel in 0..3 {
            colours[channel][lane] = colour[channel];
        }
    }
}

/// Mean colour around (u, v). `footprint` holds the change of (u, v) from one pixel to the next along the row
/// and down the column.
#[inline(always)]
fn sample(scene: &Scene<'_>, texture: &Texture, uv: [f32; 2], footprint: [[f32; 2]; 2]) -> [f32; 3] {
    let (width, height) = (texture.width as f32, texture.height as f32);
    let length = footprint.map(|[u, v]| sqrt_f32((u * width) * (u * width) + (v * height) * (v * height)));
    let longer = usize::from(length[1] > length[0]);
    let (major, minor) = (length[longer], length[1 - longer]);
    // Magnified textures need neither levels nor several samples.
    if major.is_nan() || major <= 1.0 {
        let [red, green, blue, _] = bilinear(&Level::first(scene, texture), uv);
        return [red * TO_UNIT, green * TO_UNIT, blue * TO_UNIT];
    }
    let ratio = major / if minor > 1.0 { minor } else { 1.0 };
    let samples = if ratio < MAX_ANISOTROPY { (ratio + 0.5) as u32 } else { MAX_ANISOTROPY as u32 };
    let per_sample = 1.0 / samples as f32;
    let level = log2((major * per_sample).max(1.0)).min((texture.levels - 1) as f32);
    let blend = level - level as u32 as f32;
    let fine = (0..level as u32).fold(Level::first(scene, texture), |level, _| level.next());
    let coarse = fine.next();

    let mut sum = [0.0; 4];
    for index in 0..samples {
        let along = (index as f32 + 0.5) * per_sample - 0.5;
        let at = [uv[0] + footprint[longer][0] * along, uv[1] + footprint[longer][1] * along];
        let mut colour = bilinear(&fine, at);
        if blend > 0.0 {
            colour = mix(colour, bilinear(&coarse, at), blend);
        }
        for channel in 0..4 {
            sum[channel] += colour[channel];
        }
    }
    let scale = per_sample * TO_UNIT;
    [sum[0] * scale, sum[1] * scale, sum[2] * scale]
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
    let texel = |x: usize, y: usize| level.texels[y * level.width + x].map(f32::from);
    let upper = mix(texel(left, top), texel(right_of, top), right);
    let lower = mix(texel(left, below), texel(right_of, below), right);
    mix(upper, lower, down)
}

/// The two texels of `size` whose centres lie around `coordinate`, and how far it is from the first.
#[inline(always)]
fn neighbours(coordinate: f32, size: usize) -> (usize, usize, f32) {
    let at = (coordinate - floor_f32(coordinate)) * size as f32 - 0.5;
    let first = floor_f32(at);
    let index = if first < 0.0 { size - 1 } else { (first as usize).min(size - 1) };
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
