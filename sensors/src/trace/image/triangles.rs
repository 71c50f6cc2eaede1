//! Sixteen triangles against the rays of a rectangle of the grid.
//!
//! One of three loops draws them, depending on the number of rays that they cover: ray by ray against all sixteen, side
//! by side with a triangle in each lane, or triangle by triangle.

mod each;
mod tiny;

use super::leaf::{Leaf, Rules};
use super::set_up::{Setup, facing, set_up};
use super::sharp::Source;
use super::target::Target;
use crate::optics::rays::{Planes, Points, Projection, min};
use crate::simd::WIDTH;
use each::draw_each;
use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x16, i32x16, mask32x16};
use tiny::{TINY_TRIANGLE, TINY_TRIANGLES, draw_tiny};

/// In grid rectangles of up to this many rays, each ray is tested against all sixteen triangles.
const FEW_RAYS: i32 = 16;

/// Draws the blurred triangles of a leaf, with planes in double precision. This is a separate function that copies its
/// inputs, so that the usual path keeps its values in registers.
#[cold]
#[inline(never)]
pub(super) fn draw_blurred<S: Simd, P: Projection>(
    simd: S,
    projection: P,
    target: &mut Target<'_>,
    rules: Rules,
    (source, corners, nearest): (Source<'_>, [Points<S>; 3], f32),
    mut setup: Setup<S>,
) {
    simd.vectorize(
        #[inline(always)]
        || {
            sharpen(simd, &source, rules, &mut setup);
            let (mut rectangles, _) = projection.bound_triangles(simd, &corners, setup.valid);
            rectangles.some &= setup.valid;
            let nearest = f32x16::splat(simd, nearest);
            draw_each(simd, projection, target, rules, &setup, &rectangles, nearest);
        },
    );
}

/// Recomputes the planes of the blurred triangles, and marks as valid those that face the sensor.
#[inline(always)]
fn sharpen<S: Simd>(simd: S, source: &Source<'_>, rules: Rules, setup: &mut Setup<S>) {
    let mut planes = setup.spill();
    source.sharpen(setup.blurred.to_bitmask(), &mut planes);
    for axis in 0..3 {
        for edge in 0..3 {
            setup.edges[edge][axis] = f32x16::load_array_ref(simd, &planes.edges[edge][axis]);
        }
        setup.inverse[axis] = f32x16::load_array_ref(simd, &planes.inverse[axis]);
    }
    setup.valid = facing(rules, planes.sides_of(simd)) & setup.blurred;
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
    let setup = set_up(simd, leaf, rules);
    if setup.blurred.any_true() {
        draw_blurred(simd, projection, target, rules, (leaf.source, *leaf.corners, leaf.nearest), setup);
    }
    if !setup.valid.any_true() {
        return;
    }
    let rays = (leaf.columns[1] - leaf.columns[0] + 1) * (leaf.rows[1] - leaf.rows[0] + 1);
    if rays <= FEW_RAYS {
        draw_few_rays(simd, projection, target, rules, leaf, &setup);
        return;
    }
    let (mut rectangles, nearest) = projection.bound_triangles(simd, leaf.corners, setup.valid);
    let mut rest = setup.valid & rectangles.some;
    if !rest.any_true() {
        return;
    }
    let width = projection.ray_grid().width;
    let across = rectangles.last_column - rectangles.first_column + 1;
    let down = rectangles.last_row - rectangles.first_row + 1;
    let area = across * down;
    let tiny = rest
        & area.simd_le(i32x16::splat(simd, TINY_TRIANGLE))
        & rectangles.last_column.simd_lt(i32x16::splat(simd, width));
    if tiny.to_bitmask().count_ones() >= TINY_TRIANGLES {
        rest &= !tiny;
        draw_tiny(simd, projection, target, rules, &setup, &rectangles, tiny, area);
        if !rest.any_true() {
            return;
        }
    }
    rectangles.some = rest;
    let nearest = min(nearest, f32x16::splat(simd, leaf.nearest));
    draw_each(simd, projection, target, rules, &setup, &rectangles, nearest);
}

/// The lanes in which a ray is inside all three edges and its 1/t counts.
#[inline(always)]
pub(super) fn inside<S: Simd, P: Projection>(
    edges: &[Planes<S>; 3],
    inverse: &Planes<S>,
    directions: &P::Directions<S>,
    inverse_near: f32,
) -> (mask32x16<S>, f32x16<S>) {
    let u = P::dot(&edges[0], directions);
    let v = P::dot(&edges[1], directions);
    let w = P::dot(&edges[2], directions);
    let inverse = P::dot(inverse, directions);
    let simd = inverse.simd;
    let hit = min(min(u, v), w).simd_ge(f32x16::splat(simd, 0.0))
        & inverse.simd_le(f32x16::splat(simd, inverse_near));
    (hit, inverse)
}

/// Tests each ray against all sixteen triangles.
#[inline(always)]
fn draw_few_rays<S: Simd, P: Projection>(
    simd: S,
    projection: P,
    target: &mut Target<'_>,
    rules: Rules,
    leaf: &Leaf<'_, S>,
    setup: &Setup<S>,
) {
    let ray_grid = projection.ray_grid();
    let blocks_across = ray_grid.blocks_across();
    for row in leaf.rows[0]..=leaf.rows[1] {
        let block_row = (row >> ray_grid.shift_y) as usize - rules.first_block_row;
        for column in leaf.columns[0]..=leaf.columns[1] {
            let column = if column >= ray_grid.width { column - ray_grid.width } else { column };
            let block = block_row * blocks_across + (column >> ray_grid.shift_x) as usize;
            let lane = ray_grid.lane(column, row);
            let so_far = target.inverse[block][lane];
            if so_far >= leaf.nearest {
                continue;
            }
            let directions = projection.ray(simd, column, row);
            let (hit, inverse) =
                inside::<S, P>(&setup.edges, &setup.inverse, &directions, rules.inverse_near);
            let hit = hit & setup.valid & inverse.simd_gt(f32x16::splat(simd, so_far));
            if hit.any_true() {
                let candidates = hit.select(inverse, f32x16::splat(simd, 0.0));
                let nearest = simd.reduce_max_f32x16(candidates);
                let winner = candidates.simd_eq(f32x16::splat(simd, nearest)).to_bitmask().trailing_zeros();
                target.inverse[block][lane] = nearest;
                target.slot[block][lane] = setup.slots[winner as usize & (WIDTH - 1)];
                target.update_farthest(simd, block);
            }
        }
    }
}

#[inline(always)]
pub(super) fn splat<S: Simd>(simd: S, plane: &[f32; 3]) -> Planes<S> {
    [f32x16::splat(simd, plane[0]), f32x16::splat(simd, plane[1]), f32x16::splat(simd, plane[2])]
}
