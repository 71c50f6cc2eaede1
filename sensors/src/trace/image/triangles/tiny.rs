//! Tiny triangles, sixteen side by side.

use super::inside;
use crate::optics::rays::{Projection, Rectangles};
use crate::simd::WIDTH;
use crate::trace::image::leaf::Rules;
use crate::trace::image::set_up::Setup;
use crate::trace::image::target::Target;
use fearless_simd::{Select, Simd, SimdBase, SimdMask, i32x16, mask32x16};

/// Triangles whose rectangle holds up to that many rays are drawn side by side, each in its lane …
pub(super) const TINY_TRIANGLE: i32 = 12;
/// … if there are at least that many of them.
pub(super) const TINY_TRIANGLES: u32 = 3;

/// Tiny triangles side by side, each lane going through the rays of its own rectangle.
#[allow(clippy::too_many_arguments, reason = "the pieces of one kernel")]
#[inline(always)]
pub(super) fn draw_tiny<S: Simd, P: Projection>(
    simd: S,
    projection: P,
    target: &mut Target<'_>,
    rules: Rules,
    setup: &Setup<S>,
    rectangles: &Rectangles<S>,
    tiny: mask32x16<S>,
    area: i32x16<S>,
) {
    let fan = projection.fan();
    let blocks_across = fan.blocks_across();
    let zero = i32x16::splat(simd, 0);
    let steps = simd.reduce_max_i32x16(tiny.select(area, zero));
    let (mut columns, mut rows) = (rectangles.first_column, rectangles.first_row);
    let mut drawing = tiny;
    let mut touched = 0;
    let mut slots = [0; WIDTH];
    setup.slots.store_array(&mut slots);
    let (mut at_column, mut at_row, mut at_inverse) = ([0_i32; WIDTH], [0_i32; WIDTH], [0.0_f32; WIDTH]);
    for _ in 0..steps {
        let directions = projection.rays(simd, columns, rows);
        let (hit, inverse) = inside::<S, P>(&setup.edges, &setup.inverse, &directions, rules.inverse_near);
        let mut hits = (hit & drawing).to_bitmask();
        touched |= hits;
        if hits != 0 {
            columns.store_array(&mut at_column);
            rows.store_array(&mut at_row);
            inverse.store_array(&mut at_inverse);
            while hits != 0 {
                let triangle = hits.trailing_zeros() as usize & (WIDTH - 1);
                hits &= hits - 1;
                let (column, row) = (at_column[triangle], at_row[triangle]);
                let block_row = (row >> fan.shift_y) as usize - rules.first_block_row;
                let block = block_row * blocks_across + (column >> fan.shift_x) as usize;
                let lane = fan.lane(column, row);
                let (nearest, slot) = (&mut target.inverse[block][lane], &mut target.slot[block][lane]);
                let nearer = at_inverse[triangle] > *nearest;
                *nearest = if nearer { at_inverse[triangle] } else { *nearest };
                *slot = if nearer { slots[triangle] } else { *slot };
            }
        }
        // On to the next ray: to the right, then down.
        columns += 1;
        let past = columns.simd_gt(rectangles.last_column);
        columns = past.select(rectangles.first_column, columns);
        rows = past.select(rows + 1, rows);
        drawing &= rows.simd_le(rectangles.last_row);
    }
    if touched == 0 {
        return;
    }
    let touched = mask32x16::from_bitmask(simd, touched);
    let most = i32x16::splat(simd, i32::MAX);
    let first_column = simd.reduce_min_i32x16(touched.select(rectangles.first_column, most)) >> fan.shift_x;
    let last_column = simd.reduce_max_i32x16(touched.select(rectangles.last_column, zero)) >> fan.shift_x;
    let first_row = simd.reduce_min_i32x16(touched.select(rectangles.first_row, most)) >> fan.shift_y;
    let last_row = simd.reduce_max_i32x16(touched.select(rectangles.last_row, zero)) >> fan.shift_y;
    // If they lie far apart, what is behind them is merely not left out.
    if (last_column - first_column + 1) * (last_row - first_row + 1) <= 64 {
        for row in first_row..=last_row {
            let first = (row as usize - rules.first_block_row) * blocks_across;
            for column in first_column..=last_column {
                target.update_farthest(first + column as usize);
            }
        }
    }
}
