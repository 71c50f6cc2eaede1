//! Casting whole grids of rays.

use super::image::{Fan, NO_HIT, PinholeFan, SphericalFan, Steps, Target, walk};
use super::packet::Faces;
use super::view::{Placed, View, ViewMemory, top_nodes};
use crate::Execution;
use crate::lens::Pinhole;
use crate::pose::Pose;
use crate::scene::tree::{WIDTH, WideNode};
use crate::scene::{Aabb, KIND_MESH, Scene};
use crate::simd::{sqrt, sqrt_f32};
use bytemuck::{Pod, Zeroable};
use fearless_simd::{Simd, dispatch};
use glam::{DMat3, DVec3};

/// 64 bytes that start where a line of the cache does.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C, align(64))]
pub struct CacheLine([u8; 64]);

/// Directions of rays from a sensor, which looks along +x, y is left, z is up; row after row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RayGrid {
    /// Pixels of a camera.
    Pinhole(Pinhole),
    /// Columns by azimuth (around z, from +x), rows by elevation (up), in radians.
    Spherical {
        /// Columns, 1 … 16384.
        columns: u32,
        /// Rows, 1 … 16384.
        rows: u32,
        /// Of the first column.
        first_azimuth_rad: f64,
        /// From a column to the next.
        azimuth_step_rad: f64,
        /// Of the first row.
        first_elevation_rad: f64,
        /// From a row to the next.
        elevation_step_rad: f64,
    },
}

impl RayGrid {
    fn fan(&self) -> Fan {
        match self {
            Self::Pinhole(lens) => Fan::new(lens.width, lens.height),
            Self::Spherical { columns, rows, .. } => Fan::new(*columns, *rows),
        }
    }
}

/// Where the answers go, one per ray; what is none is not worked out.
#[derive(Debug, Default)]
pub struct Hits<'a> {
    /// Along the ray in units of its direction's length (1 in a grid); +∞ where nothing is hit.
    pub distance: Option<&'a mut [f32]>,
    /// Unit normals, outwards, in the axes of the world; left as they are where nothing is hit.
    pub normal: Option<&'a mut [[f32; 3]]>,
    /// Indices of instances; `u32::MAX` where nothing is hit.
    pub instance: Option<&'a mut [u32]>,
    /// Triangle of the mesh, 0 for other shapes; `u32::MAX` where nothing is hit.
    pub primitive: Option<&'a mut [u32]>,
}

/// Cache lines that casting that many rays needs.
pub fn memory_len(scene: &Scene<'_>, grid: &RayGrid) -> usize {
    let fan = grid.fan();
    let blocks = fan.blocks_across() * fan.blocks_down();
    let instances = scene.instances().len();
    let lines = |bytes: usize| bytes.div_ceil(64);
    lines(instances * size_of::<Placed>())
        + lines(instances * size_of::<Aabb>())
        + lines(instances * 8)
        + top_nodes(instances) * lines(size_of::<WideNode>())
        + 2 * blocks
        + lines((blocks + WIDTH) * 4)
        + SphericalFan::table_len(&fan)
}

struct Cutter<'a>(&'a mut [CacheLine]);

impl<'a> Cutter<'a> {
    fn take<T: Pod>(&mut self, count: usize) -> &'a mut [T] {
        let rest = core::mem::take(&mut self.0);
        let (part, rest) = rest.split_at_mut((count * size_of::<T>()).div_ceil(64));
        self.0 = rest;
        bytemuck::cast_slice_mut(
            &mut bytemuck::cast_slice_mut::<CacheLine, u8>(part)[..count * size_of::<T>()],
        )
    }
}

/// Casts a grid of rays from one point.
pub fn cast_grid(
    scene: &Scene<'_>,
    world_from_sensor: &Pose,
    grid: &RayGrid,
    [near, far]: [f64; 2],
    visibility: u32,
    faces: Faces,
    execution: Execution,
    memory: &mut [CacheLine],
    mut hits: Hits<'_>,
) {
    let mut memory = Cutter(memory);
    let instances = scene.instances.len();
    let view_memory = ViewMemory {
        placed: memory.take(instances),
        bounds: memory.take(instances),
        order: memory.take(instances),
        nodes: memory.take(top_nodes(instances)),
    };
    let view = View::new(scene, world_from_sensor, visibility, view_memory);
    let fan = grid.fan();
    let blocks = fan.blocks_across() * fan.blocks_down();
    let inverse: &mut [[f32; WIDTH]] = memory.take(blocks);
    let slot: &mut [[u32; WIDTH]] = memory.take(blocks);
    let farthest: &mut [f32] = memory.take(blocks + WIDTH);
    let tables: &mut [[f32; WIDTH]] = memory.take(SphericalFan::table_len(&fan));
    let (inverse_near, inverse_far) = ((1.0 / near) as f32, (1.0 / far) as f32);
    let axes = world_from_sensor.rotation_matrix();
    dispatch!(execution.level, simd => simd.vectorize(#[inline(always)] || {
        let mut target = Target { inverse: &mut *inverse, slot: &mut *slot, farthest: &mut *farthest };
        match *grid {
            RayGrid::Pinhole(lens) => {
                let projection = PinholeFan {
                    fan, fx: lens.fx as f32, fy: lens.fy as f32, cx: lens.cx as f32, cy: lens.cy as f32,
                    per_fx: (1.0 / lens.fx) as f32, per_fy: (1.0 / lens.fy) as f32, rows: [0, fan.height - 1],
                };
                let _ = projection;
                for band in 0..BANDS {
                    let rows = band_rows(&fan, band);
                    if rows[0] > rows[1] { continue; }
                    let projection = PinholeFan { rows, ..projection };
                    let first = (rows[0] >> fan.shift_y) as usize * fan.blocks_across();
                    let last = ((rows[1] >> fan.shift_y) as usize + 1) * fan.blocks_across();
                    let count = last - first;
                    let mut target = Target { inverse: &mut target.inverse[first..last], slot: &mut target.slot[first..last], farthest: &mut target.farthest[..count + 16] };
                    target.clear(inverse_far);
                    walk(simd, &view, projection, rows, faces, inverse_near, &mut target);
                    resolve(simd, &view, &fan, rows, &target, &mut hits, &axes, #[inline(always)] |column, row| {
                        let (y, z) = ((lens.cx - f64::from(column)) / lens.fx, (lens.cy - f64::from(row)) / lens.fy);
                        DVec3::new(1.0, y, z)
                    }, #[inline(always)] |column, row, lane_lengths| {
                        let z = (projection.cy - row as f32) * projection.per_fy;
                        for (lane, length) in lane_lengths.iter_mut().enumerate() {
                            let y = (projection.cx - (column + lane as i32) as f32) * projection.per_fx;
                            *length = sqrt_f32((y * y + z * z) + 1.0);
                        }
                    });
                }
            }
            RayGrid::Spherical { first_azimuth_rad, azimuth_step_rad, first_elevation_rad, elevation_step_rad, .. } => {
                let azimuth = Steps { first: first_azimuth_rad, step: azimuth_step_rad };
                let elevation = Steps { first: first_elevation_rad, step: elevation_step_rad };
                let projection = SphericalFan::new(fan, azimuth, elevation, &mut *tables);
                target.clear(inverse_far);
                walk(simd, &view, projection, projection.rows, faces, inverse_near, &mut target);
                resolve(simd, &view, &fan, projection.rows, &target, &mut hits, &axes, #[inline(always)] |column, row| {
                    let (sin, cos) = crate::simd::sin_cos(azimuth.first + azimuth.step * f64::from(column));
                    let (up, level) = crate::simd::sin_cos(elevation.first + elevation.step * f64::from(row));
                    DVec3::new(cos * level, sin * level, up)
                }, #[inline(always)] |_, _, lengths| lengths.fill(1.0));
            }
        }
    }));
}

const BANDS: i32 = 8;

fn band_rows(fan: &Fan, band: i32) -> [i32; 2] {
    let blocks = fan.blocks_down() as i32;
    let (first, last) = (blocks * band / BANDS, blocks * (band + 1) / BANDS);
    [first << fan.shift_y, ((last << fan.shift_y) - 1).min(fan.height - 1)]
}

#[inline(always)]
fn resolve<S: Simd>(
    _simd: S,
    view: &View<'_>,
    fan: &Fan,
    rows: [i32; 2],
    target: &Target<'_>,
    hits: &mut Hits<'_>,
    axes: &DMat3,
    direction: impl Fn(i32, i32) -> DVec3,
    lengths: impl Fn(i32, i32, &mut [f32]),
) {
    let (wide, high) = (1_i32 << fan.shift_x, 1_i32 << fan.shift_y);
    let first_block_row = rows[0] >> fan.shift_y;
    let _ = (axes, direction, sqrt(0.0));
    for block_row in first_block_row..=rows[1] >> fan.shift_y {
        for block_column in 0..fan.blocks_across() as i32 {
            let block = (block_row - first_block_row) as usize * fan.blocks_across() + block_column as usize;
            for line in 0..high {
                let row = (block_row << fan.shift_y) + line;
                if row > rows[1] {
                    break;
                }
                let column = block_column << fan.shift_x;
                let count = wide.min(fan.width - column) as usize;
                let first = (row * fan.width + column) as usize;
                let lanes = (line << fan.shift_x) as usize..(line << fan.shift_x) as usize + count;
                if let Some(distance) = hits.distance.as_deref_mut() {
                    let mut length = [1.0; WIDTH];
                    lengths(row.min(0) + column, row, &mut length[..count]);
                    for (lane, out) in distance[first..first + count].iter_mut().enumerate() {
                        let hit = target.slot[block][lanes.start + lane] != NO_HIT;
                        *out = if hit {
                            length[lane] / target.inverse[block][lanes.start + lane]
                        } else {
                            f32::INFINITY
                        };
                    }
                }
                if let Some(primitive) = hits.primitive.as_deref_mut() {
                    for (out, lane) in primitive[first..first + count].iter_mut().zip(lanes.clone()) {
                        let slot = target.slot[block][lane];
                        *out = if slot == NO_HIT {
                            u32::MAX
                        } else {
                            let placed = &view.placed[0];
                            debug_assert!(placed.kind == KIND_MESH);
                            view.scene.blocks[(placed.first_block + (slot - placed.first_slot) / 16) as usize]
                                .triangle[(slot % 16) as usize]
                        };
                    }
                }
            }
        }
    }
}
