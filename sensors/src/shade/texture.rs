//! Filtered texture look-up: trilinear between mip levels, several samples along the longer side of the
//! footprint, so that tags neither alias nor blur when seen at a slant.

use crate::scene::{Scene, Texture};
use crate::simd::{floor, sqrt};

/// Most samples along the footprint, as Ogre's default anisotropy of 8.
const MAX_ANISOTROPY: f64 = 8.0;

/// Mean colour over a pixel's footprint, RGB in [0, 1]. `footprint` holds the change of (u, v) from one pixel to
/// the next along the row and down the column.
pub(super) fn sample(
    scene: &Scene<'_>,
    texture: u32,
    uv: [f64; 2],
    footprint: [[f64; 2]; 2],
    repeat: [f32; 2],
) -> [f32; 3] {
    let texture = &scene.textures[texture as usize];
    let repeat = repeat.map(f64::from);
    let size = [f64::from(texture.width), f64::from(texture.height)];
    let uv = [uv[0] * repeat[0], uv[1] * repeat[1]];
    let sides = footprint.map(|side| [side[0] * repeat[0], side[1] * repeat[1]]);
    let length_squared = sides.map(|[u, v]| (u * size[0]) * (u * size[0]) + (v * size[1]) * (v * size[1]));
    let longer = usize::from(length_squared[1] > length_squared[0]);
    let (major, minor) = (sqrt(length_squared[longer]), sqrt(length_squared[1 - longer]));
    let width = minor.max(major / MAX_ANISOTROPY);
    let samples = if width > 0.0 { (-floor(-major / width)).clamp(1.0, MAX_ANISOTROPY) } else { 1.0 };
    // Magnified textures need neither levels nor several samples.
    let samples = if major > 1.0 { samples as u32 } else { 1 };
    let level = log2(width.max(1.0) as f32).min((texture.levels - 1) as f32);
    let (fine, blend) = (level as u32, level - level as u32 as f32);

    let mut sum = [0.0_f32; 3];
    for index in 0..samples {
        let along = (f64::from(index) + 0.5) / f64::from(samples) - 0.5;
        let at = [uv[0] + sides[longer][0] * along, uv[1] + sides[longer][1] * along];
        let colour = bilinear(scene, texture, fine, at);
        let coarser = if blend > 0.0 { bilinear(scene, texture, fine + 1, at) } else { colour };
        for channel in 0..3 {
            sum[channel] += colour[channel] + (coarser[channel] - colour[channel]) * blend;
        }
    }
    let scale = 1.0 / (255.0 * samples as f32);
    sum.map(|channel| channel * scale)
}

/// Binary logarithm of x ≥ 1, linear between powers of two: exact bits everywhere, and within 0.09 of the truth,
/// which moves the blend between two levels a little and nothing else.
fn log2(x: f32) -> f32 {
    let bits = x.to_bits();
    let exponent = (bits >> 23) as f32 - 127.0;
    let mantissa = f32::from_bits(bits & 0x007f_ffff | 0x3f80_0000);
    exponent + (mantissa - 1.0)
}

fn bilinear(scene: &Scene<'_>, texture: &Texture, level: u32, [u, v]: [f64; 2]) -> [f32; 3] {
    let (mut first, mut width, mut height) =
        (texture.first_texel as usize, texture.width as usize, texture.height as usize);
    for _ in 0..level {
        first += width * height;
        (width, height) = ((width / 2).max(1), (height / 2).max(1));
    }
    // Row 0 is the top, v = 1; texel centres lie at half integers; the picture repeats.
    let x = (u - floor(u)) * width as f64 - 0.5;
    let y = (1.0 - (v - floor(v))) * height as f64 - 0.5;
    let (column, row) = (floor(x), floor(y));
    let (right, down) = ((x - column) as f32, (y - row) as f32);
    let wrap = |index: f64, size: usize| {
        if index < 0.0 { size - 1 } else { (index as usize).min(size - 1) }
    };
    let next = |index: usize, size: usize| if index + 1 == size { 0 } else { index + 1 };
    let (left, top) = (wrap(column, width), wrap(row, height));
    let (right_of, below) = (next(left, width), next(top, height));
    let texel = |x: usize, y: usize| scene.texels[first + y * width + x];
    let [a, b, c, d] = [texel(left, top), texel(right_of, top), texel(left, below), texel(right_of, below)];
    core::array::from_fn(|channel| {
        let value = |texel: [u8; 4]| f32::from(texel[channel]);
        let upper = value(a) + (value(b) - value(a)) * right;
        let lower = value(c) + (value(d) - value(c)) * right;
        upper + (lower - upper) * down
    })
}
