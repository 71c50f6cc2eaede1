//! Tiny triangles, sixteen side by side.

use super::inside;
use crate::optics::rays::{Projection, Rectangles};
use crate::simd::WIDTH;
use crate::trace::image::leaf::Rules;
use crate::trace::image::set_up::Setup;
use crate::trace::image::target::Target;
use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x16, i32x16, mask32x16};

/// Triangles whose rectangle has up to this many rays are drawn side by side, each in its lane …
pub(super) const TINY_TRIANGLE: i32 = 12;
/// … if there are at least this many of them.
pub(super) const TINY_TRIANGLES: u32 = 3;

/// The number of rays that each lane processes before hits are stored: as many as have one bit each in a word.
const STEPS: usize = 4;

/// Draws tiny triangles side by side; each lane processes the rays of its own rectangle.
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
    let ray_grid = projection.ray_grid();
    let blocks_across = ray_grid.blocks_across();
    let zero = i32x16::splat(simd, 0);
    let steps = simd.reduce_max_i32x16(tiny.select(area, zero));
    let (mut columns, mut rows) = (rectangles.first_column, rectangles.first_row);
    let mut drawing = tiny;
    let mut touched = 0;
    // The branch on hits is hard to predict, so it is taken once for several steps.
    for _ in 0..(steps as u32).div_ceil(STEPS as u32) {
        let mut hits = 0;
        let (mut places, mut inverses) = ([zero; STEPS], [f32x16::splat(simd, 0.0); STEPS]);
        for step in 0..STEPS {
            let directions = projection.rays(simd, columns, rows);
            let (hit, inverse) =
                inside::<S, P>(&setup.edges, &setup.inverse, &directions, rules.inverse_near);
            hits |= (hit & drawing).to_bitmask() << (step * WIDTH);
            places[step] = ray_grid.places(columns, rows, rules.first_block_row);
            inverses[step] = inverse;
            // Go to the next ray: to the right, then down.
            columns += 1;
            let past = columns.simd_gt(rectangles.last_column);
            columns = past.select(rectangles.first_column, columns);
            rows = past.select(rows + 1, rows);
            drawing &= rows.simd_le(rectangles.last_row);
        }
        touched |= hits;
        while hits != 0 {
            let at = hits.trailing_zeros() as usize % (STEPS * WIDTH);
            hits &= hits - 1;
            let (step, triangle) = (at / WIDTH, at % WIDTH);
            let place = places[step][triangle] as usize;
            let nearest = &mut target.inverse.as_flattened_mut()[place];
            if inverses[step][triangle] > *nearest {
                *nearest = inverses[step][triangle];
                target.slot.as_flattened_mut()[place] = setup.slots[triangle];
            }
        }
    }
    if touched == 0 {
        return;
    }
    // The step in which they were touched no longer matters.
    touched |= touched >> (2 * WIDTH);
    touched |= touched >> WIDTH;
    let touched = mask32x16::from_bitmask(simd, touched);
    let most = i32x16::splat(simd, i32::MAX);
    let first_column =
        simd.reduce_min_i32x16(touched.select(rectangles.first_column, most)) >> ray_grid.shift_x;
    let last_column =
        simd.reduce_max_i32x16(touched.select(rectangles.last_column, zero)) >> ray_grid.shift_x;
    let first_row = simd.reduce_min_i32x16(touched.select(rectangles.first_row, most)) >> ray_grid.shift_y;
    let last_row = simd.reduce_max_i32x16(touched.select(rectangles.last_row, zero)) >> ray_grid.shift_y;
    // If they are far apart, `farthest` is not updated; this only hides less.
    if (last_column - first_column + 1) * (last_row - first_row + 1) <= 64 {
        for row in first_row..=last_row {
            let first = (row as usize - rules.first_block_row) * blocks_across;
            for column in first_column..=last_column {
                target.update_farthest(simd, first + column as usize);
            }
        }
    }
}
