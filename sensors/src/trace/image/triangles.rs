//! Sixteen triangles against the rays of a rectangle of the grid.
//!
//! With corners relative to the origin, the plane through it and the edge from A to B has the normal
//! (A + B) × (B − A) = 2 A × B. Written so, it changes its sign, and nothing else, when A and B change places: two
//! triangles with a common edge decide alike, and no ray slips between them. A ray is inside where all three are
//! on the same side as the triangle, and there 1/t = n·d / n·a.

use super::sharp::{BLURRED_SQUARED, PlaneArrays, Source, THIN_SQUARED};
use super::target::{GRAZING, Target};
use crate::optics::rays::{Planes, Points, Projection, Rectangles, max, min};
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
#[derive(Clone, Copy)]
pub(super) struct Setup<S: Simd> {
    /// Edge planes, positive inside.
    pub(super) edges: [Planes<S>; 3],
    /// Plane of 1/t.
    pub(super) inverse: Planes<S>,
    /// Those to be drawn.
    pub(super) valid: mask32x16<S>,
    /// Those whose planes are not exact enough: they are to be made again first, see `sharp`.
    pub(super) blurred: mask32x16<S>,
    /// Those that have the sensor behind them, and in front.
    sides: [mask32x16<S>; 2],
    pub(super) slots: u32x16<S>,
}

impl<S: Simd> Setup<S> {
    /// The planes, triangle by triangle.
    #[inline(always)]
    pub(super) fn spill(&self) -> PlaneArrays {
        let mut planes = PlaneArrays {
            edges: [[[0.0; WIDTH]; 3]; 3],
            inverse: [[0.0; WIDTH]; 3],
            sides: [self.sides[0].to_bitmask(), self.sides[1].to_bitmask()],
        };
        for axis in 0..3 {
            for edge in 0..3 {
                self.edges[edge][axis].store_array(&mut planes.edges[edge][axis]);
            }
            self.inverse[axis].store_array(&mut planes.inverse[axis]);
        }
        planes
    }
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
#[derive(Clone, Copy)]
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

/// Planes of sixteen triangles.
#[derive(Clone, Copy)]
struct TrianglePlane<S: Simd> {
    /// Six times that of the tetrahedron of triangle and sensor; positive if the sensor is behind.
    volume: f32x16<S>,
    /// Plane of 1/t.
    inverse: Planes<S>,
    /// The rounding of the normal is of no account.
    fat: mask32x16<S>,
}

impl<S: Simd> TrianglePlane<S> {
    /// Of triangles with corner `a` and two sides, whose squares are given, as is that of the longest side.
    #[inline(always)]
    fn new(a: &Points<S>, [p, q]: [&Points<S>; 2], squares: [f32x16<S>; 2], extent: f32x16<S>) -> Self {
        let normal = cross(p, q);
        let volume = (a[0] * normal[0] + a[1] * normal[1]) + a[2] * normal[2];
        let per_volume = f32x16::splat(volume.simd, 1.0) / volume;
        let lost = (squares[0] * per_volume) * (squares[1] * per_volume) * extent;
        let fat = lost.simd_le(f32x16::splat(volume.simd, THIN_SQUARED));
        Self { volume, inverse: scale(&normal, per_volume), fat }
    }
}

#[inline(always)]
pub(super) fn set_up<S: Simd>(simd: S, leaf: &Leaf<'_, S>, rules: Rules) -> Setup<S> {
    let [a, b, c] = &leaf.corners;
    let (ab, ac) = (sub(b, a), sub(c, a));
    let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
    let squares = [square(&ab), square(&ac)];
    let mut extent = max(squares[0], squares[1]);
    let mut plane = TrianglePlane::new(a, [&ab, &ac], squares, extent);
    let is_solid = extent.simd_gt(zero);
    if (is_solid & !plane.fat).any_true() {
        // The shorter two sides lose less, unless all three are long for the triangle's height.
        let bc = sub(c, b);
        let [ab_squared, ac_squared] = squares;
        let bc_squared = square(&bc);
        let ab_is_longest = ab_squared.simd_gt(ac_squared) & ab_squared.simd_gt(bc_squared);
        let bc_is_longest = bc_squared.simd_ge(ab_squared) & bc_squared.simd_gt(ac_squared);
        let mut sides = [ab, bc];
        for axis in 0..3 {
            sides[0][axis] = ab_is_longest.select(ac[axis], ab[axis]);
            sides[1][axis] = bc_is_longest.select(ac[axis], bc[axis]);
        }
        let squares =
            [ab_is_longest.select(ac_squared, ab_squared), bc_is_longest.select(ac_squared, bc_squared)];
        extent = max(extent, bc_squared);
        plane = TrianglePlane::new(a, [&sides[0], &sides[1]], squares, extent);
    }
    let TrianglePlane { volume, inverse, fat } = plane;
    let sides = [volume.simd_gt(zero), volume.simd_lt(zero)];
    let sign = sides[0].select(one, -one);
    // 1/|inverse| is the distance of the plane. What is farther at some corner, by much, may be grazed by a ray;
    // and what is large besides has no exact plane. Nor has what is so thin that its normal is mostly rounding.
    let away = square(a);
    let steep = ((away + extent) * square(&inverse)).simd_le(f32x16::splat(simd, BLURRED_SQUARED));
    let small = (extent * 4.0).simd_lt(away);
    // Comparisons say no to 0 by 0, and to what has no extent they say no as well.
    let blurred = is_solid & !(fat & (steep | small));
    let slots = u32x16::load_array_ref(simd, &LANE_NUMBERS) + leaf.first_slot;
    let slots = steep.select(slots, slots | u32x16::splat(simd, GRAZING));
    Setup {
        edges: [edge(b, c, sign), edge(c, a, sign), edge(a, b, sign)],
        inverse,
        valid: facing(rules, sides) & !blurred,
        blurred,
        sides,
        slots,
    }
}

/// Those that are seen from the side that counts. Seen edge on, a triangle covers nothing.
#[inline(always)]
pub(super) fn facing<S: Simd>(rules: Rules, [behind, front]: [mask32x16<S>; 2]) -> mask32x16<S> {
    match (rules.faces, rules.mirrored) {
        (Faces::Both, _) => behind | front,
        (Faces::Front, false) => front,
        (Faces::Front, true) => behind,
    }
}

/// Draws the blurred triangles of a leaf, from planes in double precision. By itself, and with copies of all, so that
/// the usual way has what it needs in registers.
#[cold]
#[inline(never)]
pub(super) fn draw_blurred<S: Simd, P: Projection>(
    simd: S,
    projection: P,
    target: &mut Target<'_>,
    rules: Rules,
    leaf: Leaf<'_, S>,
    mut setup: Setup<S>,
) {
    simd.vectorize(
        #[inline(always)]
        || {
            sharpen(simd, &leaf.source, rules, &mut setup);
            let (mut rectangles, _) = projection.bound_triangles(simd, &leaf.corners, setup.valid);
            rectangles.some &= setup.valid;
            let nearest = f32x16::splat(simd, leaf.nearest);
            draw_each(simd, projection, target, rules, &setup, &rectangles, nearest);
        },
    );
}

/// Makes the planes of the blurred triangles again, and leaves those valid that face the sensor.
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
        draw_blurred(simd, projection, target, rules, *leaf, setup);
    }
    if !setup.valid.any_true() {
        return;
    }
    let rays = (leaf.columns[1] - leaf.columns[0] + 1) * (leaf.rows[1] - leaf.rows[0] + 1);
    if rays <= FEW_RAYS {
        draw_few_rays(simd, projection, target, rules, leaf, &setup);
        return;
    }
    let (mut rectangles, nearest) = projection.bound_triangles(simd, &leaf.corners, setup.valid);
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
        draw_tiny(simd, projection, target, rules, &setup, &rectangles, tiny, area);
        if !rest.any_true() {
            return;
        }
    }
    rectangles.some = rest;
    let nearest = min(nearest, f32x16::splat(simd, leaf.nearest));
    draw_each(simd, projection, target, rules, &setup, &rectangles, nearest);
}

/// One triangle after the other, those of `some` of the rectangles. `nearest` are bounds of 1/t from above.
#[inline(always)]
fn draw_each<S: Simd, P: Projection>(
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

/// The lanes where a ray is inside all three edges and its 1/t counts.
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
            let (hit, inverse) =
                inside::<S, P>(&setup.edges, &setup.inverse, &directions, rules.inverse_near);
            let hit = hit & setup.valid & inverse.simd_gt(f32x16::splat(simd, so_far));
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

/// One triangle, block by block.
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
    let fan = projection.fan();
    let blocks_across = fan.blocks_across();
    let nearest = spilled.nearest[lane];
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

/// The rays of a block against one triangle.
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
    // A lidar's blocks span wide angles, and many are not hit after all (S1/R3 5 % faster, R4 3 %); a camera's are
    // nearly always (S3/R1 10 % slower).
    if P::HAS_STRIPS && !hit.any_true() {
        return;
    }
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
