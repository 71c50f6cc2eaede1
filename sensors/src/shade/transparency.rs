//! Transparency: rays continue behind clear surfaces, and what they hit there is shaded and blended.
//!
//! Only pixels that show a clear surface are traced again, 64 at a time from the point that was hit, in double
//! precision. Scenes without such surfaces therefore only pay for one comparison per tile.

use super::tile::{Steps, Tile};
use super::{Colours, Shader};
use crate::simd::{LANES, Lanes};
use crate::trace::grid::Sight;
use crate::trace::hit::resolve::Resolver;
use crate::trace::packet::hits::first_hits;
use crate::trace::packet::{MISS, Packet};
use crate::trace::placed::view::View;
use fearless_simd::Simd;

/// Number of surfaces visible behind the first; the last one is opaque.
const SURFACES: usize = 4;
/// Rays continue behind a surface at this fraction of the distance to it, which exceeds the rounding error of single
/// precision.
const GAP: f64 = 1e-5;
/// If less than this fraction of the light is left, the ray is not continued: a quarter of a step of 8 bits.
const LEAST: f32 = 1.0 / 1024.0;

/// Adds what is seen behind the clear surfaces of a tile to its colours, which `shader` has just computed. The
/// directions of the tile and its lanes without a ray stay unchanged.
#[inline(never)]
pub(crate) fn look<S: Simd>(
    simd: S,
    view: &View<'_>,
    sight: &Sight,
    (shader, resolver, steps): (&mut Shader, &mut Resolver<'_>, &Steps),
    tile: &mut Tile,
    colours: &mut Colours,
) {
    simd.vectorize(
        #[inline(always)]
        || look_behind(simd, view, sight, (shader, resolver, steps), tile, colours),
    );
}

#[inline(always)]
fn look_behind<S: Simd>(
    simd: S,
    view: &View<'_>,
    sight: &Sight,
    (shader, resolver, steps): (&mut Shader, &mut Resolver<'_>, &Steps),
    tile: &mut Tile,
    colours: &mut Colours,
) {
    let mut behind = [[0.0; LANES]; 3];
    let missing = tile.missing;
    let mut seen = shader.seen;
    // The share of the light that comes from farther behind.
    let mut share = [0.0; LANES];
    for lane in 0..LANES {
        let coverage = if shader.clear >> lane & 1 != 0 { shader.coverage[lane] } else { 1.0 };
        share[lane] = 1.0 - coverage;
        for channel in colours.iter_mut() {
            channel[lane] *= coverage;
        }
    }
    let (mut t, mut placed, mut triangle) = (tile.t, tile.placed, tile.local);
    for surface in 1..=SURFACES {
        let (packet, local) = shader.rays();
        let start = aim(packet, &tile.direction, &t, &share, sight.range[1]);
        if !packet.is_active() {
            break;
        }
        first_hits(simd, view, packet, local, sight.faces);
        for lane in 0..LANES {
            packet.t[lane] += start[lane];
        }
        tile.take_first_hits(simd, packet, resolver);
        shader.shade(simd, view, tile, steps, &mut behind);
        for lane in 0..LANES {
            if share[lane] <= LEAST {
                continue;
            }
            let is_hit = tile.hits >> lane & 1 != 0;
            // A ray that hits the surface that it has just left has not got behind it.
            let again = is_hit && (placed[lane], triangle[lane]) == (tile.placed[lane], tile.local[lane]);
            let clear = shader.clear >> lane & 1 != 0;
            let coverage = match clear {
                _ if surface == SURFACES => 1.0,
                _ if again => 0.0,
                true => shader.coverage[lane],
                false => 1.0,
            };
            for channel in 0..3 {
                colours[channel][lane] += share[lane] * coverage * behind[channel][lane];
            }
            share[lane] *= 1.0 - coverage;
            (t[lane], placed[lane], triangle[lane]) = (tile.t[lane], tile.placed[lane], tile.local[lane]);
            if let (Some(seen), Some(own)) = (&mut seen, &shader.seen) {
                seen[lane] = ((seen[lane] * 5) ^ own[lane]) & 0x7f;
            }
        }
    }
    shader.seen = seen;
    tile.missing = missing;
}

/// Continues the rays of lanes that have light left behind t, and returns their starting positions.
#[inline(always)]
fn aim(
    packet: &mut Packet,
    direction: &[Lanes<f32>; 3],
    t: &Lanes<f32>,
    share: &Lanes<f32>,
    farthest: f64,
) -> Lanes<f64> {
    let mut start = [0.0; LANES];
    for lane in 0..LANES {
        start[lane] = f64::from(t[lane]) * (1.0 + GAP);
    }
    for axis in 0..3 {
        for lane in 0..LANES {
            let along = f64::from(direction[axis][lane]);
            packet.direction[axis][lane] = along;
            packet.origin[axis][lane] = along * start[lane];
        }
    }
    packet.shared_origin = false;
    packet.t_min = 0.0;
    packet.hit = [MISS; LANES];
    for lane in 0..LANES {
        packet.t[lane] = if share[lane] > LEAST { farthest - start[lane] } else { f64::NEG_INFINITY };
    }
    start
}
