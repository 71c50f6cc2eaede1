//! Reading texels: those on both sides of a point, and the colours that they stand for.

use crate::simd::WIDTH;
use crate::srgb::decode_row;
use fearless_simd::{Bytes, Select, Simd, SimdBase, SimdInt, f32x16, u32x16, u64x8};

/// The quantity to read from a texture.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Reading {
    /// The values as they are stored.
    Numbers,
    /// The linear light for values in sRGB.
    Light,
    /// The alpha, in all three channels.
    Alpha,
}

/// Two texels for each lane. The second follows the first in memory, except in the lanes of `wrapping`, as one bit
/// each.
#[inline(always)]
pub(super) fn look_up_neighbours<S: Simd>(
    simd: S,
    texels: &[[u8; 4]],
    [left, right]: [u32x16<S>; 2],
    wrapping: u64,
) -> [u32x16<S>; 2] {
    let found = look_up_pairs(simd, texels, left);
    if wrapping == 0 { found } else { look_up_apart(simd, texels, [left, right], wrapping, found) }
}

/// Reads the texels of some lanes one by one.
#[inline(always)]
fn look_up_apart<S: Simd>(
    simd: S,
    texels: &[[u8; 4]],
    index: [u32x16<S>; 2],
    wrapping: u64,
    found: [u32x16<S>; 2],
) -> [u32x16<S>; 2] {
    let mut patched = found;
    for side in 0..2 {
        let (mut indices, mut values) = ([0; WIDTH], [0; WIDTH]);
        index[side].store_array(&mut indices);
        found[side].store_array(&mut values);
        let mut rest = wrapping;
        while rest != 0 {
            let lane = rest.trailing_zeros() as usize % WIDTH;
            rest &= rest - 1;
            if let Some(texel) = texels.get(indices[lane] as usize) {
                values[lane] = u32::from_le_bytes(*texel);
            }
        }
        patched[side] = u32x16::load_array(simd, values);
    }
    patched
}

/// For each lane, a texel and the one after it, with a single load per lane. Unused lanes may read any texel.
#[inline(always)]
fn look_up_pairs<S: Simd>(simd: S, texels: &[[u8; 4]], index: u32x16<S>) -> [u32x16<S>; 2] {
    let indices = indices_up_to(simd, index, texels.len().saturating_sub(2));
    let mut found = [0_u64; WIDTH];
    for lane in 0..WIDTH {
        let from = indices[lane] as usize;
        let Some(&[left, right]) = texels.get(from..from + 2) else {
            return [index; 2];
        };
        found[lane] = u64::from_le(bytemuck::cast([left, right]));
    }
    let (low, high) = found.split_at(WIDTH / 2);
    let low: u32x16<S> = u64x8::from_slice(simd, low).bitcast();
    let high: u32x16<S> = u64x8::from_slice(simd, high).bitcast();
    [simd.unzip_low_u32x16(low, high), simd.unzip_high_u32x16(low, high)]
}

/// Limits indices to `last`, so that the bounds check never fails and costs next to nothing.
#[inline(always)]
fn indices_up_to<S: Simd>(simd: S, index: u32x16<S>, last: usize) -> [u32; WIDTH] {
    let last = u32x16::splat(simd, last as u32);
    let mut indices = [0; WIDTH];
    index.simd_lt(last).select(index, last).store_array(&mut indices);
    // Transparency memory: sixteen loads are cheaper than as many extractions from a vector.
    core::hint::black_box(indices)
}

/// Converts and mixes the values of texels, 0 to 255.
#[inline(always)]
pub(super) fn mix_texels<S: Simd>(
    simd: S,
    [from, to]: [u32x16<S>; 2],
    part: f32x16<S>,
    reading: Reading,
) -> [f32x16<S>; 3] {
    let low = u32x16::splat(simd, 0xff);
    if reading == Reading::Alpha {
        return [mix((from >> 24).to_float(), (to >> 24).to_float(), part); 3];
    }
    let mut mixed = [part; 3];
    for (channel, mixed) in mixed.iter_mut().enumerate() {
        let shift = 8 * channel as u32;
        let mut from = ((from >> shift) & low).to_float::<f32x16<S>>();
        let mut to = ((to >> shift) & low).to_float::<f32x16<S>>();
        if reading == Reading::Light {
            from = decode_row(simd, from * (1.0 / 255.0)) * 255.0;
            to = decode_row(simd, to * (1.0 / 255.0)) * 255.0;
        }
        *mixed = mix(from, to, part);
    }
    mixed
}

/// The value at a part of the way from one to another.
#[inline(always)]
pub(super) fn mix<S: Simd>(from: f32x16<S>, to: f32x16<S>, part: f32x16<S>) -> f32x16<S> {
    from + (to - from) * part
}
