//! Shapes that do not consist of triangles: exact, in double precision, block by block.

use super::leaf::Rules;
use super::silhouette::Silhouette;
use super::target::Target;
use crate::optics::rays::Projection;
use crate::scene::Solid;
use crate::simd::WIDTH;
use crate::trace::packet::Faces;
use crate::trace::placed::view::View;
use crate::trace::shapes::match_solid;
use crate::trace::shapes::outside::{Outside, match_outside};
use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x16, u32x16};

/// If so few of sixteen blocks are left, they are tested without first checking in which of them the shape may be
/// visible.
const FEW_BLOCKS: u32 = 1;

/// The part of the grid on which a shape may be seen.
pub(super) struct SolidPart {
    /// The first and last column and row; on a full ring, columns may continue past the last one.
    pub(super) columns: [u16; 2],
    pub(super) rows: [u16; 2],
    /// An upper bound on 1/t.
    pub(super) nearest: f32,
}

/// Draws an instance of a solid.
#[inline(always)]
pub(super) fn draw<S: Simd, P: Projection>(
    simd: S,
    view: &View<'_>,
    projection: P,
    target: &mut Target<'_>,
    rules: Rules,
    (index, solid): (u32, Solid),
    part: &SolidPart,
) {
    let placed = &view.placed[index as usize];
    let size = view.instance(index).size;
    let ray_grid = *projection.ray_grid();
    let blocks_across = ray_grid.blocks_across();
    // From the sensor's axes to the instance's.
    let to_instance = view.rows_from_sensor(placed);
    let origin = placed.origin_in_instance;
    let mut silhouette = None;
    let both = rules.faces == Faces::Both;
    let outside = Outside::new(solid, size, origin, both, to_instance)
        .map(|(outside, rows)| (outside, projection.turning(&rows)));
    let pieces = ray_grid.pieces(part.columns.map(i32::from));
    let block_rows =
        (part.rows[0] >> ray_grid.shift_y) as usize..=(part.rows[1] >> ray_grid.shift_y) as usize;
    for [first, last] in pieces {
        if first > last {
            continue;
        }
        let (first, last) = ((first >> ray_grid.shift_x) as usize, (last >> ray_grid.shift_x) as usize);
        for row in block_rows.clone() {
            let start = (row - rules.first_block_row) * blocks_across;
            let mut column = first;
            while column <= last {
                let farthest = f32x16::from_slice(simd, &target.farthest[start + column..][..WIDTH]);
                let mut lanes = farthest.simd_lt(f32x16::splat(simd, part.nearest)).to_bitmask();
                if last - column < WIDTH - 1 {
                    lanes &= (2 << (last - column)) - 1;
                }
                if lanes.count_ones() > FEW_BLOCKS {
                    let silhouette = silhouette.get_or_insert_with(|| {
                        Silhouette::new(solid.half_extents(size), origin, &to_instance)
                    });
                    lanes &= silhouette.shows(simd, projection, [column, row], farthest).to_bitmask();
                }
                while lanes != 0 {
                    let column = column + lanes.trailing_zeros() as usize;
                    lanes &= lanes - 1;
                    if let Some((outside, turning)) = &outside {
                        let directions = projection.turned(simd, turning, column, row);
                        let inverse = first_outside(simd, &directions, outside);
                        // A ray that first hits the solid nearer than the limit may hit it a second time.
                        if inverse.simd_le(f32x16::splat(simd, rules.inverse_near)).all_true() {
                            commit(simd, target, start + column, placed.first_slot, inverse);
                            continue;
                        }
                    }
                    let directions = projection.turned(simd, &projection.turning(&to_instance), column, row);
                    let inverse = first_from(simd, &directions, (solid, size), origin, (rules.near, both));
                    commit(simd, target, start + column, placed.first_slot, inverse);
                }
                column += WIDTH;
            }
        }
    }
}

/// 1/t at which the rays of a block first hit a solid that they start outside of; 0 or less for a miss.
#[inline(always)]
fn first_outside<S: Simd>(simd: S, directions: &[[f64; WIDTH]; 3], outside: &Outside) -> f32x16<S> {
    let mut inverse = [0.0; WIDTH];
    match_outside!(
        outside,
        kernel => for lane in 0..WIDTH {
            inverse[lane] = kernel.inverse([directions[0][lane], directions[1][lane], directions[2][lane]]) as f32;
        }
    );
    f32x16::load_array_ref(simd, &inverse)
}

/// The same for any solid, from t = `near` on. Compiled once per level, since it is seldom called.
#[inline(never)]
fn first_from<S: Simd>(
    simd: S,
    directions: &[[f64; WIDTH]; 3],
    (solid, size): (Solid, [f64; 3]),
    origin: [f64; 3],
    (near, both): (f64, bool),
) -> f32x16<S> {
    simd.vectorize(
        #[inline(always)]
        || {
            let mut inverse = [0.0; WIDTH];
            match_solid!(
                solid,
                size,
                inside => for lane in 0..WIDTH {
                    let direction = [directions[0][lane], directions[1][lane], directions[2][lane]];
                    inverse[lane] = (1.0 / inside(origin, direction).first(near, both)) as f32;
                }
            );
            f32x16::load_array_ref(simd, &inverse)
        },
    )
}

/// Stores the hits that are nearer than the previous ones.
#[inline(always)]
fn commit<S: Simd>(simd: S, target: &mut Target<'_>, block: usize, slot: u32, inverse: f32x16<S>) {
    let so_far = f32x16::load_array_ref(simd, &target.inverse[block]);
    let hit = inverse.simd_gt(so_far);
    let nearest = hit.select(inverse, so_far);
    nearest.store_array(&mut target.inverse[block]);
    let slots = u32x16::load_array_ref(simd, &target.slot[block]);
    hit.select(u32x16::splat(simd, slot), slots).store_array(&mut target.slot[block]);
    target.farthest[block] = simd.reduce_min_f32x16(nearest);
}
