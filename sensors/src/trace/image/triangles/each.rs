//! Triangles one after the other, each block by block.

use super::{inside, splat};
use crate::optics::rays::{Projection, Rectangles, min};
use crate::simd::WIDTH;
use crate::trace::image::leaf::Rules;
use crate::trace::image::set_up::Setup;
use crate::trace::image::target::Target;
use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x16, u32x16};

/// Rectangles of up to this many blocks are drawn without first checking which blocks the triangle touches.
const FEW_BLOCKS: usize = 6;

/// The data of sixteen triangles that a drawing loop needs.
struct Spilled {
    edges: [[[f32; WIDTH]; 3]; 3],
    inverse: [[f32; WIDTH]; 3],
    /// Upper bounds on 1/t.
    nearest: [f32; WIDTH],
    slots: [u32; WIDTH],
    columns: [[i32; WIDTH]; 2],
    rows: [[i32; WIDTH]; 2],
}

/// Draws triangles one after the other, for `some` of the rectangles. `nearest` are upper bounds on 1/t.
#[inline(always)]
pub(super) fn draw_each<S: Simd, P: Projection>(
    simd: S,
    projection: P,
    target: &mut Target<'_>,
    rules: Rules,
    setup: &Setup<S>,
    rectangles: &Rectangles<S>,
    nearest: f32x16<S>,
) {
    let mut spilled = Spilled {
        edges: [[[0.0; WIDTH]; 3]; 3],
        inverse: [[0.0; WIDTH]; 3],
        nearest: [0.0; WIDTH],
        slots: [0; WIDTH],
        columns: [[0; WIDTH]; 2],
        rows: [[0; WIDTH]; 2],
    };
    for axis in 0..3 {
        setup.edges[0][axis].store_array(&mut spilled.edges[0][axis]);
        setup.edges[1][axis].store_array(&mut spilled.edges[1][axis]);
        setup.edges[2][axis].store_array(&mut spilled.edges[2][axis]);
        setup.inverse[axis].store_array(&mut spilled.inverse[axis]);
    }
    nearest.store_array(&mut spilled.nearest);
    setup.slots.store_array(&mut spilled.slots);
    rectangles.first_column.store_array(&mut spilled.columns[0]);
    rectangles.last_column.store_array(&mut spilled.columns[1]);
    rectangles.first_row.store_array(&mut spilled.rows[0]);
    rectangles.last_row.store_array(&mut spilled.rows[1]);
    let mut lanes = rectangles.some.to_bitmask();
    while lanes != 0 {
        let lane = lanes.trailing_zeros() as usize & (WIDTH - 1);
        lanes &= lanes - 1;
        draw_one(simd, projection, target, rules, spilled.slots[lane], &spilled, lane);
    }
}

/// Draws one triangle, block by block.
#[inline(always)]
fn draw_one<S: Simd, P: Projection>(
    simd: S,
    projection: P,
    target: &mut Target<'_>,
    rules: Rules,
    slot: u32,
    spilled: &Spilled,
    lane: usize,
) {
    let ray_grid = projection.ray_grid();
    let blocks_across = ray_grid.blocks_across();
    let nearest = spilled.nearest[lane];
    let pieces = ray_grid.pieces([spilled.columns[0][lane], spilled.columns[1][lane]]);
    let block_rows = (spilled.rows[0][lane] >> ray_grid.shift_y) as usize
        ..=(spilled.rows[1][lane] >> ray_grid.shift_y) as usize;
    let plane = |plane: &[[f32; WIDTH]; 3]| [plane[0][lane], plane[1][lane], plane[2][lane]];
    let edges = [plane(&spilled.edges[0]), plane(&spilled.edges[1]), plane(&spilled.edges[2])];
    let inverse = plane(&spilled.inverse);
    for [first, last] in pieces {
        if first > last {
            continue;
        }
        let (first, last) = ((first >> ray_grid.shift_x) as usize, (last >> ray_grid.shift_x) as usize);
        let blocks = (last - first + 1) * (block_rows.end() - block_rows.start() + 1);
        for row in block_rows.clone() {
            let start = (row - rules.first_block_row) * blocks_across;
            if blocks <= FEW_BLOCKS {
                for column in first..=last {
                    if target.farthest[start + column] < nearest {
                        draw_block(
                            simd,
                            projection,
                            target,
                            rules,
                            slot,
                            &edges,
                            &inverse,
                            [column, row],
                            start + column,
                        );
                    }
                }
                continue;
            }
            let mut column = first;
            while column <= last {
                let farthest = f32x16::from_slice(simd, &target.farthest[start + column..][..WIDTH]);
                let mut lanes = farthest.simd_lt(f32x16::splat(simd, nearest));
                let u = projection.most_over_blocks(simd, &edges[0], column, row);
                let v = projection.most_over_blocks(simd, &edges[1], column, row);
                let w = projection.most_over_blocks(simd, &edges[2], column, row);
                let most = projection.most_over_blocks(simd, &inverse, column, row);
                lanes = lanes & min(min(u, v), w).simd_ge(f32x16::splat(simd, 0.0)) & most.simd_gt(farthest);
                let mut lanes = lanes.to_bitmask();
                if last - column < WIDTH - 1 {
                    lanes &= (2 << (last - column)) - 1;
                }
                while lanes != 0 {
                    let column = column + lanes.trailing_zeros() as usize;
                    lanes &= lanes - 1;
                    draw_block(
                        simd,
                        projection,
                        target,
                        rules,
                        slot,
                        &edges,
                        &inverse,
                        [column, row],
                        start + column,
                    );
                }
                column += WIDTH;
            }
        }
    }
}

/// Tests the rays of a block against one triangle.
#[allow(clippy::too_many_arguments, reason = "the pieces of one kernel")]
#[inline(always)]
fn draw_block<S: Simd, P: Projection>(
    simd: S,
    projection: P,
    target: &mut Target<'_>,
    rules: Rules,
    slot: u32,
    edges: &[[f32; 3]; 3],
    inverse: &[f32; 3],
    [column, row]: [usize; 2],
    block: usize,
) {
    let directions = projection.block(simd, column, row);
    let edges = [splat(simd, &edges[0]), splat(simd, &edges[1]), splat(simd, &edges[2])];
    let (hit, inverse) = inside::<S, P>(&edges, &splat(simd, inverse), &directions, rules.inverse_near);
    let so_far = f32x16::load_array_ref(simd, &target.inverse[block]);
    let hit = hit & inverse.simd_gt(so_far);
    // A lidar's blocks span wide angles, and many are not hit after all (S1/R3 5 % faster, R4 3 %); a camera's blocks
    // are nearly always hit (S3/R1 10 % slower).
    if P::HAS_STRIPS && !hit.any_true() {
        return;
    }
    let nearest = hit.select(inverse, so_far);
    nearest.store_array(&mut target.inverse[block]);
    let slots = u32x16::load_array_ref(simd, &target.slot[block]);
    hit.select(u32x16::splat(simd, slot), slots).store_array(&mut target.slot[block]);
    target.farthest[block] = simd.reduce_min_f32x16(nearest);
}
