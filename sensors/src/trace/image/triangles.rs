//! Sixteen triangles against the rays of a rectangle of the grid.
//!
//! With corners relative to the origin, the plane through it and the edge from A to B has the normal
//! (A + B) × (B − A) = 2 A × B. Written so, it changes its sign, and nothing else, when A and B change places: two
//! triangles with a common edge decide alike, and no ray slips between them. A ray is inside where all three are
//! on the same side as the triangle, and there 1/t = n·d / n·a.

use super::projection::{Planes, Points, Projection, Rectangles, max, min};
use super::sharp::{BLURRED_SQUARED, Blurred, PlaneArrays, Source, grazing_limit};
use super::target::Target;
use crate::scene::tree::WIDTH;
use crate::trace::packet::Faces;
use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x16, i32x16, mask32x16, u32x16};

/// Grid rectangles of up to that many rays are tested ray by ray against all sixteen triangles.
const FEW_RAYS: i32 = 48;
/// Triangles whose rectangle holds up to that many rays are drawn side by side, each in its lane …
const TINY_TRIANGLE: i32 = 12;
/// … if there are at least that many of them.
const TINY_TRIANGLES: u32 = 3;
/// Rectangles of up to that many blocks are drawn without asking first which blocks the triangle touches.
const FEW_BLOCKS: usize = 6;

const LANE_NUMBERS: [u32; WIDTH] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];

/// Sixteen triangles, set up to be tested.
pub(super) struct Setup<S: Simd> {
    /// Edge planes, positive inside.
    pub(super) edges: [Planes<S>; 3],
    /// Plane of 1/t.
    pub(super) inverse: Planes<S>,
    pub(super) valid: mask32x16<S>,
    /// Those that a ray may graze.
    pub(super) blurred: mask32x16<S>,
    pub(super) slots: u32x16<S>,
}

/// What a drawing loop needs of one of sixteen triangles.
struct Spilled {
    edges: [[[f32; WIDTH]; 3]; 3],
    inverse: [[f32; WIDTH]; 3],
    /// Bound of 1/t from above.
    nearest: [f32; WIDTH],
    slots: [u32; WIDTH],
    columns: [[i32; WIDTH]; 2],
    rows: [[i32; WIDTH]; 2],
}

/// A leaf to draw.
pub(super) struct Leaf<'a, S: Simd> {
    pub(super) source: Source<'a>,
    /// Corners in the sensor's frame.
    pub(super) corners: [Points<S>; 3],
    /// Slot of the first triangle; the others follow.
    pub(super) first_slot: u32,
    /// Rectangle of the grid that holds all: columns, rows.
    pub(super) columns: [i32; 2],
    pub(super) rows: [i32; 2],
    /// Bound of 1/t from above for all.
    pub(super) nearest: f32,
}

/// What counts as a hit.
#[derive(Clone, Copy)]
pub(super) struct Rules {
    pub(super) faces: Faces,
    /// The instance is mirrored: its triangles run the other way round.
    pub(super) mirrored: bool,
    /// 1/t of the nearest that counts.
    pub(super) inverse_near: f32,
    /// And t itself.
    pub(super) near: f64,
    /// First row of blocks of the target.
    pub(super) first_block_row: usize,
}

#[inline(always)]
fn cross<S: Simd>(a: &Points<S>, b: &Points<S>) -> Points<S> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[inline(always)]
fn sub<S: Simd>(a: &Points<S>, b: &Points<S>) -> Points<S> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn scale<S: Simd>(a: &Points<S>, by: f32x16<S>) -> Points<S> {
    [a[0] * by, a[1] * by, a[2] * by]
}

#[inline(always)]
fn square<S: Simd>(a: &Points<S>) -> f32x16<S> {
    (a[0] * a[0] + a[1] * a[1]) + a[2] * a[2]
}

/// Plane through the origin and the edge from a to b, times `sign`.
#[inline(always)]
fn edge<S: Simd>(a: &Points<S>, b: &Points<S>, sign: f32x16<S>) -> Planes<S> {
    let sum = [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
    cross(&sum, &scale(&sub(b, a), sign))
}

#[inline(always)]
pub(super) fn set_up<S: Simd>(simd: S, leaf: &Leaf<'_, S>, rules: Rules) -> Setup<S> {
    let [a, b, c] = &leaf.corners;
    let (ab, ac) = (sub(b, a), sub(c, a));
    let normal = cross(&ab, &ac);
    let volume = (a[0] * normal[0] + a[1] * normal[1]) + a[2] * normal[2];
    let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
    let (behind, front) = (volume.simd_gt(zero), volume.simd_lt(zero));
    let sign = behind.select(one, -one);
    let per_volume = one / volume;
    let inverse = scale(&normal, per_volume);
    let slots = u32x16::load_array_ref(simd, &LANE_NUMBERS) + leaf.first_slot;
    let edges = [edge(b, c, sign), edge(c, a, sign), edge(a, b, sign)];
    // Errors of 1/t: that of the corners, |corner| at most, by the distance of the plane, 1/|inverse|; and that of
    // the normal, |ab|·|ac|, over the extent of the triangle.
    let (ab, ac) = (square(&ab), square(&ac));
    let extent = max(ab, ac);
    let limit = f32x16::splat(simd, BLURRED_SQUARED);
    let away = square(a);
    let is_steep = ((away + extent) * square(&inverse)).simd_le(limit);
    let is_fat = (((ab * per_volume) * (ac * per_volume)) * extent).simd_le(limit);
    // 0 by 0 compares as false.
    let blurred = ab.simd_gt(zero) & ac.simd_gt(zero) & !(is_steep & is_fat);
    let mut setup = Setup { edges, inverse, valid: behind, blurred, slots };
    // What is small for its distance is blurred along grazing rays only.
    let again = blurred & !(is_fat & (extent * 4.0).simd_lt(away));
    let sides = if again.any_true() {
        sharpen(simd, leaf, &mut setup, again, [behind, front])
    } else {
        [behind, front]
    };
    let [behind, front] = sides;
    // Seen edge on, a triangle covers nothing.
    setup.valid = match (rules.faces, rules.mirrored) {
        (Faces::Both, _) => behind | front,
        (Faces::Front, false) => front,
        (Faces::Front, true) => behind,
    };
    setup
}

/// Makes the planes of the triangles in `lanes` again, and tells which are seen from behind and from the front.
#[inline(always)]
fn sharpen<S: Simd>(
    simd: S,
    leaf: &Leaf<'_, S>,
    setup: &mut Setup<S>,
    lanes: mask32x16<S>,
    [behind, front]: [mask32x16<S>; 2],
) -> [mask32x16<S>; 2] {
    let mut planes = PlaneArrays {
        edges: [[[0.0; WIDTH]; 3]; 3],
        inverse: [[0.0; WIDTH]; 3],
        behind: behind.to_bitmask(),
        front: front.to_bitmask(),
    };
    for axis in 0..3 {
        for edge in 0..3 {
            setup.edges[edge][axis].store_array(&mut planes.edges[edge][axis]);
        }
        setup.inverse[axis].store_array(&mut planes.inverse[axis]);
    }
    leaf.source.sharpen(lanes.to_bitmask(), &mut planes);
    for axis in 0..3 {
        for edge in 0..3 {
            setup.edges[edge][axis] = f32x16::load_array_ref(simd, &planes.edges[edge][axis]);
        }
        setup.inverse[axis] = f32x16::load_array_ref(simd, &planes.inverse[axis]);
    }
    [mask32x16::from_bitmask(simd, planes.behind), mask32x16::from_bitmask(simd, planes.front)]
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
    if !setup.valid.any_true() {
        return;
    }
    let rays = (leaf.columns[1] - leaf.columns[0] + 1) * (leaf.rows[1] - leaf.rows[0] + 1);
    if rays <= FEW_RAYS {
        draw_few_rays(simd, projection, target, rules, leaf, &setup);
        return;
    }
    let (rectangles, nearest) = projection.bound_triangles(simd, &leaf.corners, setup.valid);
    let mut rest = setup.valid & rectangles.some;
    if !rest.any_true() {
        return;
    }
    let width = projection.fan().width;
    let across = rectangles.last_column - rectangles.first_column + 1;
    let down = rectangles.last_row - rectangles.first_row + 1;
    let area = across * down;
    let tiny = rest
        & area.simd_le(i32x16::splat(simd, TINY_TRIANGLE))
        & rectangles.last_column.simd_lt(i32x16::splat(simd, width));
    if tiny.to_bitmask().count_ones() >= TINY_TRIANGLES {
        rest &= !tiny;
        draw_tiny(simd, projection, target, rules, leaf, &setup, &rectangles, tiny, area);
        if !rest.any_true() {
            return;
        }
    }
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
    let most = f32x16::splat(simd, leaf.nearest);
    setup.blurred.select(most, min(nearest, most)).store_array(&mut spilled.nearest);
    setup.slots.store_array(&mut spilled.slots);
    rectangles.first_column.store_array(&mut spilled.columns[0]);
    rectangles.last_column.store_array(&mut spilled.columns[1]);
    rectangles.first_row.store_array(&mut spilled.rows[0]);
    rectangles.last_row.store_array(&mut spilled.rows[1]);
    let (mut lanes, blurred) = (rest.to_bitmask(), setup.blurred.to_bitmask());
    while lanes != 0 {
        let lane = lanes.trailing_zeros() as usize & (WIDTH - 1);
        lanes &= lanes - 1;
        let blurred = (blurred & 1 << lane != 0).then(|| {
            let [x, y, z] = &spilled.inverse;
            Blurred::new(&projection, &leaf.source, lane, [x[lane], y[lane], z[lane]])
        });
        draw_one(simd, projection, target, rules, blurred, &spilled, lane);
    }
}

/// The lanes where a ray is inside all three edges, and 1/t.
#[inline(always)]
pub(super) fn inside<S: Simd, P: Projection>(
    edges: &[Planes<S>; 3],
    inverse: &Planes<S>,
    directions: &P::Directions<S>,
) -> (mask32x16<S>, f32x16<S>) {
    let u = P::dot(&edges[0], directions);
    let v = P::dot(&edges[1], directions);
    let w = P::dot(&edges[2], directions);
    let inverse = P::dot(inverse, directions);
    (min(min(u, v), w).simd_ge(f32x16::splat(inverse.simd, 0.0)), inverse)
}

/// (1/t)² of each triangle below which a ray grazes it; 0 of those that none grazes.
#[inline(always)]
fn grazing_limits<S: Simd, P: Projection>(simd: S, projection: &P, setup: &Setup<S>) -> f32x16<S> {
    let limits = square(&setup.inverse) * grazing_limit(projection);
    setup.blurred.select(limits, f32x16::splat(simd, 0.0))
}

/// Each ray against all sixteen triangles.
#[inline(always)]
fn draw_few_rays<S: Simd, P: Projection>(
    simd: S,
    projection: P,
    target: &mut Target<'_>,
    rules: Rules,
    leaf: &Leaf<'_, S>,
    setup: &Setup<S>,
) {
    let fan = projection.fan();
    let blocks_across = fan.blocks_across();
    let may_graze = setup.blurred.any_true();
    let limits = grazing_limits(simd, &projection, setup);
    for row in leaf.rows[0]..=leaf.rows[1] {
        let block_row = (row >> fan.shift_y) as usize - rules.first_block_row;
        for column in leaf.columns[0]..=leaf.columns[1] {
            let column = if column >= fan.width { column - fan.width } else { column };
            let block = block_row * blocks_across + (column >> fan.shift_x) as usize;
            let lane = fan.lane(column, row);
            let so_far = target.inverse[block][lane];
            if so_far >= leaf.nearest {
                continue;
            }
            let directions = projection.ray(simd, column, row);
            let (inside, mut inverse) = inside::<S, P>(&setup.edges, &setup.inverse, &directions);
            let inside = inside & setup.valid;
            if may_graze {
                let grazing = inside & (inverse * inverse).simd_lt(limits);
                inverse =
                    leaf.source.sharpen_lanes(simd, grazing, inverse, |_| projection.direction(column, row));
            }
            let hit = inside
                & inverse.simd_le(f32x16::splat(simd, rules.inverse_near))
                & inverse.simd_gt(f32x16::splat(simd, so_far));
            if hit.any_true() {
                let candidates = hit.select(inverse, f32x16::splat(simd, 0.0));
                let nearest = simd.reduce_max_f32x16(candidates);
                let winner = candidates.simd_eq(f32x16::splat(simd, nearest)).to_bitmask().trailing_zeros();
                target.inverse[block][lane] = nearest;
                target.slot[block][lane] = setup.slots[winner as usize & (WIDTH - 1)];
                target.update_farthest(block);
            }
        }
    }
}

/// Tiny triangles side by side, each lane going through the rays of its own rectangle.
#[allow(clippy::too_many_arguments, reason = "the pieces of one kernel")]
#[inline(always)]
fn draw_tiny<S: Simd, P: Projection>(
    simd: S,
    projection: P,
    target: &mut Target<'_>,
    rules: Rules,
    leaf: &Leaf<'_, S>,
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
    let may_graze = (setup.blurred & tiny).any_true();
    let limits = grazing_limits(simd, &projection, setup);
    for _ in 0..steps {
        let directions = projection.rays(simd, columns, rows);
        let (inside, mut inverse) = inside::<S, P>(&setup.edges, &setup.inverse, &directions);
        let inside = inside & drawing;
        if may_graze {
            columns.store_array(&mut at_column);
            rows.store_array(&mut at_row);
            let grazing = inside & (inverse * inverse).simd_lt(limits);
            let direction = |lane: usize| projection.direction(at_column[lane], at_row[lane]);
            inverse = leaf.source.sharpen_lanes(simd, grazing, inverse, direction);
        }
        let hit = inside & inverse.simd_le(f32x16::splat(simd, rules.inverse_near));
        let mut hits = hit.to_bitmask();
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

/// One triangle, block by block.
#[inline(always)]
fn draw_one<S: Simd, P: Projection>(
    simd: S,
    projection: P,
    target: &mut Target<'_>,
    rules: Rules,
    mut blurred: Option<Blurred<'_>>,
    spilled: &Spilled,
    lane: usize,
) {
    let fan = projection.fan();
    let blocks_across = fan.blocks_across();
    let (nearest, slot) = (spilled.nearest[lane], spilled.slots[lane]);
    let [first, last] = [spilled.columns[0][lane], spilled.columns[1][lane]];
    let block_rows =
        (spilled.rows[0][lane] >> fan.shift_y) as usize..=(spilled.rows[1][lane] >> fan.shift_y) as usize;
    let plane = |plane: &[[f32; WIDTH]; 3]| [plane[0][lane], plane[1][lane], plane[2][lane]];
    let edges = [plane(&spilled.edges[0]), plane(&spilled.edges[1]), plane(&spilled.edges[2])];
    let inverse = plane(&spilled.inverse);
    // A ring's rectangle may run over its end.
    let pieces = if last < fan.width {
        [[first, last], [1, 0]]
    } else {
        [[first, fan.width - 1], [0, last - fan.width]]
    };
    for [first, last] in pieces {
        if first > last {
            continue;
        }
        let (first, last) = ((first >> fan.shift_x) as usize, (last >> fan.shift_x) as usize);
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
                            &mut blurred,
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
                        &mut blurred,
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

/// The rays of a block against one triangle.
#[allow(clippy::too_many_arguments, reason = "the pieces of one kernel")]
#[inline(always)]
fn draw_block<S: Simd, P: Projection>(
    simd: S,
    projection: P,
    target: &mut Target<'_>,
    rules: Rules,
    blurred: &mut Option<Blurred<'_>>,
    slot: u32,
    edges: &[[f32; 3]; 3],
    inverse: &[f32; 3],
    [column, row]: [usize; 2],
    block: usize,
) {
    let directions = projection.block(simd, column, row);
    let edges = [splat(simd, &edges[0]), splat(simd, &edges[1]), splat(simd, &edges[2])];
    let (inside, mut inverse) = inside::<S, P>(&edges, &splat(simd, inverse), &directions);
    if let Some(blurred) = blurred {
        inverse = blurred.sharpen_block(simd, &projection, [column, row], inside, inverse);
    }
    let so_far = f32x16::load_array_ref(simd, &target.inverse[block]);
    let hit = inside & inverse.simd_le(f32x16::splat(simd, rules.inverse_near)) & inverse.simd_gt(so_far);
    let nearest = hit.select(inverse, so_far);
    nearest.store_array(&mut target.inverse[block]);
    let slots = u32x16::load_array_ref(simd, &target.slot[block]);
    hit.select(u32x16::splat(simd, slot), slots).store_array(&mut target.slot[block]);
    target.farthest[block] = simd.reduce_min_f32x16(nearest);
}

#[inline(always)]
pub(super) fn splat<S: Simd>(simd: S, plane: &[f32; 3]) -> Planes<S> {
    [f32x16::splat(simd, plane[0]), f32x16::splat(simd, plane[1]), f32x16::splat(simd, plane[2])]
}
