//! Sixteen triangles against the blocks of a grid with few rows, where a block is sixteen rays of one row.
//!
//! Such rays are in a narrow arc, so two planes enclose them tightly, and the least and greatest value of a triangle's
//! own planes over them are known closely: for each block, all but a few of the sixteen triangles are excluded at once.
//! The remaining ones are either each tested against the sixteen rays, or each ray is tested against all of them,
//! whichever takes fewer steps. No triangle needs a rectangle of its own.

use super::leaf::{Leaf, Rules};
use super::set_up::{facing, set_up};
use super::sharp::PlaneArrays;
use super::target::Target;
use super::triangles::{inside, splat};
use crate::optics::rays::RayGrid;
use crate::optics::rays::{Planes, Points, Projection, max, min};
use crate::simd::WIDTH;
use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x16, i32x16, mask32x16, u32x16};

/// Leaves that cover fewer rays are better tested ray by ray …
const FEWEST_RAYS: i32 = 4;
/// … and leaves that cover more blocks triangle by triangle, each with its own rectangle.
const MOST_BLOCKS: usize = 24;
/// Up to this many triangles are tested against a block without first comparing their bounds with its own.
const FEW_TRIANGLES: u32 = 2;

/// Columns of a strip.
const COLUMNS: [i32; WIDTH] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];

/// Returns true if a leaf is suitable for [`draw`].
#[inline(always)]
pub(super) fn suits<S: Simd, P: Projection>(projection: &P, leaf: &Leaf<'_, S>) -> bool {
    let ray_grid = projection.ray_grid();
    if !is_one::<P>(ray_grid) {
        return false;
    }
    let (across, rows) = (leaf.columns[1] - leaf.columns[0] + 1, leaf.rows[1] - leaf.rows[0] + 1);
    let blocks = ((leaf.columns[1] >> ray_grid.shift_x) - (leaf.columns[0] >> ray_grid.shift_x) + 1) * rows;
    across * rows >= FEWEST_RAYS && blocks as usize <= MOST_BLOCKS
}

/// Returns true if the blocks of a grid are strips: sixteen rays of a row.
#[inline(always)]
pub(super) fn is_one<P: Projection>(ray_grid: &RayGrid) -> bool {
    P::HAS_STRIPS && ray_grid.shift_y == 0
}

/// The lanes of a strip from the first to the last of `columns`.
#[inline(always)]
fn asked<S: Simd>(simd: S, columns: [i32; 2], strip: usize) -> mask32x16<S> {
    let here = i32x16::load_array_ref(simd, &COLUMNS) + (strip * WIDTH) as i32;
    here.simd_ge(i32x16::splat(simd, columns[0])) & here.simd_le(i32x16::splat(simd, columns[1]))
}

/// Draws a leaf into the target.
#[inline(always)]
pub(super) fn draw<S: Simd, P: Projection>(
    simd: S,
    projection: P,
    target: &mut Target<'_>,
    rules: Rules,
    leaf: &Leaf<'_, S>,
) {
    let ray_grid = projection.ray_grid();
    let blocks_across = ray_grid.blocks_across();
    let pieces = ray_grid.pieces(leaf.columns);
    let first = [(leaf.columns[0] >> ray_grid.shift_x) as usize, leaf.rows[0] as usize];
    let last = [(leaf.columns[1] >> ray_grid.shift_x) as usize, leaf.rows[1] as usize];
    // For a leaf over one block, as most are, triangles that no ray hits need not be set up at all.
    let single = first == last;
    let mut valid = mask32x16::splat(simd, true);
    if single {
        valid = crossing(simd, projection, leaf.corners, first);
        if !valid.any_true() {
            return;
        }
    }
    let setup = set_up(simd, leaf, rules);
    let blurred = setup.blurred & valid;
    valid &= setup.valid;
    if !(valid | blurred).any_true() {
        return;
    }
    let mut planes = setup.spill();
    if blurred.any_true() {
        leaf.source.sharpen(blurred.to_bitmask(), &mut planes);
        valid |= facing(rules, planes.sides_of(simd)) & blurred;
    }
    let mut triangle_slots = [0; WIDTH];
    setup.slots.store_array(&mut triangle_slots);
    let [a, b, c] = &planes.edges;
    for row in leaf.rows[0] as usize..=leaf.rows[1] as usize {
        let start = (row - rules.first_block_row) * blocks_across;
        for [first, last] in pieces {
            if first > last {
                continue;
            }
            for column in (first >> ray_grid.shift_x) as usize..=(last >> ray_grid.shift_x) as usize {
                let block = start + column;
                if target.farthest[block] >= leaf.nearest {
                    continue;
                }
                let inverse = f32x16::load_array_ref(simd, &target.inverse[block]);
                let asked = asked(simd, [first, last], column);
                let farthest = simd.reduce_min_f32x16(asked.select(inverse, f32x16::splat(simd, f32::MAX)));
                if farthest >= leaf.nearest {
                    continue;
                }
                let mut reached = valid;
                if !single {
                    reached &= crossing(simd, projection, leaf.corners, [column, row]);
                }
                if reached.to_bitmask().count_ones() > FEW_TRIANGLES {
                    let most = |plane| projection.most_over_strip(simd, &load(simd, plane), column, row);
                    reached &= min(min(most(a), most(b)), most(c)).simd_ge(f32x16::splat(simd, 0.0))
                        & most(&planes.inverse).simd_gt(f32x16::splat(simd, farthest));
                }
                let mut lanes = reached.to_bitmask();
                if lanes == 0 {
                    continue;
                }
                let open = (asked & inverse.simd_lt(f32x16::splat(simd, leaf.nearest))).to_bitmask();
                if open.count_ones() < lanes.count_ones() {
                    let place = [column, row, block];
                    each_ray(
                        simd,
                        projection,
                        target,
                        rules,
                        (&planes, &triangle_slots),
                        reached,
                        open,
                        place,
                    );
                    continue;
                }
                let mut nearest = inverse;
                let mut slots = u32x16::load_array_ref(simd, &target.slot[block]);
                let directions = projection.block(simd, column, row);
                while lanes != 0 {
                    let lane = lanes.trailing_zeros() as usize & (WIDTH - 1);
                    lanes &= lanes - 1;
                    let plane = |[x, y, z]: &[[f32; WIDTH]; 3]| splat(simd, &[x[lane], y[lane], z[lane]]);
                    let edges = [plane(a), plane(b), plane(c)];
                    let (hit, inverse) =
                        inside::<S, P>(&edges, &plane(&planes.inverse), &directions, rules.inverse_near);
                    let hit = hit & inverse.simd_gt(nearest);
                    nearest = hit.select(inverse, nearest);
                    slots = hit.select(u32x16::splat(simd, triangle_slots[lane]), slots);
                }
                nearest.store_array(&mut target.inverse[block]);
                slots.store_array(&mut target.slot[block]);
                target.farthest[block] = simd.reduce_min_f32x16(nearest);
            }
        }
    }
}

/// Tests each ray of a block that is in `open` against the triangles in `reached`.
#[allow(clippy::too_many_arguments, reason = "the pieces of one kernel")]
#[inline(always)]
fn each_ray<S: Simd, P: Projection>(
    simd: S,
    projection: P,
    target: &mut Target<'_>,
    rules: Rules,
    (planes, triangle_slots): (&PlaneArrays, &[u32; WIDTH]),
    reached: mask32x16<S>,
    mut open: u64,
    [column, row, block]: [usize; 3],
) {
    let [a, b, c] = &planes.edges;
    let edges = [load(simd, a), load(simd, b), load(simd, c)];
    let plane = load(simd, &planes.inverse);
    while open != 0 {
        let lane = open.trailing_zeros() as usize & (WIDTH - 1);
        open &= open - 1;
        let directions = projection.ray(simd, (column * WIDTH + lane) as i32, row as i32);
        let (hit, inverse) = inside::<S, P>(&edges, &plane, &directions, rules.inverse_near);
        let so_far = &mut target.inverse[block][lane];
        let hit = hit & reached & inverse.simd_gt(f32x16::splat(simd, *so_far));
        if hit.any_true() {
            let candidates = hit.select(inverse, f32x16::splat(simd, 0.0));
            *so_far = simd.reduce_max_f32x16(candidates);
            let winner = candidates.simd_eq(f32x16::splat(simd, *so_far)).to_bitmask();
            target.slot[block][lane] = triangle_slots[winner.trailing_zeros() as usize & (WIDTH - 1)];
        }
    }
    target.update_farthest(simd, block);
}

/// The triangles that are not entirely above or below the rays of a block.
#[inline(always)]
fn crossing<S: Simd, P: Projection>(
    simd: S,
    projection: P,
    corners: &[Points<S>; 3],
    [column, row]: [usize; 2],
) -> mask32x16<S> {
    let Some([below, above]) = projection.slab(column, row) else {
        return mask32x16::splat(simd, true);
    };
    min(farthest(corners, below), farthest(corners, above)).simd_ge(f32x16::splat(simd, 0.0))
}

/// The greatest of the dot products of a plane with the corners.
#[inline(always)]
fn farthest<S: Simd>([a, b, c]: &[Points<S>; 3], [x, y, z]: [f32; 3]) -> f32x16<S> {
    let a = (a[0] * x + a[1] * y) + a[2] * z;
    let b = (b[0] * x + b[1] * y) + b[2] * z;
    let c = (c[0] * x + c[1] * y) + c[2] * z;
    max(max(a, b), c)
}

#[inline(always)]
fn load<S: Simd>(simd: S, plane: &[[f32; WIDTH]; 3]) -> Planes<S> {
    [
        f32x16::load_array_ref(simd, &plane[0]),
        f32x16::load_array_ref(simd, &plane[1]),
        f32x16::load_array_ref(simd, &plane[2]),
    ]
}
