//! Sixty-four neighbouring rays of a traced band, as the sensors work on them: tiles of 16 × 4 pixels.

use super::grid::Band;
use super::image::{GRAZING, NO_HIT, Projection};
use super::packet::{MISS, Packet};
use super::resolve::Resolver;
use crate::scene::tree::WIDTH;
use crate::simd::{LANES, Lanes};
use glam::DMat3;

/// Pixels across a tile.
pub(crate) const TILE_WIDTH: usize = 16;
/// Pixels down a tile.
pub(crate) const TILE_HEIGHT: usize = LANES / TILE_WIDTH;

/// Takes the hits of a tile out of a band: t, instance and triangle of each ray, row after row, and the
/// directions in the axes of the world. Rays outside the grid miss.
#[inline(always)]
pub(crate) fn take_tile<P: Projection>(
    band: &Band<'_, P>,
    resolver: &mut Resolver<'_>,
    axes: &DMat3,
    [tile_column, block_row]: [usize; 2],
    packet: &mut Packet,
) {
    let fan = band.projection.fan();
    let first_row = block_row - *band.block_rows().start();
    packet.placed = [MISS; LANES];
    packet.t = [f64::INFINITY; LANES];
    for part in 0..TILE_WIDTH / 4 {
        let column = tile_column * (TILE_WIDTH / 4) + part;
        if column >= fan.blocks_across() {
            break;
        }
        let block = first_row * fan.blocks_across() + column;
        let directions = band.projection.exact_block(column, block_row);
        let (slots, inverse) = (&band.target.slot[block], &band.target.inverse[block]);
        // Worked out in a row, then put in their places four at a time.
        let place = |values: &[f64; WIDTH], lanes: &mut Lanes<f64>| {
            for line in 0..TILE_HEIGHT {
                let first = line * TILE_WIDTH + part * 4;
                lanes[first..first + 4].copy_from_slice(&values[line * 4..line * 4 + 4]);
            }
        };
        for axis in 0..3 {
            let mut turned = [0.0; WIDTH];
            for lane in 0..WIDTH {
                turned[lane] = axes.x_axis[axis] * directions[0][lane]
                    + axes.y_axis[axis] * directions[1][lane]
                    + axes.z_axis[axis] * directions[2][lane];
            }
            place(&turned, &mut packet.direction[axis]);
        }
        let mut t = [0.0; WIDTH];
        for lane in 0..WIDTH {
            let hit = 1.0 / f64::from(inverse[lane]);
            t[lane] = if slots[lane] == NO_HIT { f64::INFINITY } else { hit };
        }
        place(&t, &mut packet.t);
        for lane in 0..WIDTH {
            let to = (lane / 4) * TILE_WIDTH + part * 4 + lane % 4;
            if slots[lane] == NO_HIT {
                continue;
            }
            let hit = resolver.hit(slots[lane]);
            packet.placed[to] = hit.placed;
            packet.local[to] = hit.local;
            if slots[lane] & GRAZING != 0 {
                let direction = packet.direction_of(to);
                let unit = direction.normalize().as_vec3().to_array();
                if resolver.grazes(&hit, unit) {
                    packet.t[to] = resolver.exact(&hit, direction, packet.t[to]);
                }
            }
        }
    }
}
