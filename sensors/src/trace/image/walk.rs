//! The walk through the trees, once per frame and front to back.

use super::corners::{from_origin, spread, stored};
use super::entry::{Entry, STACK, insert};
use super::leaf::{Leaf, Rules};
use super::sharp::Source;
use super::single::SingleRay;
use super::solid::{self, SolidPart};
use super::strip;
use super::target::Target;
use super::triangles;
use crate::optics::rays::{Points, Projection, max};
use crate::scene::tree::{LEAF, NONE, WideNode};
use crate::scene::{Kind, Triangles};
use crate::simd::{WIDTH, part};
use crate::trace::packet::Faces;
use crate::trace::placed::view::{Placed, ToSensor, View};
use crate::trace::prefetch::prefetch;
use fearless_simd::{Simd, SimdBase, SimdMask, f32x16, u32x16};

/// The value of `placed` for entries of the tree over the instances.
const TOP: u32 = u32::MAX;

/// Draws a view into the rows of `target`, whose first block row is `first_block_row`.
#[allow(clippy::large_stack_arrays, reason = "26 KiB, once a band: a heap there may not be")]
#[inline(always)]
pub(crate) fn walk<S: Simd, P: Projection>(
    simd: S,
    view: &View<'_>,
    projection: P,
    rows: [i32; 2],
    faces: Faces,
    range: [f64; 2],
    target: &mut Target<'_>,
) {
    let ray_grid = *projection.ray_grid();
    let first_block_row = (rows[0] >> ray_grid.shift_y) as usize;
    let blank = Entry { child: 0, placed: TOP, nearest: 0.0, order: 0.0, columns: [0; 2], rows: [0; 2] };
    let mut stack = [blank; STACK];
    stack[0] = Entry {
        nearest: f32::MAX,
        columns: [0, (ray_grid.width - 1) as u16],
        rows: rows.map(|row| row as u16),
        ..blank
    };
    let mut waiting = 1;
    let mut single = SingleRay::NONE;
    while waiting > 0 {
        waiting -= 1;
        let entry = stack[waiting];
        if hidden(simd, projection, target, first_block_row, &entry) {
            continue;
        }
        if waiting > 0 {
            fetch(view, &stack[waiting - 1]);
        }
        let rules = Rules {
            faces,
            mirrored: false,
            inverse_near: (1.0 / range[0]) as f32,
            near: range[0],
            first_block_row,
        };
        let made;
        let (node, to_sensor, placed) = if entry.placed == TOP && entry.child & LEAF == 0 {
            (&view.nodes[entry.child as usize], &view.sensor_from_frame, TOP)
        } else {
            // A leaf of the top tree refers to the root of an instance's tree.
            let (index, child) =
                if entry.placed == TOP { (entry.child & !LEAF, 0) } else { (entry.placed, entry.child) };
            let placed = &view.placed[index as usize];
            let is_leaf = child & LEAF != 0;
            if is_leaf {
                let leaf = child & !LEAF;
                let one_ray = entry.is_of_one_ray();
                if one_ray {
                    single.aim(view, projection, index, entry.first_ray());
                }
                let corners = if placed.kind().is_mesh() {
                    let block = &view.scene.blocks[(placed.first_block + leaf) as usize];
                    if one_ray && !SingleRay::meets_any(&stored(simd, block, &single)) {
                        continue;
                    }
                    stored(simd, block, &placed.to_sensor)
                } else if let Some(vertices) = view.height_grid(placed).vertices(simd, leaf) {
                    if one_ray && !SingleRay::meets_any(&spread(simd, &vertices, &single)) {
                        continue;
                    }
                    spread(simd, &vertices, &placed.to_sensor)
                } else {
                    narrow_leaf(simd, view, placed, leaf)
                };
                let leaf = Leaf {
                    source: Source { view, placed, leaf },
                    corners: &corners,
                    first_slot: placed.first_slot + leaf * WIDTH as u32,
                    columns: entry.columns.map(i32::from),
                    rows: entry.rows.map(i32::from),
                    nearest: entry.nearest,
                };
                let rules = Rules { mirrored: placed.mirrored != 0, ..rules };
                if strip::suits(&projection, &leaf) {
                    strip::draw(simd, projection, target, rules, &leaf);
                } else {
                    part(
                        simd,
                        #[inline(always)]
                        || triangles::draw(simd, projection, target, rules, &leaf),
                    );
                }
                continue;
            }
            let node = match placed.kind() {
                Kind::Triangles(Triangles::Mesh) => &view.scene.nodes[(placed.first_node + child) as usize],
                Kind::Triangles(Triangles::HeightField) => {
                    made = view.height_grid(placed).node(child);
                    &made
                }
                Kind::Solid(solid) => {
                    let piece =
                        SolidPart { columns: entry.columns, rows: entry.rows, nearest: entry.nearest };
                    part(
                        simd,
                        #[inline(always)]
                        || solid::draw(simd, view, projection, target, rules, (index, solid), &piece),
                    );
                    continue;
                }
            };
            (node, &placed.to_sensor, index)
        };
        waiting = if placed != TOP && entry.is_of_few_rays() {
            let (entry, seen) = (Entry { placed, ..entry }, (view, &*target, first_block_row));
            part(
                simd,
                #[inline(always)]
                || push_by_ray(simd, projection, node, &entry, seen, &mut single, &mut stack, waiting),
            )
        } else {
            push_children(simd, projection, node, to_sensor, placed, &mut stack, waiting)
        };
    }
}

/// Computes the corners of a leaf at the edge of a height field. It is a separate function because such leaves are
/// rare.
#[cold]
#[inline(never)]
fn narrow_leaf<S: Simd>(simd: S, view: &View<'_>, placed: &Placed, leaf: u32) -> [Points<S>; 3] {
    simd.vectorize(
        #[inline(always)]
        || stored(simd, &view.height_grid(placed).block(leaf), &placed.to_sensor),
    )
}

/// Prefetches the data that an entry will need.
#[inline(always)]
fn fetch(view: &View<'_>, entry: &Entry) {
    if entry.placed == TOP {
        return;
    }
    let placed = &view.placed[entry.placed as usize];
    if !placed.kind().is_mesh() {
        return;
    }
    if entry.child & LEAF != 0 {
        prefetch(view.scene.blocks, placed.first_block + (entry.child & !LEAF));
    } else {
        prefetch(view.scene.nodes, placed.first_node + entry.child);
    }
}

/// Pushes the children of a node that any ray may hit, with the first to visit on top.
#[inline(always)]
fn push_children<S: Simd, P: Projection>(
    simd: S,
    projection: P,
    node: &WideNode,
    to_sensor: &ToSensor,
    placed: u32,
    stack: &mut [Entry; STACK],
    first: usize,
) -> usize {
    let (low, high) = box_in_sensor(simd, node, to_sensor);
    let nearest = projection.inverse_of_boxes(simd, &low, &high);
    let rectangles = projection.bound_boxes(simd, &low, &high);
    let there = u32x16::load_array_ref(simd, &node.child).simd_ne(u32x16::splat(simd, NONE));
    let mut lanes = (rectangles.some & there).to_bitmask();
    if lanes == 0 {
        return first;
    }
    let mut near = [0.0; WIDTH];
    nearest.store_array(&mut near);
    let mut order = near;
    if placed == TOP {
        inverse_reach(simd, &low, &high).store_array(&mut order);
    }
    let mut spilled = [[0_i32; WIDTH]; 4];
    rectangles.first_column.store_array(&mut spilled[0]);
    rectangles.last_column.store_array(&mut spilled[1]);
    rectangles.first_row.store_array(&mut spilled[2]);
    rectangles.last_row.store_array(&mut spilled[3]);
    let mut waiting = first;
    while lanes != 0 {
        let lane = lanes.trailing_zeros() as usize & (WIDTH - 1);
        lanes &= lanes - 1;
        let entry = Entry {
            child: node.child[lane],
            placed,
            nearest: near[lane],
            order: order[lane],
            columns: [spilled[0][lane] as u16, spilled[1][lane] as u16],
            rows: [spilled[2][lane] as u16, spilled[3][lane] as u16],
        };
        waiting = insert(stack, first, waiting, entry);
    }
    waiting
}

/// The order in which instances are visited, the greatest value first: the inverse of the greatest possible distance of
/// a point in a box. Some part of a floor or a wall is nearer than everything in front of it, so the nearest distance
/// would be a worse order.
#[inline(always)]
fn inverse_reach<S: Simd>(simd: S, low: &Points<S>, high: &Points<S>) -> f32x16<S> {
    let [x, y, z] = [max(high[0], -low[0]), max(high[1], -low[1]), max(high[2], -low[2])];
    f32x16::splat(simd, 1.0) / ((x * x + y * y) + z * z)
}

/// Pushes the children of a node that the few rays of an entry may hit, ray by ray, with the nearest on top.
#[allow(clippy::too_many_arguments, reason = "the pieces of one kernel")]
#[inline(always)]
fn push_by_ray<S: Simd, P: Projection>(
    simd: S,
    projection: P,
    node: &WideNode,
    entry: &Entry,
    (view, target, first_block_row): (&View<'_>, &Target<'_>, usize),
    single: &mut SingleRay,
    stack: &mut [Entry; STACK],
    mut waiting: usize,
) -> usize {
    for row in entry.rows[0]..=entry.rows[1] {
        for column in entry.columns[0]..=entry.columns[1] {
            let so_far = target.inverse_of(projection.ray_grid(), first_block_row, [column, row]);
            if so_far >= entry.nearest {
                continue;
            }
            single.aim(view, projection, entry.placed, [column, row]);
            let (nearest, mut lanes) = single.meet(simd, node, so_far);
            if lanes == 0 {
                continue;
            }
            let mut near = [0.0; WIDTH];
            nearest.store_array(&mut near);
            let first = waiting;
            while lanes != 0 {
                let lane = lanes.trailing_zeros() as usize & (WIDTH - 1);
                lanes &= lanes - 1;
                let (child, nearest) = (node.child[lane], near[lane]);
                let child =
                    Entry { child, nearest, order: nearest, columns: [column; 2], rows: [row; 2], ..*entry };
                waiting = insert(stack, first, waiting, child);
            }
        }
    }
    waiting
}

/// Returns true if everything in an entry is behind what its rays have already hit.
#[inline(always)]
fn hidden<S: Simd, P: Projection>(
    simd: S,
    projection: P,
    target: &Target<'_>,
    first_block_row: usize,
    entry: &Entry,
) -> bool {
    let ray_grid = projection.ray_grid();
    if entry.is_of_one_ray() {
        return target.inverse_of(ray_grid, first_block_row, entry.first_ray()) >= entry.nearest;
    }
    let blocks_across = ray_grid.blocks_across();
    let nearest = f32x16::splat(simd, entry.nearest);
    let pieces = ray_grid.pieces(entry.columns.map(i32::from));
    let entry_rows = entry.rows.map(i32::from);
    let rows = (entry_rows[0] >> ray_grid.shift_y) as usize..=(entry_rows[1] >> ray_grid.shift_y) as usize;
    for [first, last] in pieces {
        if first > last {
            continue;
        }
        let rays = [first, last];
        let (first, last) = ((first >> ray_grid.shift_x) as usize, (last >> ray_grid.shift_x) as usize);
        for row in rows.clone() {
            let start = (row - first_block_row) * blocks_across;
            let mut column = first;
            while column <= last {
                let farthest = f32x16::from_slice(simd, &target.farthest[start + column..][..WIDTH]);
                let mut lanes = farthest.simd_lt(nearest).to_bitmask();
                if last - column < WIDTH - 1 {
                    lanes &= (2 << (last - column)) - 1;
                }
                while lanes != 0 {
                    let column = column + lanes.trailing_zeros() as usize;
                    lanes &= lanes - 1;
                    // Most entries concern only a few rays; the other rays of the block are ignored.
                    let asked = ray_grid.lanes_within(rays, entry_rows, [column, row]);
                    let inverse = f32x16::load_array_ref(simd, &target.inverse[start + column]);
                    if inverse.simd_lt(nearest).to_bitmask() & asked != 0 {
                        return false;
                    }
                }
                column += WIDTH;
            }
        }
    }
    true
}

/// The bounding boxes of the children along the sensor's axes.
#[inline(always)]
fn box_in_sensor<S: Simd>(simd: S, node: &WideNode, to_sensor: &ToSensor) -> (Points<S>, Points<S>) {
    let low = from_origin(simd, &node.min, to_sensor);
    let high = from_origin(simd, &node.max, to_sensor);
    let (mut centre, mut half) = (low, low);
    for axis in 0..3 {
        centre[axis] = (low[axis] + high[axis]) * 0.5;
        // Slightly wider than the box, because all that follows is rounded.
        half[axis] = (high[axis] - low[axis]) * 0.500_001 + max(high[axis], -low[axis]) * 1e-6;
    }
    let (mut low, mut high) = (low, high);
    for axis in 0..3 {
        let [x, y, z] = to_sensor.rows[axis];
        let middle = (centre[0] * x + centre[1] * y) + centre[2] * z;
        let reach = (half[0] * x.abs() + half[1] * y.abs()) + half[2] * z.abs();
        low[axis] = middle - reach;
        high[axis] = middle + reach;
    }
    (low, high)
}
