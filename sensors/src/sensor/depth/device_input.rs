//! The input of a device model: true depths of a frame and angles of incidence, in the workspace.

use super::too_near::Obstacles;
use crate::device::depth_model::{DepthDevice, Eye, Look};
use crate::memory::{Cutter, lines};
use crate::simd::WIDTH;
use crate::trace::grid::place::Place;
use crate::trace::grid::tiling::BLOCKS;
use crate::trace::grid::{Band, Sight};
use crate::trace::hit::measure::Measure;
use crate::trace::hit::normals::NormalFinder;
use crate::trace::hit::point::block_index;
use crate::trace::hit::resolve::{Resolver, hit_lanes};
use crate::trace::packet::Faces;
use crate::trace::packet::specular::Glazing;
use crate::trace::packet::visibility::VisibilityTest;
use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x16};

/// True depths in metres (ranges for time of flight), each with the cosine of its angle of incidence, in row-major
/// order.
///
/// The depth is +∞ where nothing is hit, −∞ where something too near is in the way, and NaN where the second eye does
/// not see the point. The cosine is 1 where nothing is hit or where the device does not need it. Both lie side by side
/// because lateral noise reads both of another pixel.
pub(super) struct DeviceInput<'a>(pub(super) &'a mut [[f32; 2]]);

impl<'a> DeviceInput<'a> {
    /// Returns the number of cache lines for this number of pixels.
    pub(super) const fn workspace_len(pixels: usize) -> usize {
        lines(pixels * size_of::<[f32; 2]>())
    }

    pub(super) fn new(pixels: usize, memory: &mut Cutter<'a>) -> Self {
        Self(memory.take(pixels))
    }

    /// Reborrows the memory.
    pub(super) fn reborrow(&mut self) -> DeviceInput<'_> {
        DeviceInput(&mut *self.0)
    }

    /// Splits off the first pixels.
    pub(super) fn split_at(self, pixels: usize) -> (Self, Self) {
        let (seen, rest) = self.0.split_at_mut(pixels.min(self.0.len()));
        (Self(seen), Self(rest))
    }

    /// Writes the depths and cosines of a band. Compiled once per SIMD level.
    #[inline(never)]
    pub(super) fn write<S: Simd>(
        &mut self,
        simd: S,
        band: &Band<'_>,
        device: &DepthDevice,
        sight: &Sight,
        obstacles: Obstacles<'_>,
    ) {
        simd.vectorize(
            #[inline(always)]
            || self.write_rows(simd, band, device, sight, obstacles),
        );
    }

    #[inline(always)]
    fn write_rows<S: Simd>(
        &mut self,
        simd: S,
        band: &Band<'_>,
        device: &DepthDevice,
        sight: &Sight,
        obstacles: Obstacles<'_>,
    ) {
        let faces = sight.faces;
        let glazing = Glazing::of(band.view);
        let ray_grid = band.rays.ray_grid();
        let across = ray_grid.blocks_across();
        let measure = Measure::new(&band.view.world_from_sensor);
        let axes = band.view.world_from_sensor.rotation_matrix();
        let columns = axes.as_mat3().to_cols_array_2d();
        let mut resolver = Resolver::new(band.view);
        let mut finder = NormalFinder::new(faces);
        let mut second_look = VisibilityTest::NEW;
        if let Some(eye) = device.eye {
            second_look.set(eye.place(&axes));
        }
        for row in band.block_rows() {
            if ((row << ray_grid.shift_y) as i32) < band.fresh_from {
                continue;
            }
            let mut place = Place::new(ray_grid, band, 0, row);
            for first in (0..across).step_by(BLOCKS) {
                let nothing = [f32x16::splat(simd, f32::INFINITY); BLOCKS];
                let (mut depths, mut cosines) = (nothing, [f32x16::splat(simd, 1.0); BLOCKS]);
                let parts = BLOCKS.min(across - first);
                for part in 0..parts {
                    let block = [first + part, row];
                    let depth = if matches!(device.look, Look::Light(_)) {
                        measure.block::<S, false>(simd, band, &mut resolver, block)
                    } else {
                        measure.block::<S, true>(simd, band, &mut resolver, block)
                    };
                    depths[part] = depth;
                    if device.wants_incidence() {
                        cosines[part] = finder.cosines(simd, band, &columns, &mut resolver, block);
                    }
                    if let Some(glazing) = glazing {
                        let seen = if matches!(device.look, Look::Light(_)) {
                            glazing.look::<S, false>(simd, band, &mut resolver, sight, block)
                        } else {
                            glazing.look::<S, true>(simd, band, &mut resolver, sight, block)
                        };
                        if let Some(seen) = seen {
                            depths[part] = seen.put_far(simd, depths[part]);
                            cosines[part] = seen.put_cosines(simd, cosines[part]);
                        }
                    }
                    depths[part] = obstacles.hide(simd, row * across + first + part, depths[part]);
                }
                if let Some(eye) = device.eye {
                    let hidden = hidden(simd, band, faces, (eye, &mut second_look), (&columns, [first, row]));
                    for part in 0..parts {
                        let hidden = simd.from_bitmask_mask32x16(hidden >> (part * WIDTH) & 0xffff);
                        depths[part] = hidden.select(f32x16::splat(simd, f32::NAN), depths[part]);
                    }
                }
                for part in 0..parts {
                    place.write_pairs(simd, [depths[part], cosines[part]], self.0);
                    place.step();
                }
            }
        }
    }
}

/// Returns the lanes of four blocks of a row whose hits the second eye does not see, sixteen bits per block.
#[inline(always)]
fn hidden<S: Simd>(
    simd: S,
    band: &Band<'_>,
    faces: Faces,
    (eye, look): (Eye, &mut VisibilityTest),
    (axes, [first, row]): (&[[f32; 3]; 3], [usize; 2]),
) -> u64 {
    let (mut met, mut beyond) = (0, 0);
    let across = band.rays.ray_grid().blocks_across();
    for part in 0..BLOCKS.min(across - first) {
        let block = [first + part, row];
        let index = block_index(band, block);
        let hits = u64::from(hit_lanes(simd, &band.target.slot[index]));
        if hits == 0 {
            continue;
        }
        let t = f32x16::splat(simd, 1.0) / f32x16::load_array_ref(simd, &band.target.inverse[index]);
        let mut local = band.rays.directions(simd, block[0], block[1]);
        for axis in 0..3 {
            local[axis] *= t;
        }
        let [x, y, z] = local;
        beyond |= (!eye.has_in_view(simd, [x, y]).to_bitmask() & 0xffff) << (part * WIDTH);
        // Single precision is enough: occluders that are nearer by only a thousandth do not count.
        let mut points = local;
        for axis in 0..3 {
            points[axis] = (x * axes[0][axis] + y * axes[1][axis]) + z * axes[2][axis];
        }
        look.aim(part, points);
        met |= hits << (part * WIDTH);
    }
    let beyond = beyond & met;
    let looked_at = met & !beyond;
    if looked_at == 0 { beyond } else { beyond | look.hidden(simd, band.view, faces, looked_at) }
}
