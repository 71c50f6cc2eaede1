//! The floor's texture: 2 m × 2 m of wooden planks that continue at the edges. It is computed with integers only, so that
//! it is the same on every machine.

use super::output::{Content, Generated};

/// Pixels along an edge.
const SIZE: u32 = 512;
/// Pixels across a plank: 12.5 cm.
const PLANK_WIDTH: u32 = 32;
/// Pixels along a plank: 1 m.
const PLANK_LENGTH: u32 = 256;
/// Pixels between the knots of the grain's noise, along and across the plank.
const GRAIN: [u32; 2] = [64, 2];

pub(crate) fn file() -> Generated {
    let pixels = (0..SIZE * SIZE).flat_map(|at| pixel(at % SIZE, at / SIZE)).collect();
    Generated {
        path: "tag_room/materials/textures/floor.png".into(),
        content: Content::Rgb { width: SIZE, height: SIZE, pixels },
    }
}

fn pixel(x: u32, y: u32) -> [u8; 3] {
    let row = y / PLANK_WIDTH;
    // Each row of planks has its own shift.
    let along = (x + hash(row, 7, 1) % PLANK_LENGTH) % SIZE;
    let plank = along / PLANK_LENGTH;
    let joint = y.is_multiple_of(PLANK_WIDTH) || along.is_multiple_of(PLANK_LENGTH);
    if joint {
        return [70, 48, 32];
    }
    let tone = (hash(row, plank, 2) % 44) as i32 - 22;
    let grain = noise(along, y) - 128;
    let shade =
        |base: i32, grain_percent: i32| (base + tone + grain * grain_percent / 100).clamp(0, 255) as u8;
    [shade(176, 22), shade(128, 20), shade(84, 16)]
}

/// Returns value noise in 0..=255, stretched along the planks and periodic over the texture.
fn noise(x: u32, y: u32) -> i32 {
    let [gx, gy] = GRAIN;
    let knot = |i: u32, j: u32| (hash(i % (SIZE / gx), j % (SIZE / gy), 3) & 255) as i32;
    let (i, j) = (x / gx, y / gy);
    let (fx, fy) = ((x % gx) as i32, (y % gy) as i32);
    let (gx, gy) = (gx as i32, gy as i32);
    let upper = knot(i, j) * (gx - fx) + knot(i + 1, j) * fx;
    let lower = knot(i, j + 1) * (gx - fx) + knot(i + 1, j + 1) * fx;
    (upper * (gy - fy) + lower * fy) / (gx * gy)
}

/// Scrambles three numbers (the finaliser of MurmurHash3).
fn hash(a: u32, b: u32, salt: u32) -> u32 {
    let mut h = a.wrapping_mul(0x9e37_79b1) ^ b.wrapping_mul(0x85eb_ca77) ^ salt.wrapping_mul(0xc2b2_ae3d);
    h = (h ^ h >> 16).wrapping_mul(0x85eb_ca6b);
    h = (h ^ h >> 13).wrapping_mul(0xc2b2_ae35);
    h ^ h >> 16
}
